//! Following a motion from given starts, and logging it.

use super::generate::noisy;
use super::{BadMechanism, ExactMotion, Extrapolation, IntegrationError, second_order};
use leastaction_data::{Dataset, Rows, Trajectory};
use leastaction_models::parallel;
use rand_pcg::Pcg64;
use thiserror::Error;

/// Error of the motion a step, relative to 1 + |x|.
const TOLERANCE: f64 = 1e-12;

/// Why there is no data.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum GenerationError {
    /// No such system.
    #[error(transparent)]
    Mechanism(#[from] BadMechanism),
    /// Its motion cannot be followed.
    #[error(transparent)]
    Integration(#[from] IntegrationError),
    /// Too few trajectories to keep some for the test.
    #[error("a training and a test set need at least 2 trajectories, not {0}")]
    TooFew(usize),
}

/// How long, and how often, a motion is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Horizon {
    /// Time between looks, s.
    pub h: f64,
    /// Looks, that at the start included.
    pub samples: usize,
}

impl Horizon {
    /// Of predictions: 20 looks a second, as the authors', which makes 601 in 30 s.
    pub fn of_seconds(seconds: f64) -> Self {
        Self { h: 0.05, samples: (seconds / 0.05).round() as usize + 1 }
    }
}

/// A state at rest or in motion: positions and velocities.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// q.
    pub q: Vec<f64>,
    /// v.
    pub v: Vec<f64>,
}

/// Trajectories from these starts with positions, velocities and exact accelerations of the states before noise; t = 0 at each
/// start. The noise's standard deviation is that of positions and of velocities.
///
/// # Errors
/// Where the motion cannot be followed.
pub fn logged(
    motion: &dyn ExactMotion,
    starts: &[Start],
    horizon: Horizon,
    noise: f64,
    seed: u64,
) -> Result<Dataset, IntegrationError> {
    let one = |id: usize| {
        // Of its own, so that the number of processors does not matter.
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

/// Gives `keep` the states (q, v) `h` seconds apart from the start on, `samples` of them, under the accelerations v̇(q, v); each
/// is first brought back by `project` to where constraints keep it, as [`ExactMotion::project`] does.
///
/// # Errors
/// Where the motion cannot be followed to the tolerance, relative to 1 + |x| in each step; `t` counts from the start.
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

/// As [`follow`], from a state of any kind, whose rate ẋ = f(x) `rate` writes.
///
/// # Errors
/// As of [`follow`].
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
