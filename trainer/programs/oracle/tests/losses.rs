//! Losses for any size: comparison of residuals with core's integrator, and of derivatives with differences.

mod common;

use common::losses::{check_derivatives, check_failures, evaluate};
use leastaction_core::discrete::{Control, Del, Galerkin, Interval, Midpoint, Newton, Path};
use leastaction_core::energy::inertia_network::{Coordinate, Inertia, InertiaNetwork, InertiaNetworkShape};
use leastaction_core::forces::{ControlKind, System as CoreSystem, Viscous};
use leastaction_core::network::Activation;
use leastaction_programs::dynamics::{Accelerations, Order};
use leastaction_programs::energies::{
    Energies, GroupForce, InertiaNetworkEnergies, WithOffsets, with_group_laws,
};
use leastaction_programs::losses::{AccelerationLoss, Block, DelLoss, Loss, NextStateLoss, TorqueLoss};
use leastaction_programs::steps::RungeKutta;
use leastaction_programs::{Row, System, WIDTH};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const H: f64 = 0.02;
const INERTIA: Inertia = Inertia::Cholesky { epsilon: 0.7 };
const KINDS_OF_CONTROL: [ControlKind; 2] = [ControlKind::Held, ControlKind::Linear];
const KINDS: [Coordinate; 3] = [Coordinate::Angle, Coordinate::Translation, Coordinate::Cyclic];

fn model(n: usize) -> InertiaNetworkEnergies {
    let kinds = (0..n).map(|i| KINDS[i % 3]).collect();
    InertiaNetworkEnergies::new(kinds, (&[6, 5], Activation::Tanh), INERTIA, true)
}

fn weights(model: &InertiaNetworkEnergies, seed: u64) -> Vec<f64> {
    let mut stream = Pcg64::seed_from_u64(seed);
    let mut weights: Vec<f64> = (0..model.parameters()).map(|_| stream.random_range(-0.8..0.8)).collect();
    let damping = weights.len() - model.n();
    weights[damping..].iter_mut().for_each(|w| *w = w.abs());
    weights
}

/// Positions that belong to no motion, under a control that changes at every sample.
fn block(n: usize, seed: u64) -> Block {
    let mut stream = Pcg64::seed_from_u64(seed);
    let mut random = |size: f64| -> Vec<Row> {
        (0..n).map(|_| Row(std::array::from_fn(|_| stream.random_range(-size..size)))).collect()
    };
    let (q, v) = (random(1.5), random(2.0));
    let mut moved = |k: f64| -> Vec<Row> {
        let noise = random(0.2 * H);
        let rows = q.iter().zip(&v).zip(noise);
        rows.map(|((q, v), noise)| Row(std::array::from_fn(|l| q.0[l] + k * H * v.0[l] + noise.0[l])))
            .collect()
    };
    let states = [moved(0.0), moved(1.0), moved(2.0)];
    let controls = [random(1.0), random(1.0), random(1.0)];
    Block { states, next_velocity: random(2.0), controls, control: ControlKind::Linear }
}

/// Residuals by core's Newton method, where order and size are types.
fn core_residuals<P: Path, const N: usize>(
    weights: &[f64],
    block: &Block,
    next_position: bool,
) -> Vec<[f64; N]> {
    let kinds = std::array::from_fn(|i| KINDS[i % 3]);
    let shape = InertiaNetworkShape::new(kinds, &[6, 5], Activation::Tanh, INERTIA).unwrap();
    let mut rest = weights;
    let lagrangian = InertiaNetwork::<f64, N, 8, 2>::take(&mut rest, &shape).unwrap();
    let system = CoreSystem { lagrangian, forces: Viscous { coefficients: rest.try_into().unwrap() } };
    let newton = Newton { max_iterations: 50, stop: 1e-14, accept: 1e-9 };
    let _ = Del::<f64, P>::with_newton(H, newton);
    let residual = |sample: usize| {
        let row = |rows: &Vec<Row>| -> [f64; N] { std::array::from_fn(|i| rows[i].0[sample]) };
        let ([q0, q1, q2], [u0, u1, u2]) =
            (block.states.each_ref().map(row), block.controls.each_ref().map(row));
        let acting = |start, end| match block.control {
            ControlKind::Held => Control::held(start),
            ControlKind::Linear => Control { start, end },
        };
        let w = |a: [f64; N], b: [f64; N]| -> [f64; N] { std::array::from_fn(|i| (b[i] - a[i]) / H) };
        let before = Interval::<f64, P, N>::new(q0, w(q0, q1), H, acting(u0, u1));
        let p = newton.solve_bubble(&system, before).unwrap().balance.end_momentum();
        let after = Interval::<f64, P, N>::new(q1, w(q1, q2), H, acting(u1, u2));
        if next_position {
            let solved = newton.solve_step(&system, after, &p).unwrap().interval.increment();
            return std::array::from_fn(|i| H * solved[i] - (q2[i] - q1[i]));
        }
        let balance = newton.solve_bubble(&system, after).unwrap().balance;
        std::array::from_fn(|i| p[i] + balance.d1_ld[i])
    };
    (0..WIDTH).map(residual).collect()
}

