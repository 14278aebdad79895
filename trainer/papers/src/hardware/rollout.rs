//! Predictions of many runs side by side, each under its own torques.

use super::grid::STEP;
use super::predictor::Predict;
use leastaction_programs::{Row, WIDTH};
use std::array::from_fn;

/// Number of Runge–Kutta steps per step of the grid. Friction is stiff where velocities change sign: with a slope of up
/// to 16 N m s/rad and an inertia of 0.03 kg m², the method needs steps of 2 ms to be stable and accurate to four
/// digits.
const SUBSTEPS: usize = 5;

/// A run to predict.
#[derive(Clone, Debug, PartialEq)]
pub struct Run<'t> {
    /// Positions (rad) and velocities (rad/s) at the start.
    pub start: [Vec<f64>; 2],
    /// Torques of every step, held during it, \[steps\]\[n\], flat (N m).
    pub torques: &'t [f64],
}

/// Predicts the positions (rad) of every run from its start, \[steps + 1\]\[n\], flat, after every step of the grid, by
/// the classical Runge–Kutta method of order 4. All runs must have the same number of steps.
pub fn roll_out(motion: &mut Predict, runs: &[Run]) -> Vec<Vec<f64>> {
    runs.chunks(WIDTH).flat_map(|runs| block(motion, runs)).collect()
}

/// Predicts runs side by side; unused lanes repeat the last run.
fn block(motion: &mut Predict, runs: &[Run]) -> Vec<Vec<f64>> {
    let Some(last) = runs.len().checked_sub(1) else { return Vec::new() };
    let n = runs[0].start[0].len();
    let steps = runs[0].torques.len() / n.max(1);
    let rows = |of: &dyn Fn(&Run, usize) -> f64| -> Vec<Row> {
        (0..n).map(|i| Row(from_fn(|lane| of(&runs[lane.min(last)], i)))).collect()
    };
    let start = [0, 1].map(|part| rows(&|run, i| run.start[part][i]));
    let mut stepper = Stepper { motion, state: start, h: STEP / SUBSTEPS as f64 };
    let mut paths = vec![Vec::with_capacity((steps + 1) * n); runs.len()];
    for step in 0..=steps {
        for (lane, path) in paths.iter_mut().enumerate() {
            path.extend(stepper.state[0].iter().map(|q| q.0[lane]));
        }
        if step < steps {
            let torque = rows(&|run, i| run.torques.get(step * n + i).copied().unwrap_or(f64::NAN));
            (0..SUBSTEPS).for_each(|_| stepper.step(&torque));
        }
    }
    paths
}

/// Positions and velocities.
type State = [Vec<Row>; 2];

/// Integrator with steps of h, s.
struct Stepper<'m, 'p> {
    motion: &'m mut Predict<'p>,
    state: State,
    h: f64,
}

impl Stepper<'_, '_> {
    fn step(&mut self, torque: &[Row]) {
        let h = self.h;
        let one = self.rate(&self.state.clone(), torque);
        let two = self.rate(&moved(&self.state, h / 2.0, &one), torque);
        let three = self.rate(&moved(&self.state, h / 2.0, &two), torque);
        let four = self.rate(&moved(&self.state, h, &three), torque);
        for (share, rate) in [(1.0, one), (2.0, two), (2.0, three), (1.0, four)] {
            self.state = moved(&self.state, share * h / 6.0, &rate);
        }
    }

    /// Rate (v, v̇) of a state.
    fn rate(&mut self, [q, v]: &State, torque: &[Row]) -> State {
        let mut a = vec![Row::default(); q.len()];
        (self.motion)([q, v, torque], &mut a);
        [v.clone(), a]
    }
}

/// Returns state + c · rate.
fn moved(state: &State, c: f64, rate: &State) -> State {
    let add = |x: &Row, rate: &Row| Row(from_fn(|lane| x.0[lane] + c * rate.0[lane]));
    from_fn(|part| state[part].iter().zip(&rate[part]).map(|(x, rate)| add(x, rate)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two uncoupled joints: a spring, and a mass on which the torque acts.
    fn joints([q, _, tau]: [&[Row]; 3], a: &mut [Row]) {
        a[0] = Row(from_fn(|lane| -9.0 * q[0].0[lane]));
        a[1] = Row(from_fn(|lane| tau[1].0[lane]));
    }

    #[test]
    fn runs_side_by_side_are_exact_and_their_own() {
        let torques: Vec<Vec<f64>> = (0..19).map(|k| [0.0, f64::from(k)].repeat(50)).collect();
        let runs: Vec<Run> = (0..19)
            .map(|k| Run { start: [vec![0.1 * k as f64, 0.0], vec![0.0, 1.0]], torques: &torques[k] })
            .collect();
        let paths = roll_out(&mut joints, &runs);
        assert_eq!(paths.len(), 19);
        for (k, path) in paths.iter().enumerate() {
            assert_eq!(path.len(), 102);
            for (step, q) in path.chunks(2).enumerate() {
                let t = step as f64 * STEP;
                let exact = [0.1 * k as f64 * (3.0 * t).cos(), t + 0.5 * k as f64 * t * t];
                assert!((q[0] - exact[0]).abs() < 1e-9 && (q[1] - exact[1]).abs() < 1e-12, "{k} {step}");
            }
        }
    }
}
