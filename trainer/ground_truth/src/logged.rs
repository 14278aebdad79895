//! Integration of a motion from given starts, and logging of it.

use super::generate::noisy;
use super::{BadMechanism, ExactMotion, Extrapolation, IntegrationError, second_order};
use leastaction_data::{Dataset, Rows, Trajectory};
use leastaction_models::parallel;
use rand_pcg::Pcg64;
use thiserror::Error;

/// Error tolerance of the motion per step, relative to 1 + |x|.
const TOLERANCE: f64 = 1e-12;

/// The reason why there is no data.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum GenerationError {
    /// The mechanism is invalid.
    #[error(transparent)]
    Mechanism(#[from] BadMechanism),
    /// The motion cannot be integrated.
    #[error(transparent)]
    Integration(#[from] IntegrationError),
    /// There are too few trajectories to hold some back for the test.
    #[error("a training and a test set need at least 2 trajectories, not {0}")]
    TooFew(usize),
}

/// Sampling of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Horizon {
    /// Time between samples, s.
    pub h: f64,
    /// Number of samples, including that at the start.
    pub samples: usize,
}

impl Horizon {
    /// The horizon of predictions: 20 samples per second, as in the authors' program; 601 samples in 30 s.
    pub fn of_seconds(seconds: f64) -> Self {
        Self { h: 0.05, samples: (seconds / 0.05).round() as usize + 1 }
    }
}

/// An initial state: positions and velocities.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// Positions q.
    pub q: Vec<f64>,
    /// Velocities v.
    pub v: Vec<f64>,
}

/// Trajectories from these starts, with positions, velocities, and the exact accelerations of the noise-free states; t
/// = 0 at each start. `noise` is the standard deviation for positions and for velocities.
///
/// # Errors
/// [`IntegrationError`] if the motion cannot be integrated.
pub fn logged(
    motion: &dyn ExactMotion,
    starts: &[Start],
    horizon: Horizon,
    noise: f64,
    seed: u64,
) -> Result<Dataset, IntegrationError> {
    let one = |id: usize| {
        // Each trajectory has its own random stream, so that the number of threads does not matter.
        let stream = Pcg64::new(u128::from(seed), id as u128 + 1);
        trajectory(motion, horizon, id, &starts[id], (noise, stream))
    };
    let trajectories = parallel::map(starts.len(), &one).into_iter().collect::<Result<_, _>>()?;
    Ok(Dataset { n: motion.coordinates(), h: horizon.h, control: None, trajectories })
}

fn trajectory(
    motion: &dyn ExactMotion,
    horizon: Horizon,
    id: usize,
    start: &Start,
    (noise, mut stream): (f64, Pcg64),
) -> Result<Trajectory, IntegrationError> {
    let n = motion.coordinates();
    let Horizon { h, samples } = horizon;
    let exact = |q: &[f64], v: &[f64], a: &mut [f64]| motion.acceleration(q, v, a);
    let mut states = Vec::with_capacity(2 * n * samples);
    let project = |state: &mut [f64]| motion.project(state);
    follow(exact, project, start, horizon, TOLERANCE, |state| states.extend_from_slice(state))?;
    let (mut q, mut v, mut a) = (Vec::new(), Vec::new(), vec![0.0; n * samples]);
    for ((k, state), a) in states.chunks_exact(2 * n).enumerate().zip(a.chunks_exact_mut(n)) {
        let (position, velocity) = state.split_at(n);
        let failed = IntegrationError { t: k as f64 * h, tolerance: TOLERANCE };
        motion.acceleration(position, velocity, a).ok_or(failed)?;
        q.extend(position.iter().map(|x| noisy([*x], noise, &mut stream)[0]));
        v.extend(velocity.iter().map(|x| noisy([*x], noise, &mut stream)[0]));
    }
    let unfit = IntegrationError { t: 0.0, tolerance: TOLERANCE };
    let rows = |values| Rows::from_flat(n, values).ok_or(unfit);
    Ok(Trajectory { id: id as i64, t0: 0.0, q: rows(q)?, v: Some(rows(v)?), a: Some(rows(a)?), u: None })
}

/// Passes `samples` states (q, v), `h` seconds apart from the start on, to `keep`; the motion follows the accelerations
/// v̇(q, v). Each state is first projected onto the constraints by `project`, see [`ExactMotion::project`].
///
/// # Errors
/// [`IntegrationError`] if the tolerance, relative to 1 + |x| per step, cannot be kept; its `t` counts from the start.
pub fn follow(
    acceleration: impl FnMut(&[f64], &[f64], &mut [f64]) -> Option<()>,
    project: impl FnMut(&mut [f64]) -> Option<()>,
    start: &Start,
    horizon: Horizon,
    tolerance: f64,
    keep: impl FnMut(&[f64]),
) -> Result<(), IntegrationError> {
    let state = [start.q.as_slice(), &start.v].concat();
    follow_flow(second_order(acceleration), project, state, (horizon, tolerance), keep)
}

/// Integrates as [`follow`] does, but from a state of any kind with the rate ẋ = f(x) that `rate` writes.
///
/// # Errors
/// See [`follow`].
pub fn follow_flow(
    mut rate: impl FnMut(&[f64], &mut [f64]) -> Option<()>,
    mut project: impl FnMut(&mut [f64]) -> Option<()>,
    mut state: Vec<f64>,
    (horizon, tolerance): (Horizon, f64),
    mut keep: impl FnMut(&[f64]),
) -> Result<(), IntegrationError> {
    let mut integrator = Extrapolation::new(state.len(), tolerance);
    for k in 0..horizon.samples {
        if k > 0 {
            let before = (k - 1) as f64 * horizon.h;
            let at = |error: IntegrationError| IntegrationError { t: before + error.t, ..error };
            integrator.advance(&mut rate, &mut state, horizon.h).map_err(at)?;
            project(&mut state).ok_or(IntegrationError { t: before + horizon.h, tolerance })?;
        }
        keep(&state);
    }
    Ok(())
}
