//! The error of predictions over windows of one second, by which every row is judged.

use super::grid::STEP;
use super::log::Log;
use super::machine::Machine;
use super::polynomial::Polynomial;
use super::predictor::Predictor;
use super::rollout::{Run, roll_out};
use leastaction_learning::data::Rows;
use leastaction_learning::evaluate::{median, percentile};

/// Numbers of steps of the predictions: 0.1, 0.5 and 1 s.
pub const HORIZONS: [usize; 3] = [10, 50, 100];

/// Number of samples from the start of a window to the start of the next.
const STRIDE: usize = 25;
/// Number of samples on each side of the start of a prediction that determine its state.
const HALF: usize = 3;
/// Speed that some joint must reach in a window for it to count, rad/s.
const MOVING: f64 = 0.2;
/// Number of samples that calibration may use: 2 s. Only windows that start later are reported.
pub const CALIBRATED: usize = 200;

/// Windows of a log with predictions of `steps` steps, by the sample at which each starts.
pub(super) fn windows(machine: Machine, log: &Log, steps: usize) -> Vec<usize> {
    let samples = HALF + steps + 1;
    let starts = (0..).step_by(STRIDE).take_while(|start| start + samples <= log.samples());
    starts.filter(|start| is_counted(machine, log, *start, samples)).collect()
}

fn is_counted(machine: Machine, log: &Log, start: usize, samples: usize) -> bool {
    let of = |rows: &Rows| rows.slice(start..start + samples);
    let moves = of(&log.v).as_flat().iter().any(|v| v.abs() >= MOVING);
    moves && machine.counts(of(&log.q).iter())
}

/// A prediction from a window of a log: its start, and the samples to compare it with.
pub(super) struct Prediction {
    /// Positions and velocities of a quadratic through seven samples, at their middle.
    pub start: [Vec<f64>; 2],
    /// Sample at the start of the prediction.
    pub first: usize,
}

/// Returns the predictions of windows; the offsets z are subtracted from the logged positions.
pub(super) fn predictions(log: &Log, windows: &[usize], offsets: &[f64]) -> Vec<Prediction> {
    let quadratic = Polynomial::new(HALF, 2, STEP);
    let of = |window: &usize| {
        let [mut q, v, _] = quadratic.at(&log.q, *window);
        q.iter_mut().zip(offsets).for_each(|(q, z)| *q -= z);
        Prediction { start: [q, v], first: window + HALF }
    };
    windows.iter().map(of).collect()
}

/// Error to each horizon, rad, for the windows of a log that start at these samples: the root mean square over all
/// joints and all samples from the start of the prediction on. `offsets` are the zero offsets z of the encoders,
/// q̃ = q + z. The error is infinite if a prediction breaks off.
pub(super) fn window_errors(
    predictor: &dyn Predictor,
    log: &Log,
    windows: &[usize],
    offsets: &[f64],
) -> Vec<[f64; 3]> {
    let [.., steps] = HORIZONS;
    let (n, torques) = (log.joints(), predictor.torques(log));
    let predictions = predictions(log, windows, offsets);
    let run = |of: &Prediction| Run {
        start: of.start.clone(),
        torques: &torques.as_flat()[of.first * n..(of.first + steps) * n],
    };
    let runs: Vec<Run> = predictions.iter().map(run).collect();
    let paths = roll_out(&mut *predictor.motion(), &runs);
    let errors = |(path, of): (&Vec<f64>, &Prediction)| {
        let logged = &log.q.as_flat()[of.first * n..];
        let differences = path
            .chunks(n)
            .zip(logged.chunks(n))
            .flat_map(|(q, logged)| q.iter().zip(logged).zip(offsets).map(|((q, logged), z)| q + z - logged));
        errors(&differences.collect::<Vec<_>>(), n)
    };
    paths.iter().zip(&predictions).map(errors).collect()
}

/// Errors to each horizon from the differences at the times of the grid, row by row.
pub(super) fn errors(differences: &[f64], n: usize) -> [f64; 3] {
    HORIZONS.map(|steps| {
        let of = &differences[..(steps + 1) * n];
        let error = (of.iter().map(|x| x * x).sum::<f64>() / of.len() as f64).sqrt();
        if error.is_nan() { f64::INFINITY } else { error }
    })
}