fn check_del<const N: usize>() {
    let model = model(N);
    let (system, weights) = (System::new(&model), weights(&model, N as u64));
    for (order, next_position) in
        [(Order::Two, false), (Order::Two, true), (Order::Four, false), (Order::Four, true)]
    {
        for control in KINDS_OF_CONTROL {
            let block = Block { control, ..block(N, 17 + N as u64) };
            let mut loss = DelLoss::new(&system, H, order, next_position);
            check_residuals::<N>(&mut loss, &weights, &block, (order, next_position));
            check_derivatives(&mut loss, &weights, &block, 2e-6);
        }
    }
}

fn check_residuals<const N: usize>(
    loss: &mut DelLoss,
    weights: &[f64],
    block: &Block,
    (order, next_position): (Order, bool),
) {
    let found = evaluate(loss, weights, block);
    let expected = match order {
        Order::Two => core_residuals::<Midpoint, N>(weights, block, next_position),
        Order::Four => core_residuals::<Galerkin, N>(weights, block, next_position),
    };
    for (sample, expected) in expected.iter().enumerate() {
        for i in 0..N {
            let (found, expected) = (found[i].0[sample], expected[i]);
            let error = (found - expected).abs();
            assert!(error < 1e-12, "{order:?} {next_position} {:?}: {found} {expected}", block.control);
        }
    }
}

#[test]
fn one_coordinate() {
    check_del::<1>();
}

#[test]
fn two_coordinates() {
    check_del::<2>();
}

#[test]
fn three_coordinates() {
    check_del::<3>();
}

#[test]
fn seven_coordinates() {
    check_del::<7>();
}

#[test]
fn accelerations() {
    for n in [1, 2, 5] {
        let model = model(n);
        let (system, weights) = (System::new(&model), weights(&model, 3));
        check_derivatives(&mut AccelerationLoss::new(&system), &weights, &block(n, 5), 1e-6);
    }
}

#[test]
fn torques() {
    for n in [1, 2, 5] {
        let model = model(n);
        let (system, weights) = (System::new(&model), weights(&model, 3));
        check_derivatives(&mut TorqueLoss::new(&system), &weights, &block(n, 5), 1e-6);
    }
}

/// Friction that grows with the load, drives with torque offsets, and a separate unit for each coordinate.
#[test]
fn torques_of_drives_in_units_of_their_own() {
    let laws = [GroupForce::Viscous, GroupForce::Coulomb { loaded: true }];
    let plain = InertiaNetworkEnergies::new(vec![KINDS[0]; 3], (&[5], Activation::Tanh), INERTIA, false);
    let of_network = plain.parameters();
    let model = WithOffsets::new(with_group_laws(Box::new(plain), &laws, (3, &[0, 1, 2])).unwrap());
    let mut stream = Pcg64::seed_from_u64(7);
    let mut weights: Vec<f64> = (0..model.parameters()).map(|_| stream.random_range(-0.8..0.8)).collect();
    weights[of_network..].iter_mut().for_each(|number| *number = number.abs() + 0.1);
    let (system, block) = (System::new(&model), block(3, 5));
    let units = [0.5, 2.0, 10.0];
    let mut loss = TorqueLoss::new(&system).in_units(&units);
    check_derivatives(&mut loss, &weights, &block, 1e-6);
    let found = evaluate(&mut loss, &weights, &block);
    for ((found, plain), unit) in
        found.iter().zip(evaluate(&mut TorqueLoss::new(&system), &weights, &block)).zip(units)
    {
        assert!(found.0.iter().zip(&plain.0).all(|(found, plain)| (found * unit - plain).abs() < 1e-12));
    }
    // An offset is equivalent to the same torque in the log.
    let (offsets, mut shifted) = (weights.len() - 3, block.clone());
    for (row, offset) in shifted.controls[0].iter_mut().zip(&weights[offsets..]) {
        row.0.iter_mut().for_each(|u| *u += offset);
    }
    let mut without = weights.clone();
    without[offsets..].fill(0.0);
    for (a, b) in found.iter().zip(evaluate(&mut loss, &without, &shifted)) {
        assert!(a.0.iter().zip(&b.0).all(|(a, b)| (a - b).abs() < 1e-12));
    }
}

