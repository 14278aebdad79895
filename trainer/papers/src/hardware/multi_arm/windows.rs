//! Errors of predictions along free swings that were not learned from.

use super::super::grid::STEP;
use super::super::polynomial::Polynomial;
use super::super::predictor::Predictor;
use super::super::rollout::{Run, roll_out};
use super::super::window::{HORIZONS, errors};
use leastaction_learning::data::{Dataset, Rows};

/// Time from the start of a window to the start of the next, s.
const STRIDE: f64 = 0.25;
/// Number of samples on each side of the start of a prediction that determine its state.
const HALF: usize = 10;

/// Samples per step of the grid, per stride.
fn counts(h: f64) -> [usize; 2] {
    [STEP, STRIDE].map(|time| (time / h).round().max(1.0) as usize)
}

/// Error to each horizon, rad, of every window: the root mean square over all joints and all times of the grid.
pub fn window_errors(predictor: &dyn Predictor, swings: &Dataset) -> Vec<[f64; 3]> {
    let [.., steps] = HORIZONS;
    let ([per_step, stride], quadratic) = (counts(swings.h), Polynomial::new(HALF, 2, swings.h));
    let torques = vec![0.0; steps * swings.n];
    let (mut runs, mut logged) = (Vec::new(), Vec::new());
    for q in swings.trajectories.iter().map(|swing| &swing.q) {
        let samples = HALF + steps * per_step + 1;
        for start in (0..).step_by(stride).take_while(|start| start + samples.max(2 * HALF + 1) <= q.len()) {
            let [position, velocity, _] = quadratic.at(q, start);
            runs.push(Run { start: [position, velocity], torques: &torques });
            logged.push(on_grid(q, (start + HALF, per_step), steps));
        }
    }
    let paths = roll_out(&mut *predictor.motion(), &runs);
    let of = |(path, logged): (&Vec<f64>, &Vec<f64>)| {
        let differences: Vec<f64> = path.iter().zip(logged).map(|(q, logged)| q - logged).collect();
        errors(&differences, swings.n)
    };
    paths.iter().zip(&logged).map(of).collect()
}

/// Positions at every time of the grid from sample `first` on.
fn on_grid(q: &Rows, (first, per_step): (usize, usize), steps: usize) -> Vec<f64> {
    (0..=steps).flat_map(|k| q[first + k * per_step].iter().copied()).collect()
}

#[cfg(test)]
mod tests {
    use super::super::super::predictor::ConstantVelocity;
    use super::*;
    use leastaction_learning::data::Trajectory;

    /// Two joints, the second with a constant acceleration.
    #[test]
    fn errors_are_those_of_the_horizons() {
        let h = 1e-3;
        let row = |k: usize| [0.4 * k as f64 * h, 1.5 * (k as f64 * h).powi(2)];
        let q = Rows::from_rows(2, (0..1300).map(row)).unwrap();
        let trajectory = Trajectory { id: 0, t0: 0.0, q, v: None, a: None, u: None };
        let swings = Dataset { n: 2, h, control: None, trajectories: vec![trajectory] };
        let found = window_errors(&ConstantVelocity, &swings);
        assert_eq!(found.len(), 2);
        for (horizon, steps) in HORIZONS.into_iter().enumerate() {
            let squares = (0..=steps).map(|k| (1.5 * (k as f64 * STEP).powi(2)).powi(2)).sum::<f64>();
            let exact = (squares / (2 * (steps + 1)) as f64).sqrt();
            assert!(found.iter().all(|of| (of[horizon] / exact - 1.0).abs() < 1e-9), "{found:?} {exact}");
        }
    }
}
