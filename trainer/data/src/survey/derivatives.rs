//! Columns without names: those whose derivatives are other columns are positions, with their velocities.

use super::{Clock, Guess, RawLog, Signal, time_unit};
use crate::columns::unit;

/// Number of stretches of a log over which increments are compared.
const STRETCHES: usize = 50;

/// Difference of a column's increments from the integral of another one, relative to their size, below which the other one is its
/// derivative.
const ALIKE: f64 = 0.2;

impl Guess {
    /// The guess with positions, velocities and forces of a file without a header. Forces are all other columns if these
    /// are as many as positions; otherwise nothing is guessed.
    pub(super) fn by_derivatives(self, logs: &[RawLog]) -> Self {
        let (Some(log), Some(t)) = (logs.first(), &self.t) else { return self };
        let Some(stamps) = seconds(log, t).filter(|_| t.starts_with('#')) else { return self };
        let moving: Vec<&String> = log.names.iter().filter(|name| *name != t && moves(log, name)).collect();
        let pairs = pairs(log, &moving, &stamps);
        let is_derived = |name: &String| pairs.iter().any(|(_, derivative)| *derivative == name);
        let of_positions: Vec<_> = pairs.iter().filter(|(position, _)| !is_derived(position)).collect();
        let is_position = |name: &String| of_positions.iter().any(|(position, _)| *position == name);
        let u: Vec<String> = moving
            .iter()
            .filter(|name| !is_derived(name) && !is_position(name))
            .map(|name| (*name).clone())
            .collect();
        if of_positions.is_empty() || !u.is_empty() && u.len() != of_positions.len() {
            return self;
        }
        let q = of_positions.iter().map(|(position, _)| (*position).clone()).collect();
        let v = of_positions.iter().map(|(_, velocity)| (*velocity).clone()).collect();
        Self { q, v, u, ..self }
    }
}

/// Stamps of a log, s.
fn seconds(log: &RawLog, t: &str) -> Option<Vec<f64>> {
    let stamps = log.column(t)?;
    let second = unit(time_unit(Clock::of(stamps)?.median))?;
    Some(stamps.iter().map(|t| second * t).collect())
}

fn moves(log: &RawLog, name: &str) -> bool {
    log.column(name).and_then(Signal::of).is_some_and(|signal| !signal.is_constant())
}

/// Columns, each with its derivative: of several columns with the same derivative the one that fits best.
fn pairs<'a>(log: &RawLog, names: &[&'a String], t: &[f64]) -> Vec<(&'a String, &'a String)> {
    let best = |derivative: &&'a String| {
        let others = names.iter().filter(|name| *name != derivative);
        let fit = |name: &&'a String| Some((*name, unlike(t, log.column(name)?, log.column(derivative)?)?));
        let (name, unlike) = others.filter_map(fit).min_by(|a, b| a.1.total_cmp(&b.1))?;
        (unlike < ALIKE).then_some((name, *derivative))
    };
    let mut found: Vec<_> = names.iter().filter_map(best).collect();
    found.sort_by_key(|(name, _)| names.iter().position(|known| known == name));
    found
}

/// Difference between increments of q and the integral of v over stretches of the log, relative to the increments.
/// Integrals bear noise that derivatives do not.
fn unlike(t: &[f64], q: &[f64], v: &[f64]) -> Option<f64> {
    let length = (t.len() / STRETCHES).max(1);
    let ends = (0..).step_by(length).take_while(|start| start + length < t.len());
    let (mut off, mut size) = (0.0, 0.0);
    for start in ends {
        let rows = start..start + length;
        let area: f64 = rows.clone().map(|k| 0.5 * (v[k] + v[k + 1]) * (t[k + 1] - t[k])).sum();
        let change = q[rows.end] - q[rows.start];
        if (area + change).is_finite() {
            off += (change - area).abs();
            size += change.abs();
        }
    }
    (size > 0.0).then_some(off / size)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A log at 200 Hz without a header, with these columns beside time.
    fn guess(columns: &[fn(f64) -> f64]) -> Guess {
        let t: Vec<f64> = (0..600).map(|k| 5.0 * f64::from(k)).collect();
        let of = |column: &fn(f64) -> f64| t.iter().map(|t| column(1e-3 * t)).collect::<Vec<_>>();
        let columns: Vec<Vec<f64>> = columns.iter().map(of).collect();
        let columns: Vec<Vec<f64>> = std::iter::once(t.clone()).chain(columns).collect();
        Guess::of(&[RawLog {
            names: (1..=columns.len()).map(|k| format!("#{k}")).collect(),
            columns,
            ..RawLog::default()
        }])
    }

    const POSITIONS: [fn(f64) -> f64; 2] =
        [|t| 0.5 * (3.0 * t).sin(), |t| (2.0 * t).cos() + 0.3 * (7.0 * t).sin()];
    const VELOCITIES: [fn(f64) -> f64; 2] =
        [|t| 1.5 * (3.0 * t).cos(), |t| 2.1 * (7.0 * t).cos() - 2.0 * (2.0 * t).sin()];
    const FORCES: [fn(f64) -> f64; 2] = [|t| 3.0 * (5.0 * t).cos(), |t| (11.0 * t).sin()];

    #[test]
    fn positions_and_velocities_are_told_by_their_derivatives() {
        let [[q0, q1], [v0, v1], [u0, u1]] = [POSITIONS, VELOCITIES, FORCES];
        let found = guess(&[q0, q1, v0, v1, u0, u1]);
        assert_eq!((found.t.as_deref(), &found.q[..]), (Some("#1"), &["#2".to_owned(), "#3".to_owned()][..]));
        assert_eq!(
            (found.v, found.u),
            (vec!["#4".to_owned(), "#5".into()], vec!["#6".to_owned(), "#7".into()])
        );
        // Accelerations are neither velocities nor forces; joints may stand one after the other.
        let acceleration: fn(f64) -> f64 = |t| -4.5 * (3.0 * t).sin();
        let found = guess(&[u0, v0, acceleration, q0]);
        assert_eq!(
            (found.q, found.v, found.u),
            (vec!["#5".to_owned()], vec!["#3".into()], vec!["#2".into()])
        );
    }

    #[test]
    fn nothing_is_guessed_where_nothing_shows_it() {
        let [[q0, q1], [v0, _], [u0, u1]] = [POSITIONS, VELOCITIES, FORCES];
        for columns in [&[q0, u0][..], &[q0, q1, u0, u1], &[q0, v0, u0, u1], &[q0, |t| 3.0 * (3.0 * t).cos()]]
        {
            let found = guess(columns);
            assert_eq!((found.t.as_deref(), found.q.len(), found.u.len()), (Some("#1"), 0, 0));
        }
    }
}
