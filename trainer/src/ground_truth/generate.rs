use super::{Exact, Extrapolation, IntegrationError, Mechanism, Spread};
use crate::data::symo::SymoSet;
use crate::data::{Dataset, Rows, Trajectory};
use leastaction_core::continuous::acceleration;
use leastaction_core::energy::trigonometric::Trigonometric;
use leastaction_core::forces::{System, Viscous};
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

/// Error of the ground truth a step, relative to 1 + |x|.
const TOLERANCE: f64 = 1e-13;
/// |u| at most, N or N m.
const CONTROL: f64 = 2.0;

/// What to generate.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Which mechanism.
    pub mechanism: Mechanism,
    /// Trajectories.
    pub trajectories: usize,
    /// States in each.
    pub samples: usize,
    /// Step between states, s.
    pub h: f64,
    /// Standard deviation of the noise on positions (and velocities), m or rad.
    pub noise: f64,
    /// Viscous damping of every coordinate, N s/m or N m s/rad.
    pub drag: f64,
    /// Whether each trajectory has a constant control drawn from U(−2, 2); else none.
    pub control: bool,
    /// Of the random stream.
    pub seed: u64,
}

impl Settings {
    /// SyMo's settings: 34 states a trajectory under a constant random control, no noise, no drag.
    pub fn symo(mechanism: Mechanism, trajectories: usize, seed: u64) -> Self {
        let h = mechanism.step();
        Self { mechanism, trajectories, samples: 34, h, noise: 0.0, drag: 0.0, control: true, seed }
    }
}

/// Trajectories from random initial states of the mechanism, with exact positions, velocities and accelerations.
///
/// # Errors
/// Where the motion cannot be followed.
pub fn generate(settings: &Settings) -> Result<Dataset, IntegrationError> {
    match settings.mechanism.exact() {
        Exact::One(exact) => generate_with(exact, settings),
        Exact::Two(exact) => generate_with(exact, settings),
    }
}

/// The data of SyMo's experiments: 128 training and 128 test trajectories of 34 states, and 16 free ones of 502 states
/// for long integration; noise of this standard deviation on the states of the first two sets.
///
/// # Errors
/// Where the motion cannot be followed.
pub fn symo_set(mechanism: Mechanism, seed: u64, noise: f64) -> Result<SymoSet, IntegrationError> {
    let both = generate(&Settings { noise, ..Settings::symo(mechanism, 256, seed) })?;
    let (train, test) = both.split(128);
    let free =
        Settings { samples: 502, control: false, ..Settings::symo(mechanism, 16, seed.wrapping_add(1)) };
    Ok(SymoSet { train, test, integration: generate(&free)? })
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
    Ok(Dataset { n: N, h: settings.h, trajectories })
}

type Damped<const N: usize> = System<Trigonometric<'static, N>, Viscous<f64, N>>;

fn trajectory<const N: usize>(
    system: &Damped<N>,
    settings: &Settings,
    id: i64,
    stream: &mut Pcg64,
) -> Result<Trajectory, IntegrationError> {
    let mut state = initial_state(settings.mechanism.spread(), stream);
    let control = if settings.control { stream.random_range(-CONTROL..CONTROL) } else { 0.0 };
    let u: [f64; N] =
        core::array::from_fn(|i| if i == settings.mechanism.actuated() { control } else { 0.0 });
    let exact = |state: &[[f64; N]]| acceleration(system, state.first()?, state.last()?, &u).ok();
    let mut rate = |x: &[f64], rate: &mut [f64]| {
        let a = exact(x.as_chunks().0)?;
        rate[..N].copy_from_slice(&x[N..]);
        rate[N..].copy_from_slice(&a);
        Some(())
    };
    let mut integrator = Extrapolation::new(2 * N, TOLERANCE);
    let (mut q, mut v, mut a, mut us) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for k in 0..settings.samples {
        let failed = IntegrationError { t: k as f64 * settings.h, tolerance: TOLERANCE };
        if k > 0 {
            let advanced = integrator.advance(&mut rate, state.as_flattened_mut(), settings.h);
            advanced.map_err(|_| failed)?;
        }
        a.push(exact(&state).ok_or(failed)?);
        q.push(noisy(state[0], settings.noise, stream));
        v.push(noisy(state[1], settings.noise, stream));
        us.push(u);
    }
    let rows = |values: Vec<[f64; N]>| Rows::from_arrays(&values);
    Ok(Trajectory { id, t0: 0.0, q: rows(q), v: Some(rows(v)), a: Some(rows(a)), u: Some(rows(us)) })
}

fn initial_state<const N: usize>(spread: &[Spread], stream: &mut Pcg64) -> [[f64; N]; 2] {
    let mut draw = |limit: fn(&Spread) -> f64| -> [f64; N] {
        core::array::from_fn(|i| spread.get(i).map_or(0.0, |s| stream.random_range(-limit(s)..limit(s))))
    };
    [draw(|s| s.q), draw(|s| s.v)]
}

/// Numbers with normal noise of this standard deviation; without any, nothing is drawn.
pub fn noisy<const N: usize>(x: [f64; N], sigma: f64, stream: &mut Pcg64) -> [f64; N] {
    if sigma == 0.0 {
        return x;
    }
    x.map(|x| {
        let noise: f64 = StandardNormal.sample(stream);
        x + sigma * noise
    })
}
