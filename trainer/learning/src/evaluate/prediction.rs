//! Long-term prediction in ModLaNet's measures, and the error floor set by single precision.

use leastaction_ground_truth::{ExactMotion, Horizon, IntegrationError, Start, follow};
use leastaction_models::parallel;
use std::f64::consts::{PI, TAU};

/// Error tolerance per step, relative to 1 + |x|, of exact motions and, unless said otherwise, of predictions.
pub const TOLERANCE: f64 = 1e-12;
/// Error tolerance per step that can be achieved with accelerations rounded to single precision.
pub const ROUNDED_TOLERANCE: f64 = 1e-8;
/// Position error up to which a prediction is valid, m or rad.
pub const VALID_ERROR: f64 = 0.1;

/// Exact motions to compare predictions with.
#[derive(Clone, Debug)]
pub struct Truth {
    horizon: Horizon,
    starts: Vec<Start>,
    angles: Vec<bool>,
    /// (q, v) of each start, \[samples\]\[2n\].
    states: Vec<Vec<f64>>,
    /// T + V of each start.
    energies: Vec<Vec<f64>>,
}

impl Truth {
    /// Follows the exact motion from each start.
    ///
    /// # Errors
    /// [`IntegrationError`] if the motion cannot be followed.
    pub fn new(
        motion: &dyn ExactMotion,
        starts: Vec<Start>,
        horizon: Horizon,
    ) -> Result<Self, IntegrationError> {
        let exact = |q: &[f64], v: &[f64], a: &mut [f64]| motion.acceleration(q, v, a);
        let states = |start: &Start| -> Result<Vec<f64>, IntegrationError> {
            let mut states = Vec::new();
            let project = |state: &mut [f64]| motion.project(state);
            follow(exact, project, start, horizon, TOLERANCE, |state| states.extend_from_slice(state))?;
            Ok(states)
        };
        let states = parallel::map(starts.len(), &|k| states(&starts[k]));
        let states = states.into_iter().collect::<Result<Vec<_>, _>>()?;
        let angles: Vec<bool> = (0..motion.coordinates()).map(|i| motion.is_angle(i)).collect();
        let energies = states.iter().map(|states| energies(states, angles.len(), |q, v| motion.energy(q, v)));
        Ok(Self { energies: energies.collect(), horizon, starts, angles, states })
    }

    /// (q, v) along the first start, \[samples\]\[2n\].
    pub fn first(&self) -> &[f64] {
        self.states.first().map_or(&[], Vec::as_slice)
    }

    /// Start states.
    pub fn starts(&self) -> &[Start] {
        &self.starts
    }

    /// (q, v) along start `k`, \[samples\]\[2n\].
    pub(super) fn states(&self, k: usize) -> &[f64] {
        &self.states[k]
    }

    /// Times at which predictions are compared.
    pub fn horizon(&self) -> Horizon {
        self.horizon
    }

    /// Predicts from the same starts by integrating accelerations v̇(q, v) to `tolerance`, with projection onto the
    /// rods of the exact motion, and measures the errors.
    ///
    /// The exact energy of the predicted state (J) is compared with that of the exact motion, as the authors do. A prediction that
    /// cannot be followed to the end counts as infinitely wrong from there on.
    pub fn compare(
        &self,
        tolerance: f64,
        motion: &dyn ExactMotion,
        acceleration: impl Fn(&[f64], &[f64], &mut [f64]) -> Option<()> + Sync,
    ) -> Prediction {
        self.compare_paths(motion, |start, keep| {
            let project = |state: &mut [f64]| motion.project(state);
            follow(&acceleration, project, start, self.horizon, tolerance, keep)
        })
    }

    /// Compares predictions as [`Truth::compare`] does, but the predictions come from `path`: it passes the predicted
    /// states (q, v) from a start to its second argument, one by one at the times of the horizon, or returns an error
    /// if it cannot go on.
    pub fn compare_paths(
        &self,
        motion: &dyn ExactMotion,
        path: impl Fn(&Start, &mut dyn FnMut(&[f64])) -> Result<(), IntegrationError> + Sync,
    ) -> Prediction {
        let energy = |q: &[f64], v: &[f64]| motion.energy(q, v);
        let one = |k: usize| {
            let (states, failed) = self.path(k, &path);
            let errors = self.errors(k, &states, &energies(&states, self.angles.len(), energy), failed);
            (errors, if k == 0 { states } else { Vec::new() })
        };
        let (errors, states): (Vec<_>, Vec<_>) = parallel::map(self.starts.len(), &one).into_iter().unzip();
        self.summarise(&errors, states.into_iter().next().unwrap_or_default())
    }

