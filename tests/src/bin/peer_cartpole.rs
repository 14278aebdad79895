//! The Rust side of `tests/peers/casadi_cartpole.py`: evaluates and times the acceleration and the residual with Jacobian of a 2 × 32 tanh
//! cart-pole network in f32. Files and output are described in `tests/peers/README.md`.

use leastaction_core::continuous::acceleration;
use leastaction_core::discrete::{Control, Interval, Linearised, Midpoint};
use leastaction_core::energy::inertia_network::{Coordinate, Inertia, InertiaNetwork, InertiaNetworkShape};
use leastaction_core::forces::{System, Viscous};
use leastaction_core::network::{Activation, Dense};
use std::error::Error;
use std::hint::black_box;
use std::process::ExitCode;
use std::time::Instant;

/// Features, hidden widths and outputs.
const SIZES: [usize; 4] = [3, 32, 32, 4];
/// Step size h, s, equal to that in the script.
const STEP: f32 = 0.05;
/// Number of calls on every state in a repetition; the fastest of `REPETITIONS` counts.
const PASSES: u32 = 4;
const REPETITIONS: u32 = 5;

type Pair = [f32; 2];
type CartPole<'a> = System<InertiaNetwork<'a, f32, 2, 32, 2>, Viscous<f32, 2>>;

/// One state of the file: q₀, w, p₀, u.
struct State {
    q0: Pair,
    w: Pair,
    p0: Pair,
    u: Pair,
}

impl State {
    fn new(&[q0, q1, w0, w1, p0, p1, u0, u1]: &[f32; 8]) -> Self {
        Self { q0: [q0, q1], w: [w0, w1], p0: [p0, p1], u: [u0, u1] }
    }
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("peer_cartpole: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [weights, states] = arguments.as_slice() else {
        return Err("usage: peer_cartpole WEIGHTS STATES".into());
    };
    let block = panels(&floats(weights)?).ok_or_else(|| format!("{weights}: not 1316 numbers"))?;
    let states = floats(states)?;
    let states: Vec<State> = states.as_chunks().0.iter().map(State::new).collect();
    println!("{}", report(&system(&block).ok_or("the network does not fit")?, &states));
    Ok(())
}

fn floats(path: &str) -> Result<Vec<f32>, Box<dyn Error>> {
    let bytes = std::fs::read(path).map_err(|error| format!("{path}: {error}"))?;
    Ok(bytes.as_chunks().0.iter().map(|word| f32::from_le_bytes(*word)).collect())
}

/// Converts row-major matrices and biases to the layout of [`Dense`]; `None` if the count is wrong.
fn panels(mut numbers: &[f32]) -> Option<Vec<f32>> {
    let mut block = Vec::new();
    for shape in SIZES.windows(2) {
        let &[inputs, outputs] = shape else { return None };
        let (matrix, rest) = numbers.split_at_checked(inputs * outputs)?;
        let (bias, rest) = rest.split_at_checked(outputs)?;
        let mut weights = vec![0.0; matrix.len()];
        for (k, weight) in matrix.iter().enumerate() {
            weights[Dense::<f32>::position(inputs, outputs, k / inputs, k % inputs)] = *weight;
        }
        block.extend(weights);
        block.extend_from_slice(bias);
        numbers = rest;
    }
    numbers.is_empty().then_some(block)
}

fn system(mut block: &[f32]) -> Option<CartPole<'_>> {
    let coordinates = [Coordinate::Translation, Coordinate::Angle];
    let widths = [SIZES[1] as u16, SIZES[2] as u16];
    let inertia = Inertia::Cholesky { epsilon: 1e-9 };
    let shape = InertiaNetworkShape::new(coordinates, &widths, Activation::Tanh, inertia)?;
    InertiaNetwork::take(&mut block, &shape).map(System::conservative)
}

/// Acceleration v̇ at (q₀, w); NaN if the mass matrix is singular.
#[inline(never)]
fn peer_acceleration(system: &CartPole, state: &State) -> Pair {
    acceleration(system, &state.q0, &state.w, &state.u).unwrap_or([f32::NAN; 2])
}

/// Residual R(w) = p₀ + D₁L_d + f⁻ and its Jacobian ∂R/∂w.
#[inline(never)]
fn peer_residual_jacobian(system: &CartPole, state: &State) -> (Pair, [Pair; 2]) {
    let interval = Interval::<f32, Midpoint, 2>::new(state.q0, state.w, STEP, Control::held(state.u));
    let Linearised { balance, momentum_w, .. } = interval.linearise(system);
    ([0, 1].map(|i| state.p0[i] + balance.d1_ld[i]), momentum_w)
}

/// Time of a call, ns.
fn fastest<O>(states: &[State], call: impl Fn(&State) -> O) -> f64 {
    let pass = || states.iter().for_each(|state| drop(black_box(call(black_box(state)))));
    let repetition = || {
        let start = Instant::now();
        (0..PASSES).for_each(|_| pass());
        start.elapsed().as_secs_f64()
    };
    let best = (0..REPETITIONS).map(|_| repetition()).fold(f64::INFINITY, f64::min);
    1e9 * best / (f64::from(PASSES) * states.len() as f64)
}

fn report(system: &CartPole, states: &[State]) -> serde_json::Value {
    let accelerations: Vec<Pair> = states.iter().map(|state| peer_acceleration(system, state)).collect();
    let (residuals, jacobians): (Vec<Pair>, Vec<[Pair; 2]>) =
        states.iter().map(|state| peer_residual_jacobian(system, state)).unzip();
    serde_json::json!({
        "acceleration_ns": fastest(states, |state| peer_acceleration(system, state)),
        "residual_jacobian_ns": fastest(states, |state| peer_residual_jacobian(system, state)),
        "acceleration": accelerations,
        "residual": residuals,
        "jacobian": jacobians.iter().map(|rows| rows.as_flattened()).collect::<Vec<_>>(),
    })
}
