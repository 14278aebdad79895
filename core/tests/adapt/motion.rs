//! Numbers that are known exactly, found from the motion of a simulated arm.

use crate::common::arms::{self, Arm};
use crate::common::network_laws::NetworkLaws;
use leastaction_core::adapt::{Adapter, Limits, Moment, Number, Tuning};
use leastaction_core::continuous::{ContinuousState, rk4_step};
use leastaction_core::energy::arm::{ARM_GRAVITY_PARAMETERS, ARM_PARAMETERS, INERTIAL_PARAMETERS};
use leastaction_core::forces::{Coefficient, Coulomb, DryFriction, Forces, System, Viscous};
use leastaction_core::lagrangian::Lagrangian;

const N: usize = 3;
const H: f64 = 2e-3;

type Laws = (Viscous<f64, N>, Coulomb<f64, N>);

fn laws(viscous: [f64; N], dry: [f64; N]) -> Laws {
    let coordinates = dry.map(|constant| DryFriction { constant, width: 0.1, ..DryFriction::none() });
    (Viscous { coefficients: viscous }, Coulomb { coordinates })
}

/// Smooth forces that excite all coordinates.
fn force(t: f64) -> [f64; N] {
    let wave = |i: usize, k: usize| {
        let (i, k) = (i as f64, k as f64);
        (2.0 + i) * (3.1 * k * t + 1.7 * i * k).sin() / k
    };
    core::array::from_fn(|i| (1..4).map(|k| wave(i, k)).sum())
}

/// Runs an adapter of the model along a motion of the machine.
fn run<M, F, L, G, const P: usize, const T: usize>(
    (machine, model): (&System<M, F>, &System<L, G>),
    (adapter, tuning): (&mut Adapter<f64, N, P, T>, &Tuning<f64, N, P>),
    ticks: usize,
    drive: impl Fn([f64; N]) -> [f64; N],
) where
    M: Lagrangian<f64, N>,
    F: Forces<f64, N>,
    L: Lagrangian<f64, N>,
    G: Forces<f64, N>,
{
    const PARTS: usize = 20;
    let mut state = ContinuousState { q: [0.2, -0.4, 0.5], v: [0.0; N] };
    for k in 0..ticks {
        let t = k as f64 * H;
        let command = force(t);
        adapter.take(tuning, model, &Moment { q: state.q, v: state.v, command, force: command });
        for part in 0..PARTS {
            let h = H / PARTS as f64;
            state = rk4_step(machine, &state, &drive(force(t + (part as f64 + 0.5) * h)), h).expect("a step");
        }
    }
}

fn tuning<const P: usize>(numbers: [Number; P], prior: [f64; P]) -> Tuning<f64, N, P> {
    let limits = Limits { model: [1.0; P], lower: [-1e3; P], upper: [1e3; P], kept: 0.1 };
    let (half, deviation) = (100, [1e-2; N]);
    Tuning {
        numbers,
        half,
        h: H,
        deviation,
        prior,
        forgotten: 0.0,
        walk: [0.0; P],
        change: 50.0,
        limits,
        dry: None,
    }
}

fn first_number(body: usize) -> usize {
    ARM_GRAVITY_PARAMETERS + body * ARM_PARAMETERS + ARM_PARAMETERS - 1 - INERTIAL_PARAMETERS
}

/// The arm of three, with a body more on its last one.
fn loaded(arm: &Arm<N>, load: &[f64; INERTIAL_PARAMETERS]) -> Arm<N> {
    let mut loaded = arm.clone();
    let last = &mut loaded.weights[first_number(N - 1)..][..INERTIAL_PARAMETERS];
    last.iter_mut().zip(load).for_each(|(own, more)| *own += more);
    loaded
}

const LOAD: [f64; INERTIAL_PARAMETERS] = [1.5, 0.1, -0.2, 0.15, 0.06, 0.02, 0.04, -0.015, 0.03, 0.05];