    /// (q, v) along start `k`, \[samples\]\[2n\], integrated from accelerations on the rods of the exact motion, and
    /// whether the integration failed before the end. The states after a failure are infinite.
    pub(super) fn predicted(
        &self,
        k: usize,
        tolerance: f64,
        motion: &dyn ExactMotion,
        acceleration: impl Fn(&[f64], &[f64], &mut [f64]) -> Option<()>,
    ) -> (Vec<f64>, bool) {
        self.path(k, |start, keep| {
            let project = |state: &mut [f64]| motion.project(state);
            follow(&acceleration, project, start, self.horizon, tolerance, keep)
        })
    }

    /// The states of one path from start `k`, and whether it failed; the states after a failure are infinite.
    fn path(
        &self,
        k: usize,
        path: impl Fn(&Start, &mut dyn FnMut(&[f64])) -> Result<(), IntegrationError>,
    ) -> (Vec<f64>, bool) {
        let mut states = Vec::with_capacity(self.states[k].len());
        let failed = path(&self.starts[k], &mut |state| states.extend_from_slice(state)).is_err();
        states.resize(self.states[k].len(), f64::INFINITY);
        (states, failed)
    }

    /// Errors of other exact motions, treated as predictions of these: the growth of a disturbance of the start. Starts
    /// without a counterpart are left out.
    pub fn difference(&self, other: &Self) -> Prediction {
        let pairs = other.states.iter().zip(&other.energies).take(self.starts.len());
        let errors = pairs.enumerate().map(|(k, (states, energies))| self.errors(k, states, energies, false));
        self.summarise(&errors.collect::<Vec<_>>(), other.first().to_vec())
    }

    /// The floor of single precision: predictions by exact accelerations rounded to single precision.
    pub fn single_precision(&self, motion: &dyn ExactMotion) -> Prediction {
        let rounded = |q: &[f64], v: &[f64], a: &mut [f64]| {
            motion.acceleration(q, v, a)?;
            a.iter_mut().for_each(|a| *a = f64::from(*a as f32));
            Some(())
        };
        self.compare(ROUNDED_TOLERANCE, motion, rounded)
    }

    fn errors(&self, k: usize, predicted: &[f64], energies: &[f64], failed: bool) -> Errors {
        let Horizon { h, samples } = self.horizon;
        let n = self.angles.len();
        let rows = || predicted.chunks_exact(2 * n).zip(self.states[k].chunks_exact(2 * n));
        let q: Vec<f64> = rows().map(|(p, t)| squared_distance(&p[..n], &t[..n])).collect();
        let squares = energies.iter().zip(&self.energies[k]).map(|(p, t)| square(p - t));
        let energy: Vec<f64> = squares.map(|e| if e.is_finite() { e } else { f64::INFINITY }).collect();
        let wrong = |(p, t): (&[f64], &[f64])| self.wrapped_distance(&p[..n], &t[..n]) > VALID_ERROR;
        let valid = rows().position(wrong).unwrap_or(samples - 1) as f64 * h;
        let frobenius = |squares: &[f64]| squares.iter().sum::<f64>().sqrt() / samples as f64;
        let summary = TrajectoryErrors { q: frobenius(&q), energy: frobenius(&energy), valid, failed };
        Errors { q, energy, summary }
    }

    fn summarise(&self, all: &[Errors], first: Vec<f64>) -> Prediction {
        let curve = |pick: fn(&Errors) -> &[f64], entries: usize| -> Vec<f64> {
            let at = |k: usize| all.iter().map(|errors| pick(errors)[k]).sum::<f64>();
            (0..self.horizon.samples).map(|k| at(k) / (all.len() * entries) as f64).collect()
        };
        Prediction {
            mse_q: curve(|errors| &errors.q, self.angles.len()),
            mse_energy: curve(|errors| &errors.energy, 1),
            trajectories: all.iter().map(|errors| errors.summary).collect(),
            first,
        }
    }

