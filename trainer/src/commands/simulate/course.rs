//! A logged motion to follow: positions at a uniform step, joined by a smooth curve.

use leastaction_firmware_sim::control::{Setpoint, Trajectory, enter};
use leastaction_learning::data;

/// A motion of N coordinates, entered from rest; after its end it stays at its last position.
///
/// Between two samples every coordinate is a cubic polynomial. Positions, velocities and accelerations are continuous (a cubic spline with
/// given slopes at both ends).
pub struct Course<const N: usize> {
    /// Begin of the motion, s.
    pub begin: f32,
    /// Time in which the motion is entered, s; 0 if it begins at rest.
    pub ramp: f32,
    h: f64,
    /// Position and velocity of every coordinate at every sample.
    knots: Vec<[[f64; 2]; N]>,
}

/// Fraction of the largest speed below which a motion counts as beginning at rest.
const REST: f64 = 0.01;

impl<const N: usize> Course<N> {
    /// The motion through the positions of a log of N coordinates; logged velocities, if any, give the slopes at both ends.
    pub fn through(log: &data::Trajectory, h: f64, (begin, ramp): (f32, f32)) -> Self {
        let (last, mut knots) = (log.samples() - 1, vec![[[0.0; 2]; N]; log.samples()]);
        for i in 0..N {
            let q: Vec<f64> = log.q.iter().map(|row| row[i]).collect();
            let given = |k: usize| log.v.as_ref().map(|v| v[k][i]);
            let ends = [
                given(0).unwrap_or_else(|| one_sided(q.iter(), h)),
                given(last).unwrap_or_else(|| -one_sided(q.iter().rev(), h)),
            ];
            let slopes = slopes(&q, h, ends);
            knots.iter_mut().zip(q.iter().zip(slopes)).for_each(|(knot, (q, v))| knot[i] = [*q, v]);
        }
        let fastest = |knots: &[[[f64; 2]; N]]| {
            knots.as_flattened().iter().fold(0.0, |most: f64, [_, v]| most.max(v.abs()))
        };
        let at_rest = fastest(&knots[..1]) <= REST * fastest(&knots);
        Self { begin, ramp: if at_rest { 0.0 } else { ramp }, h, knots }
    }

    /// End of the motion on the clock, s.
    pub fn end(&self) -> f32 {
        self.begin + 0.5 * self.ramp + (self.h * (self.knots.len() - 1) as f64) as f32
    }

    /// Position and its first two derivatives at time s of the motion.
    fn curve(&self, s: f64) -> [[f32; N]; 3] {
        let x = s / self.h;
        let k = x as usize;
        let Some([from, to]) = self.knots.get(k..k + 2).map(|two| [two[0], two[1]]) else {
            let end = self.knots[self.knots.len() - 1];
            return [end.map(|[q, _]| q as f32), [0.0; N], [0.0; N]];
        };
        let mut state = [[0.0; N]; 3];
        for i in 0..N {
            let values = hermite(from[i], to[i], self.h, x - k as f64);
            state.iter_mut().zip(values).for_each(|(row, value)| row[i] = value as f32);
        }
        state
    }
}

impl<const N: usize> Trajectory<N> for Course<N> {
    fn at(&self, t: f32) -> Setpoint<N> {
        enter(t - self.begin, self.ramp, |s| self.curve(f64::from(s)))
    }
}

/// Value and first two derivatives of the cubic between two positions and velocities that are h seconds apart, at the
/// fraction x of the interval.
fn hermite([q0, v0]: [f64; 2], [q1, v1]: [f64; 2], h: f64, x: f64) -> [f64; 3] {
    let (rise, bend) = (q1 - q0 - h * v0, h * (v1 - v0));
    let (square, cube) = (3.0 * rise - bend, bend - 2.0 * rise);
    [
        q0 + x * (h * v0 + x * (square + x * cube)),
        v0 + x * (2.0 * square + 3.0 * x * cube) / h,
        (2.0 * square + 6.0 * x * cube) / (h * h),
    ]
}