#[test]
fn a_load_and_friction_are_found() {
    let arm = &arms::of_three()[0];
    let heavy = loaded(arm, &LOAD);
    let machine = System { lagrangian: heavy.in_f64(), forces: laws([0.3, 0.5, 0.2], [0.6, 0.3, 0.4]) };
    let model = System { lagrangian: arm.in_f64(), forces: laws([0.2, 0.5, 0.3], [0.4, 0.5, 0.2]) };
    let numbers: [Number; 16] = core::array::from_fn(|j| match j {
        0..10 => Number::Inertia { body: 2, index: j as u8 },
        10..13 => Number::Friction(Coefficient::Viscous, j as u8 - 10),
        _ => Number::Friction(Coefficient::Coulomb, j as u8 - 13),
    });
    let expected: [f64; 16] = core::array::from_fn(|j| match j {
        0..10 => LOAD[j],
        10..13 => [0.1, 0.0, -0.1][j - 10],
        _ => [0.2, -0.2, 0.2][j - 13],
    });
    let tuning = tuning(numbers, [10.0; 16]);
    let mut adapter = Adapter::<_, N, 16, 120>::new(&tuning).unwrap();
    run((&machine, &model), (&mut adapter, &tuning), 10_000, |u| u);
    for (j, (found, expected)) in adapter.filter().estimate().iter().zip(expected).enumerate() {
        assert!((found - expected).abs() < 2e-3, "number {j}: {found} instead of {expected}");
    }
}

#[test]
fn rotors_offsets_and_gains_are_found() {
    let arm = &arms::of_three()[0];
    let mut heavy = arm.clone();
    heavy.weights[first_number(1) + INERTIAL_PARAMETERS] += 0.07;
    let forces = laws([0.2; N], [0.0; N]);
    let machine = System { lagrangian: heavy.in_f64(), forces };
    let model = System { lagrangian: arm.in_f64(), forces };
    let numbers = [Number::Rotor(1), Number::Offset(0), Number::Gain(2), Number::Gain(0), Number::None];
    let tuning = tuning(numbers, [1.0, 1.0, 1.0, 1.0, 0.0]);
    let mut adapter = Adapter::<_, N, 5, 10>::new(&tuning).unwrap();
    run((&machine, &model), (&mut adapter, &tuning), 10_000, |[a, b, c]| [1.05 * a + 0.2, b, 0.9 * c]);
    for (j, expected) in [0.07, 0.2, -0.1, 0.05, 0.0].into_iter().enumerate() {
        let found = adapter.filter().estimate()[j];
        assert!((found - expected).abs() < 1e-3, "number {j}: {found} instead of {expected}");
    }
}

#[test]
fn weights_of_a_potential_and_strengths_of_dissipation_are_found() {
    let arm = &arms::of_three()[0];
    let model_laws = NetworkLaws::of(N, 5);
    let numbers: [Number; 6] = core::array::from_fn(|j| match j {
        0..4 => Number::Potential(j as u8),
        _ => Number::Dissipation(j as u8 - 4),
    });
    let expected = [0.3, -0.2, 0.1, 0.4, 0.25, -0.4];
    let mut changed = NetworkLaws::of(N, 5);
    let last = changed.of_potential.len() - 5;
    changed.of_potential[last..].iter_mut().zip(expected).take(4).for_each(|(own, more)| *own += more);
    // Output i of three is the row of four weights, then come the biases; the entries of L are (0, 0), (1, 0) and (1, 1).
    let first = changed.of_dissipation.len() - 15;
    let factors = [1.25_f64, 1.25, 0.6].map(f64::sqrt);
    for (i, factor) in factors.into_iter().enumerate() {
        let own = &mut changed.of_dissipation[first..];
        own[4 * i..][..4].iter_mut().for_each(|weight| *weight *= factor);
        own[12 + i] *= factor;
    }
    let machine = System { lagrangian: arm.in_f64(), forces: changed.in_f64::<N>() };
    let model = System { lagrangian: arm.in_f64(), forces: model_laws.in_f64::<N>() };
    let tuning = tuning(numbers, [1.0; 6]);
    let mut adapter = Adapter::<_, N, 6, 15>::new(&tuning).unwrap();
    run((&machine, &model), (&mut adapter, &tuning), 3_000, |u| u);
    for (j, (found, expected)) in adapter.filter().estimate().iter().zip(expected).enumerate() {
        assert!((found - expected).abs() < 5e-3, "number {j}: {found} instead of {expected}");
    }
}