    /// Euclidean distance, modulo whole turns for angles; infinite if it is NaN.
    fn wrapped_distance(&self, predicted: &[f64], exact: &[f64]) -> f64 {
        let differences = predicted.iter().zip(exact).zip(&self.angles);
        let wrapped = differences.map(|((p, t), angle)| if *angle { wrap(p - t) } else { p - t });
        let distance = wrapped.map(square).sum::<f64>().sqrt();
        if distance.is_nan() { f64::INFINITY } else { distance }
    }
}

fn energies(states: &[f64], n: usize, energy: impl Fn(&[f64], &[f64]) -> f64) -> Vec<f64> {
    states.chunks_exact(2 * n).map(|state| energy(&state[..n], &state[n..])).collect()
}

fn squared_distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| square(a - b)).sum()
}

fn square(x: f64) -> f64 {
    x * x
}

/// Wraps an angle to [−π, π).
fn wrap(angle: f64) -> f64 {
    (angle + PI).rem_euclid(TAU) - PI
}

/// Squared errors of one trajectory at each comparison.
struct Errors {
    q: Vec<f64>,
    energy: Vec<f64>,
    summary: TrajectoryErrors,
}

/// Summary of one predicted trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrajectoryErrors {
    /// ‖q̂ − q‖_F / number of comparisons, angles not wrapped: the authors' position error.
    pub q: f64,
    /// ‖Ê − E‖₂ / number of comparisons: the authors' energy error, J.
    pub energy: f64,
    /// Time of the first comparison at which the Euclidean position error, angles wrapped, is above [`VALID_ERROR`], s; the whole horizon
    /// if there is none.
    pub valid: f64,
    /// Whether the prediction could not be followed to the end.
    pub failed: bool,
}

/// The errors of predictions from many starts.
#[derive(Clone, Debug, PartialEq)]
pub struct Prediction {
    /// Errors of each trajectory.
    pub trajectories: Vec<TrajectoryErrors>,
    /// Mean over starts and coordinates of the squared position error (angles not wrapped) at each comparison.
    pub mse_q: Vec<f64>,
    /// Mean over starts of the squared energy error at each comparison, J².
    pub mse_energy: Vec<f64>,
    /// (q, v) along the first start, \[samples\]\[2n\]; not finite after a failure.
    pub first: Vec<f64>,
}

/// Mean and (population) standard deviation over starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Average {
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub deviation: f64,
}

impl Prediction {
    /// The authors' position error, A_q.
    pub fn position(&self) -> Average {
        self.average(|errors| errors.q)
    }

    /// The authors' energy error, A_E.
    pub fn energy(&self) -> Average {
        self.average(|errors| errors.energy)
    }

    /// Valid-prediction time, s.
    pub fn valid(&self) -> Average {
        self.average(|errors| errors.valid)
    }

    /// Median valid-prediction time, s.
    pub fn valid_median(&self) -> f64 {
        super::median(&self.trajectories.iter().map(|errors| errors.valid).collect::<Vec<_>>())
    }

    /// Position and energy errors, as [`Prediction::position`] and [`Prediction::energy`], over only those predictions that reached the
    /// end; `None` if there are none.
    pub fn of_followed(&self) -> Option<[Average; 2]> {
        let followed: Vec<_> = self.trajectories.iter().copied().filter(|errors| !errors.failed).collect();
        let both = [|errors: &TrajectoryErrors| errors.q, |errors: &TrajectoryErrors| errors.energy];
        (!followed.is_empty()).then(|| both.map(|pick| average(&followed, pick)))
    }

    /// Number of predictions that did not reach the end.
    pub fn failed(&self) -> usize {
        self.trajectories.iter().filter(|errors| errors.failed).count()
    }

    fn average(&self, pick: fn(&TrajectoryErrors) -> f64) -> Average {
        average(&self.trajectories, pick)
    }
}

fn average(all: &[TrajectoryErrors], pick: fn(&TrajectoryErrors) -> f64) -> Average {
    let values: Vec<f64> = all.iter().map(pick).collect();
    let mean = super::mean(&values);
    let squares: Vec<f64> = values.iter().map(|x| square(x - mean)).collect();
    Average { mean, deviation: super::mean(&squares).sqrt() }
}
