use super::{Exact, Extrapolation, IntegrationError, Mechanism, Spread};
use leastaction_core::continuous::acceleration;
use leastaction_core::energy::trigonometric::Trigonometric;
use leastaction_core::forces::{ControlKind, System, Viscous};
use leastaction_data::symo::SymoSet;
use leastaction_data::{Dataset, Rows, Trajectory};
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

/// Error tolerance of the ground truth per step, relative to 1 + |x|.
const TOLERANCE: f64 = 1e-13;
/// Largest |u|, N or N m.
const CONTROL: f64 = 2.0;

/// Force on the actuated coordinate, drawn from U(−2, 2) N or N m.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drive {
    /// No force.
    Free,
    /// A constant force for each trajectory.
    Constant,
    /// A new force at every sample, held or linear between samples.
    Changing(ControlKind),
}

impl Drive {
    /// Draws the force at every sample.
    fn draw(self, samples: usize, stream: &mut Pcg64) -> Vec<f64> {
        let mut one = || stream.random_range(-CONTROL..CONTROL);
        match self {
            Self::Free => vec![0.0; samples],
            Self::Constant => vec![one(); samples],
            Self::Changing(_) => (0..samples).map(|_| one()).collect(),
        }
    }

    /// The control kind that a log states; `None` if the kind does not matter.
    fn kind(self) -> Option<ControlKind> {
        match self {
            Self::Free | Self::Constant => None,
            Self::Changing(kind) => Some(kind),
        }
    }
}

/// Settings of the generated data.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Mechanism.
    pub mechanism: Mechanism,
    /// Number of trajectories.
    pub trajectories: usize,
    /// Number of states in each trajectory.
    pub samples: usize,
    /// Step between states, s.
    pub h: f64,
    /// Standard deviation of the noise on positions (and velocities), m or rad.
    pub noise: f64,
    /// Viscous damping of every coordinate, N s/m or N m s/rad.
    pub drag: f64,
    /// Force on the actuated coordinate.
    pub drive: Drive,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl Settings {
    /// SyMo's settings: 34 states per trajectory under a constant random control, without noise or drag.
    pub fn symo(mechanism: Mechanism, trajectories: usize, seed: u64) -> Self {
        let h = mechanism.step();
        let drive = Drive::Constant;
        Self { mechanism, trajectories, samples: 34, h, noise: 0.0, drag: 0.0, drive, seed }
    }
}

/// Generates trajectories from random initial states, with exact positions, velocities and accelerations.
///
/// # Errors
/// [`IntegrationError`] if the motion cannot be integrated.
pub fn generate(settings: &Settings) -> Result<Dataset, IntegrationError> {
    match settings.mechanism.exact() {
        Exact::One(exact) => generate_with(exact, settings),
        Exact::Two(exact) => generate_with(exact, settings),
    }
}

/// The data of SyMo's experiments: 128 training and 128 test trajectories of 34 states, with noise of this standard
/// deviation on their states, and 16 free trajectories of 502 states for long integration. The control is linear
/// between samples, as in the authors' equation, and constant within a trajectory.
///
/// # Errors
/// [`IntegrationError`] if the motion cannot be integrated.
pub fn symo_set(mechanism: Mechanism, seed: u64, noise: f64) -> Result<SymoSet, IntegrationError> {
    let linear = |settings: &Settings| -> Result<Dataset, IntegrationError> {
        Ok(Dataset { control: Some(ControlKind::Linear), ..generate(settings)? })
    };
    let both = linear(&Settings { noise, ..Settings::symo(mechanism, 256, seed) })?;
    let (train, test) = both.split(128);
    let free = Settings::symo(mechanism, 16, seed.wrapping_add(1));
    let integration = linear(&Settings { samples: 502, drive: Drive::Free, ..free })?;
    Ok(SymoSet { train, test, integration })
}

