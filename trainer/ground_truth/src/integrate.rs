//! Integration of motion to nearly the last bit: Gragg–Bulirsch–Stoer extrapolation with error and step-size control.
//!
//! It is used for exact and learned right-hand sides of any size. Only sums, products and quotients are used, so a
//! motion has identical bits on all machines on which its right-hand side has identical bits.
//!
//! Source: Hairer, Nørsett and Wanner, "Solving Ordinary Differential Equations I", section II.9.

use thiserror::Error;

/// Numbers of substeps of the modified midpoint rule in successive columns of the extrapolation.
const SUBSTEPS: [usize; 8] = [2, 4, 6, 8, 10, 12, 14, 16];
/// The first column that may be accepted.
const FIRST: usize = 3;
/// Factor of the step size after acceptance in column 3, 4, …: acceptance in columns 6 and 7 costs least per unit of
/// time.
const GROWTH: [f64; 5] = [3.0, 2.0, 1.4, 1.0, 0.85];
/// Shortest substep that is tried, relative to the interval.
const SHORTEST: f64 = 1.0 / (1 << 24) as f64;
/// Ratios of error to tolerance in column 3, 4, … above which even the last column would exceed the tolerance: the
/// error falls by less than a factor of 10⁴ from one column to the next.
const HOPELESS: [f64; 5] = [1e16, 1e12, 1e8, 1e4, 1.0];

/// The motion could not be followed.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("the motion could not be integrated to a relative error of {tolerance:e} near t = {t} s")]
pub struct IntegrationError {
    /// Time of the failure, s.
    pub t: f64,
    /// Requested tolerance.
    pub tolerance: f64,
}

/// An adaptive integrator of ẋ = f(x), with its working storage.
///
/// It remembers the last successful step size, so use one integrator per trajectory.
#[derive(Clone, Debug)]
pub struct Extrapolation {
    /// Error per step, relative to 1 + |x|.
    tolerance: f64,
    /// The step to try next, s.
    step: f64,
    start_rate: Vec<f64>,
    rate: Vec<f64>,
    before: Vec<f64>,
    now: Vec<f64>,
    /// Latest row of the extrapolation triangle.
    row: [Vec<f64>; SUBSTEPS.len()],
}

impl Extrapolation {
    /// Creates an integrator for states of `size` entries. With a `tolerance` below about 1e-14, rounding would be
    /// mistaken for error.
    pub fn new(size: usize, tolerance: f64) -> Self {
        let zeros = || vec![0.0; size];
        let row = std::array::from_fn(|_| zeros());
        let (start_rate, rate, before, now) = (zeros(), zeros(), zeros(), zeros());
        Self { tolerance, step: f64::INFINITY, start_rate, rate, before, now, row }
    }

    /// Advances `state` by `h` > 0 seconds. `f(x, ẋ)` writes ẋ, or returns `None` if it does not exist.
    ///
    /// # Errors
    /// [`IntegrationError`] if even the shortest step fails; its `t` counts from the beginning of this interval, and
    /// `state` is the last state reached.
    pub fn advance<F>(&mut self, mut f: F, state: &mut [f64], h: f64) -> Result<(), IntegrationError>
    where
        F: FnMut(&[f64], &mut [f64]) -> Option<()>,
    {
        let mut done = 0.0;
        while done < h {
            let parts = ((h - done) / self.step).ceil().max(1.0);
            let step = (h - done) / parts;
            if let Some(column) = self.extrapolate(&mut f, state, step) {
                state.copy_from_slice(&self.row[column]);
                done = if parts == 1.0 { h } else { done + step };
                let next = step * GROWTH[column - FIRST];
                // A step that was shortened to end with the interval does not argue against a longer step.
                self.step = if parts == 1.0 && self.step.is_finite() { next.max(self.step) } else { next };
            } else {
                self.step = step / 2.0;
                if self.step < h * SHORTEST {
                    return Err(IntegrationError { t: done, tolerance: self.tolerance });
                }
            }
        }
        Ok(())
    }

    /// Tries a step; returns the first column whose value agrees with that of its neighbour within the tolerance.
    fn extrapolate<F>(&mut self, f: &mut F, state: &[f64], h: f64) -> Option<usize>
    where
        F: FnMut(&[f64], &mut [f64]) -> Option<()>,
    {
        evaluate(f, state, &mut self.start_rate)?;
        for (k, substeps) in SUBSTEPS.into_iter().enumerate() {
            self.modified_midpoint(f, state, h, substeps)?;
            self.refine(k);
            if k < FIRST {
                continue;
            }
            let error = distance(&self.row[k], &self.row[k - 1]);
            if error <= self.tolerance {
                return Some(k);
            }
            if error.is_nan() || error > self.tolerance * HOPELESS[k - FIRST] {
                return None;
            }
        }
        None
    }