/// Summary of the errors of many windows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Median over windows of the error to each horizon, rad.
    pub medians: [f64; 3],
    /// 90th percentiles over windows, rad.
    pub percentiles: [f64; 3],
    /// Number of windows.
    pub windows: usize,
}

impl Summary {
    /// Summarises these errors; NaN if there are none.
    pub fn of(errors: &[[f64; 3]]) -> Self {
        let column = |horizon: usize| errors.iter().map(|of| of[horizon]).collect::<Vec<_>>();
        Self {
            medians: [0, 1, 2].map(|horizon| median(&column(horizon))),
            percentiles: [0, 1, 2].map(|horizon| percentile(&column(horizon), 0.9)),
            windows: errors.len(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::predictor::ConstantVelocity;
    use super::*;

    /// Two joints, the first with a constant acceleration, rad/s², the second at rest; slower than 0.2 rad/s before `moving`.
    fn log(acceleration: f64, samples: usize, moving: usize) -> Log {
        let t = |k: usize| k as f64 * STEP;
        let rows =
            |of: &dyn Fn(usize) -> f64| Rows::from_rows(2, (0..samples).map(|k| [of(k), 0.3])).unwrap();
        let v = (0..samples).map(|k| [if k < moving { 0.19 } else { 0.2 }, 0.0]);
        Log {
            file: "log.csv".into(),
            q: rows(&|k| 0.5 * acceleration * t(k) * t(k)),
            v: Rows::from_rows(2, v).unwrap(),
            measured: rows(&|_| 0.0),
            commanded: None,
        }
    }

    #[test]
    fn a_window_has_104_samples_and_moves() {
        let of =
            |samples: usize, moving: usize| windows(Machine::DoublePendulum, &log(1.0, samples, moving), 100);
        assert!(of(103, 0).is_empty());
        assert_eq!(of(104, 0), [0]);
        assert_eq!(of(154, 0), [0, 25, 50]);
        // A window uses sample s + 103, but no later sample.
        assert_eq!((of(154, 103), of(154, 104), of(154, 129)), (vec![0, 25, 50], vec![25, 50], vec![50]));
    }

    /// The prediction by a constant velocity of a motion with constant acceleration has the error ½a(kh)² after k
    /// steps. Half of the joints have this error, and Σ k⁴ is known in closed form.
    #[test]
    fn the_error_is_the_root_mean_square_over_joints_and_samples() {
        let errors = window_errors(&ConstantVelocity, &log(3.0, 160, 0), &[0, 50], &[0.0; 2]);
        for (horizon, steps) in HORIZONS.into_iter().enumerate() {
            let k = steps as f64;
            let fourth = k * (k + 1.0) * (2.0 * k + 1.0) * (3.0 * k * k + 3.0 * k - 1.0) / 30.0;
            let exact = 1.5 * STEP * STEP * (fourth / (2.0 * (k + 1.0))).sqrt();
            for error in &errors {
                assert!((error[horizon] - exact).abs() < 1e-12, "{error:?} {exact}");
            }
        }
    }

    #[test]
    fn a_prediction_that_breaks_off_is_infinitely_wrong() {
        struct Broken;
        impl Predictor for Broken {
            fn motion(&self) -> Box<super::super::predictor::Predict<'_>> {
                Box::new(|_, a| a.fill(leastaction_programs::Row::splat(f64::NAN)))
            }
        }
        assert_eq!(window_errors(&Broken, &log(1.0, 104, 0), &[0], &[0.0; 2]), [[f64::INFINITY; 3]]);
    }

    #[test]
    fn few_numbers_of_many_errors() {
        let errors: Vec<[f64; 3]> = (0..11).map(|k| [f64::from(k), 1.0, f64::INFINITY]).collect();
        let summary = Summary::of(&errors);
        assert_eq!((summary.medians, summary.windows), ([5.0, 1.0, f64::INFINITY], 11));
        assert_eq!(summary.percentiles, [9.0, 1.0, f64::INFINITY]);
        assert_eq!(Summary::of(&errors[..2]).percentiles[0], 0.9);
        assert!(Summary::of(&[]).medians[0].is_nan());
    }
}