fn generate_with<const N: usize>(
    exact: Trigonometric<'static, N>,
    settings: &Settings,
) -> Result<Dataset, IntegrationError> {
    let forces = Viscous { coefficients: [settings.drag; N] };
    let system = System { lagrangian: exact, forces };
    let mut stream = Pcg64::seed_from_u64(settings.seed);
    let trajectories = (0..settings.trajectories)
        .map(|id| trajectory(&system, settings, id as i64, &mut stream))
        .collect::<Result<_, _>>()?;
    Ok(Dataset { n: N, h: settings.h, control: settings.drive.kind(), trajectories })
}

type Damped<const N: usize> = System<Trigonometric<'static, N>, Viscous<f64, N>>;

fn trajectory<const N: usize>(
    system: &Damped<N>,
    settings: &Settings,
    id: i64,
    stream: &mut Pcg64,
) -> Result<Trajectory, IntegrationError> {
    let mut state = initial_state(settings.mechanism.spread(), stream);
    let actuated = settings.mechanism.actuated();
    let force = |u: f64| -> [f64; N] { core::array::from_fn(|i| if i == actuated { u } else { 0.0 }) };
    let us: Vec<[f64; N]> = settings.drive.draw(settings.samples, stream).into_iter().map(force).collect();
    let mut integrator = Extrapolation::new(2 * N + 1, TOLERANCE);
    let (mut q, mut v, mut a) = (Vec::new(), Vec::new(), Vec::new());
    for (k, u) in us.iter().enumerate() {
        let failed = IntegrationError { t: k as f64 * settings.h, tolerance: TOLERANCE };
        if k > 0 {
            let held = settings.drive.kind() != Some(ControlKind::Linear);
            let ends = [&us[k - 1], if held { &us[k - 1] } else { u }];
            advance(system, &mut integrator, &mut state, (settings.h, ends)).map_err(|_| failed)?;
        }
        a.push(acceleration(system, &state[0], &state[1], u).map_err(|_| failed)?);
        q.push(noisy(state[0], settings.noise, stream));
        v.push(noisy(state[1], settings.noise, stream));
    }
    let rows = |values: Vec<[f64; N]>| Rows::from_arrays(&values);
    Ok(Trajectory { id, t0: 0.0, q: rows(q), v: Some(rows(v)), a: Some(rows(a)), u: Some(rows(us)) })
}

/// Advances by one step under a force that is linear between its ends.
fn advance<const N: usize>(
    system: &Damped<N>,
    integrator: &mut Extrapolation,
    state: &mut [[f64; N]; 2],
    (h, [first, last]): (f64, [&[f64; N]; 2]),
) -> Result<(), IntegrationError> {
    // State vector: positions, velocities, and the elapsed fraction of the step.
    let mut x = [state.as_flattened(), &[0.0]].concat();
    let rate = |x: &[f64], rate: &mut [f64]| {
        let ([q, v, ..], c) = (x.as_chunks::<N>().0, x.last()?) else { return None };
        let u = core::array::from_fn(|i| first[i] + c * (last[i] - first[i]));
        let a = acceleration(system, q, v, &u).ok()?;
        rate[..N].copy_from_slice(v);
        rate[N..2 * N].copy_from_slice(&a);
        rate[2 * N] = 1.0 / h;
        Some(())
    };
    integrator.advance(rate, &mut x, h)?;
    state.as_flattened_mut().copy_from_slice(&x[..2 * N]);
    Ok(())
}

fn initial_state<const N: usize>(spread: &[Spread], stream: &mut Pcg64) -> [[f64; N]; 2] {
    let mut draw = |limit: fn(&Spread) -> f64| -> [f64; N] {
        core::array::from_fn(|i| spread.get(i).map_or(0.0, |s| stream.random_range(-limit(s)..limit(s))))
    };
    [draw(|s| s.q), draw(|s| s.v)]
}

/// Adds normal noise of this standard deviation; draws nothing if it is 0.
pub fn noisy<const N: usize>(x: [f64; N], sigma: f64, stream: &mut Pcg64) -> [f64; N] {
    if sigma == 0.0 {
        return x;
    }
    x.map(|x| {
        let noise: f64 = StandardNormal.sample(stream);
        x + sigma * noise
    })
}