/// A motion needs exactly the torque that causes it; an additional acceleration needs M times this acceleration more.
#[test]
fn torques_are_those_that_accelerate() {
    let model = model(3);
    let (system, weights, mut block) = (System::new(&model), weights(&model, 3), block(3, 5));
    let (mut accelerations, mut a) = (Accelerations::new(&system), vec![Row::default(); 3]);
    let state = [&block.states[0][..], &block.states[1], &block.controls[0]];
    assert!(!accelerations.evaluate(&weights, state, &mut a, None).any(WIDTH));
    block.states[2] = a;
    let mut loss = TorqueLoss::new(&system);
    let balanced = evaluate(&mut loss, &weights, &block);
    assert!(balanced.iter().all(|r| r.0.iter().all(|r| r.abs() < 1e-11)), "{balanced:?}");
    block.states[2][1].0.iter_mut().for_each(|a| *a += 1.0);
    for (i, found) in evaluate(&mut loss, &weights, &block).iter().enumerate() {
        let mass = accelerations.mass(i, 1);
        assert!((0..WIDTH).all(|k| (found.0[k] - mass.0[k]).abs() < 1e-11), "{found:?} {mass:?}");
    }
}

#[test]
fn next_states() {
    for n in [1, 2, 5] {
        let model = model(n);
        let (system, weights) = (System::new(&model), weights(&model, 3));
        for (order, control) in [(2, ControlKind::Held), (4, ControlKind::Held), (4, ControlKind::Linear)] {
            let mut loss = NextStateLoss::new(&system, H, RungeKutta::of_order(order));
            check_derivatives(&mut loss, &weights, &Block { control, ..block(n, 5) }, 1e-6);
        }
    }
}

/// Replacing a control that a kind of control does not use changes nothing; replacing one that it uses changes the
/// residual.
#[test]
fn a_held_control_is_that_at_the_start_of_a_step() {
    let model = model(2);
    let (system, weights) = (System::new(&model), weights(&model, 3));
    let good = block(2, 5);
    let losses: [(Box<dyn Loss>, usize); 2] = [
        (Box::new(DelLoss::new(&system, H, Order::Four, true)), 2),
        (Box::new(NextStateLoss::new(&system, H, RungeKutta::ThreeEighths)), 1),
    ];
    for (mut loss, last) in losses {
        for control in KINDS_OF_CONTROL {
            let mut block = Block { control, ..good.clone() };
            let before = evaluate(&mut *loss, &weights, &block);
            block.controls[last] = block.states[0].clone();
            let same = before == evaluate(&mut *loss, &weights, &block);
            assert_eq!(same, control == ControlKind::Held);
            block.controls[last - 1] = block.states[0].clone();
            assert_ne!(before, evaluate(&mut *loss, &weights, &block));
        }
    }
}

/// A sample that cannot be solved leaves the other samples unchanged.
#[test]
fn what_fails_fails_alone() {
    let model = model(2);
    let (system, weights) = (System::new(&model), weights(&model, 3));
    let good = block(2, 5);
    let mut bad = good.clone();
    bad.states[0][0].0[7] = f64::NAN;
    let losses: [Box<dyn Loss>; 5] = [
        Box::new(DelLoss::new(&system, H, Order::Four, true)),
        Box::new(DelLoss::new(&system, H, Order::Two, false)),
        Box::new(AccelerationLoss::new(&system)),
        Box::new(NextStateLoss::new(&system, H, RungeKutta::ThreeEighths)),
        Box::new(TorqueLoss::new(&system)),
    ];
    for mut loss in losses {
        check_failures(&mut *loss, &weights, [&good, &bad], &[7]);
    }
}