    /// Gragg's rule, whose error has only even powers of the substep. The result is in `now`.
    fn modified_midpoint<F>(&mut self, f: &mut F, state: &[f64], h: f64, substeps: usize) -> Option<()>
    where
        F: FnMut(&[f64], &mut [f64]) -> Option<()>,
    {
        let d = h / substeps as f64;
        self.before.copy_from_slice(state);
        self.now.copy_from_slice(state);
        add(&mut self.now, &self.start_rate, d);
        for _ in 1..substeps {
            evaluate(f, &self.now, &mut self.rate)?;
            add(&mut self.before, &self.rate, 2.0 * d);
            std::mem::swap(&mut self.before, &mut self.now);
        }
        evaluate(f, &self.now, &mut self.rate)?;
        add(&mut self.before, &self.rate, d);
        self.now.iter_mut().zip(&self.before).for_each(|(now, last)| *now = 0.5 * (*now + last));
        Some(())
    }

    /// Replaces row k − 1 of the triangle by row k, whose first value is in `now`.
    fn refine(&mut self, k: usize) {
        for j in 0..k {
            let ratio = SUBSTEPS[k] as f64 / SUBSTEPS[k - 1 - j] as f64;
            let c = 1.0 / (ratio * ratio - 1.0);
            for (value, entry) in self.now.iter_mut().zip(&mut self.row[j]) {
                let previous = std::mem::replace(entry, *value);
                *value += c * (*value - previous);
            }
        }
        self.row[k].copy_from_slice(&self.now);
    }
}

fn evaluate<F>(f: &mut F, x: &[f64], rate: &mut [f64]) -> Option<()>
where
    F: FnMut(&[f64], &mut [f64]) -> Option<()>,
{
    f(x, rate)?;
    rate.iter().all(|rate| rate.is_finite()).then_some(())
}

/// Computes x += c ẋ.
fn add(x: &mut [f64], rate: &[f64], c: f64) {
    x.iter_mut().zip(rate).for_each(|(x, rate)| *x += c * rate);
}

/// The largest difference relative to 1 + |a|; NaN if any difference is NaN.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs() / (1.0 + a.abs()));
    differences.fold(0.0, |largest: f64, d| if d.is_nan() { d } else { largest.max(d) })
}

/// The right-hand side of ẋ = (v, v̇) at x = (q, v), built from accelerations v̇(q, v), for [`Extrapolation::advance`].
pub fn second_order<F>(mut acceleration: F) -> impl FnMut(&[f64], &mut [f64]) -> Option<()>
where
    F: FnMut(&[f64], &[f64], &mut [f64]) -> Option<()>,
{
    move |state, rate| {
        let (q, v) = state.split_at(state.len() / 2);
        let (q_rate, v_rate) = rate.split_at_mut(v.len());
        q_rate.copy_from_slice(v);
        acceleration(q, v, v_rate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOLERANCE: f64 = 1e-12;

    #[test]
    fn an_oscillator_keeps_its_phase_over_many_periods() {
        let mut state = [1.0, 0.0];
        let mut integrator = Extrapolation::new(2, TOLERANCE);
        for _ in 0..100 {
            integrator.advance(oscillator, &mut state, 1.3).unwrap();
        }
        let t = 130.0_f64;
        assert!((state[0] - t.cos()).abs() < 1e-10 && (state[1] + t.sin()).abs() < 1e-10, "{state:?}");
    }

    fn oscillator(x: &[f64], rate: &mut [f64]) -> Option<()> {
        rate.copy_from_slice(&[x[1], -x[0]]);
        Some(())
    }

    #[test]
    fn the_step_fits_the_motion_and_not_the_interval() {
        let mut count = 0;
        let mut state = [1.0, 0.0];
        let mut counted = |x: &[f64], rate: &mut [f64]| {
            count += 1;
            oscillator(x, rate)
        };
        Extrapolation::new(2, TOLERANCE).advance(&mut counted, &mut state, 200.0).unwrap();
        assert!((state[0] - 200.0_f64.cos()).abs() < 1e-9, "{state:?}");
        assert!(count < 20_000, "{count} evaluations");
    }

    #[test]
    fn a_pole_stops_before_itself() {
        // The solution of ẋ = x² from 1 is 1/(1 − t).
        let square = |x: &[f64], rate: &mut [f64]| {
            rate[0] = x[0] * x[0];
            Some(())
        };
        let mut state = [1.0];
        Extrapolation::new(1, TOLERANCE).advance(square, &mut state, 0.99).unwrap();
        assert!((state[0] - 100.0).abs() < 1e-7, "{state:?}");
        let error = Extrapolation::new(1, TOLERANCE).advance(square, &mut [1.0], 2.0).unwrap_err();
        assert!((error.t - 1.0).abs() < 1e-3, "{error}");
    }

    #[test]
    fn a_side_that_fails_is_an_error_where_it_fails() {
        // Motion at speed 1 with nothing beyond x = 0.5.
        let wall = |x: &[f64], rate: &mut [f64]| {
            rate[0] = 1.0;
            (x[0] < 0.5).then_some(())
        };
        let mut state = [0.0];
        let error = Extrapolation::new(1, TOLERANCE).advance(wall, &mut state, 1.0).unwrap_err();
        assert!((error.t - 0.5).abs() < 1e-5 && (state[0] - error.t).abs() < 1e-12, "{error} {state:?}");
    }
}
