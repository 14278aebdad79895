//! Whether commands are the positions to go to, as those of servos, and no forces.

use super::{Guess, RawLog};

/// Largest distance, and least correlation, of commands and positions at which commands are taken for positions: where positions lag
/// by 0.6 rad behind a sine, these are 0.59 and 0.83.
const FAR: f64 = 0.8;
const ALIKE: f64 = 0.8;

/// Agreement of commands with positions: of the median coordinate among those that move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goals {
    /// Root mean square of u − q over the standard deviation of q.
    pub distance: f64,
    /// Correlation of u and q, −1 to 1.
    pub correlation: f64,
}

impl Goals {
    /// The agreement in these logs; `None` if no coordinate that moves has commands of the same clock.
    #[must_use]
    pub fn of(logs: &[&RawLog], guess: &Guess) -> Option<Self> {
        let pairs = || guess.q.iter().zip(&guess.u);
        let all: Vec<Self> = pairs().filter_map(|(q, u)| Self::of_coordinate(logs, q, u)).collect();
        let median = |of: fn(&Self) -> f64| {
            let mut values: Vec<f64> = all.iter().map(of).collect();
            values.sort_unstable_by(f64::total_cmp);
            values.get(values.len() / 2).copied()
        };
        Some(Self {
            distance: median(|goals| goals.distance)?,
            correlation: median(|goals| goals.correlation)?,
        })
    }

    /// Whether the commands are positions: near those that are measured, and as they are.
    #[must_use]
    pub fn are_positions(&self) -> bool {
        self.distance < FAR && self.correlation > ALIKE
    }

    fn of_coordinate(logs: &[&RawLog], q: &str, u: &str) -> Option<Self> {
        let columns = |log: &&RawLog| Some((log.column(q)?.to_vec(), log.column(u)?.to_vec()));
        let pairs = logs.iter().filter_map(columns).flat_map(|(q, u)| q.into_iter().zip(u));
        let pairs: Vec<(f64, f64)> = pairs.filter(|(q, u)| q.is_finite() && u.is_finite()).collect();
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / pairs.len() as f64;
        let (q, u) = (mean(&|(q, _)| *q), mean(&|(_, u)| *u));
        let spread = mean(&|pair| (pair.0 - q).powi(2)).sqrt();
        let of_u = mean(&|pair| (pair.1 - u).powi(2)).sqrt();
        let both = mean(&|pair| (pair.0 - q) * (pair.1 - u));
        let distance = mean(&|(q, u)| (u - q).powi(2)).sqrt() / spread;
        let correlation = both / (spread * of_u);
        (distance.is_finite() && correlation.is_finite()).then_some(Self { distance, correlation })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const H: f64 = 0.01;

    /// A link of 1 kg m² under gravity that a force drives, and that force or the goal of its servo.
    fn log(force: impl Fn(f64, f64, f64) -> f64, logged: impl Fn(f64) -> f64) -> RawLog {
        let (mut x, mut v) = (0.0_f64, 0.0_f64);
        let (mut q, mut u) = (Vec::new(), Vec::new());
        for k in 0..2000 {
            let t = H * f64::from(k);
            q.push(x);
            u.push(logged(t));
            v += H * (force(t, x, v) - 9.81 * x.sin());
            x += H * v;
        }
        RawLog { names: vec!["pos".into(), "u".into()], columns: vec![q, u], ..RawLog::default() }
    }

    fn wave(t: f64) -> f64 {
        0.8 * (1.3 * t).sin() + 0.3 * (2.9 * t).sin()
    }

    fn goals(log: &RawLog) -> Goals {
        let guess = Guess { q: vec!["pos".into()], u: vec!["u".into()], ..Guess::default() };
        Goals::of(&[log], &guess).unwrap()
    }

    #[test]
    fn a_soft_servo_is_told_from_a_drive() {
        let servo = goals(&log(|t, q, v| 40.0 * (wave(t) - q) - 8.0 * v, wave));
        assert!(servo.are_positions() && servo.distance > 0.1, "{servo:?}");
        for (scale, damping) in [(1.0, 1.0), (5.0, 1.0), (9.81, 4.0), (30.0, 2.0)] {
            let drive = goals(&log(|t, _, v| scale * wave(t) - damping * v, |t| scale * wave(t)));
            assert!(!drive.are_positions(), "{scale} {drive:?}");
        }
    }

    #[test]
    fn a_coordinate_at_rest_says_nothing() {
        let guess = Guess { q: vec!["pos".into()], u: vec!["u".into()], ..Guess::default() };
        assert_eq!(Goals::of(&[&log(|_, _, _| 0.0, wave)], &guess), None);
        assert_eq!(Goals::of(&[&RawLog::default()], &guess), None);
    }
}