/// Slope at the first of some values, from up to four of them, by one-sided differences.
fn one_sided<'a>(values: impl Iterator<Item = &'a f64>, h: f64) -> f64 {
    let values: Vec<f64> = values.take(4).copied().collect();
    let weights: &[f64] = match values.len() {
        4.. => &[-11.0 / 6.0, 3.0, -1.5, 1.0 / 3.0],
        3 => &[-1.5, 2.0, -0.5],
        _ => &[-1.0, 1.0],
    };
    weights.iter().zip(&values).map(|(weight, value)| weight * value).sum::<f64>() / h
}

/// Slopes at all samples that make second derivatives continuous, from d₋ + 4d + d₊ = 3 (q₊ − q₋)/h by the Thomas
/// algorithm.
fn slopes(q: &[f64], h: f64, [first, last]: [f64; 2]) -> Vec<f64> {
    let mut slopes = vec![first];
    let mut factors = vec![0.0];
    for (k, window) in q.windows(3).enumerate() {
        let pivot = 4.0 - factors[k];
        slopes.push((3.0 * (window[2] - window[0]) / h - slopes[k]) / pivot);
        factors.push(1.0 / pivot);
    }
    slopes.push(last);
    for k in (1..slopes.len() - 1).rev() {
        slopes[k] -= factors[k] * slopes[k + 1];
    }
    slopes
}

#[cfg(test)]
mod tests {
    use super::*;
    use leastaction_learning::data::Rows;

    fn log(count: usize, h: f64, q: impl Fn(f64) -> f64, v: Option<[f64; 2]>) -> data::Trajectory {
        let rows = |of: &dyn Fn(f64) -> f64| {
            Rows::from_flat(1, (0..count).map(|k| of(k as f64 * h)).collect()).unwrap()
        };
        let v = v.map(|[first, last]| rows(&|t| if t == 0.0 { first } else { last }));
        data::Trajectory { id: 0, t0: 7.0, q: rows(&q), v, a: None, u: None }
    }

    #[test]
    fn a_cubic_is_followed_exactly() {
        let q = |t: f64| 1.0 + t * (0.5 + t * (-0.75 + 0.25 * t));
        let v = |t: f64| 0.5 + t * (-1.5 + 0.75 * t);
        let a = |t: f64| -1.5 + 1.5 * t;
        for ends in [None, Some([v(0.0), v(2.0)])] {
            let course = Course::<1>::through(&log(9, 0.25, q, ends), 0.25, (0.5, 0.0));
            for t in [0.0, 0.3, 0.5, 1.9] {
                let at = course.at(0.5 + t as f32);
                let errors = [at.q[0] - q(t) as f32, at.v[0] - v(t) as f32, at.a[0] - a(t) as f32];
                assert!(errors.iter().all(|error| error.abs() < 3e-6), "{t} {errors:?}");
            }
            assert_eq!(course.at(3.0), Setpoint { q: [q(2.0) as f32], v: [0.0], a: [0.0] });
        }
    }

    #[test]
    fn the_error_falls_with_the_fourth_power_of_the_step() {
        let error = |h: f64| {
            let count = (2.0 / h) as usize + 1;
            let course = Course::<1>::through(&log(count, h, |t| (2.0 * t).sin(), None), h, (0.0, 0.0));
            let at = |k: usize| f64::from(k as u8) * 0.01;
            (0..200)
                .map(|k| (course.curve(at(k))[0][0] - (2.0 * at(k)).sin() as f32).abs())
                .fold(0.0, f32::max)
        };
        let [coarse, fine] = [0.2, 0.1].map(error);
        assert!(coarse < 1e-2 && coarse / fine > 10.0, "{coarse} {fine}");
    }

    #[test]
    fn what_moves_at_once_is_entered_from_rest() {
        let moving = Course::<1>::through(&log(11, 0.1, |t| 2.0 * t, None), 0.1, (0.0, 1.0));
        assert_eq!((moving.ramp, moving.end()), (1.0, 1.5));
        assert_eq!((moving.at(0.0).v, moving.at(0.0).a), ([0.0], [0.0]));
        assert!((moving.at(1.2).v[0] - 2.0).abs() < 1e-5);
        let resting =
            Course::<1>::through(&log(11, 0.1, |t| 1.0 - t.cos(), Some([0.0, 0.84])), 0.1, (0.0, 1.0));
        assert_eq!((resting.ramp, resting.end()), (0.0, 1.0));
    }
}
