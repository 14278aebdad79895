//! Comparison of trees of rigid bodies with the printed formulas, and with differences of them.

mod common;

use common::Numbers;
use leastaction_core::energy::bodies::{
    BODY_PARAMETERS, BodyParameters, BodyTree, GRAVITY_PARAMETERS, Joint, PlanarBodies, TreeBody, TreeError,
};
use leastaction_core::forces;
use leastaction_programs::energies::{BodiesEnergies, Energies};
use leastaction_programs::{System, WIDTH, Workspace};

const STEP: f64 = 1e-5;

const fn body(joint: Joint, parent: Option<u8>) -> TreeBody {
    TreeBody { joint, parent }
}

/// Two branches on a cart, one of which slides.
const BRANCHED: [TreeBody; 5] = [
    body(Joint::Prismatic, None),
    body(Joint::Revolute, Some(0)),
    body(Joint::Prismatic, Some(1)),
    body(Joint::Revolute, Some(2)),
    body(Joint::Revolute, Some(0)),
];
const CHAIN: [TreeBody; 2] = [body(Joint::Revolute, None), body(Joint::Revolute, Some(0))];

/// Random numbers; masses and inertias are positive.
fn weights(bodies: usize, seed: u64) -> Vec<f64> {
    let mut weights = common::random_weights(GRAVITY_PARAMETERS + BODY_PARAMETERS * bodies, seed);
    for body in weights[GRAVITY_PARAMETERS..].chunks_exact_mut(BODY_PARAMETERS) {
        for positive in [3, 6, 7] {
            body[positive] += 1.0;
        }
    }
    weights
}

fn turned([x, y]: [f64; 2], angle: f64) -> [f64; 2] {
    let (sine, cosine) = angle.sin_cos();
    [cosine * x - sine * y, sine * x + cosine * y]
}

fn plus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

/// Angle and centre of mass of every body.
fn places(bodies: &[TreeBody], weights: &[f64], q: &[f64]) -> Vec<(f64, [f64; 2])> {
    let (mut frames, mut places): (Vec<(f64, [f64; 2])>, Vec<_>) = (Vec::new(), Vec::new());
    for (i, (body, numbers)) in bodies.iter().zip(numbers(weights)).enumerate() {
        let (angle, origin) = body.parent.map_or((0.0, [0.0; 2]), |parent| frames[usize::from(parent)]);
        let joint = plus(origin, turned(numbers.place, angle));
        let (angle, origin) = match body.joint {
            Joint::Revolute => (angle + numbers.angle + q[i], joint),
            Joint::Prismatic => {
                (angle + numbers.angle, plus(joint, turned([q[i], 0.0], angle + numbers.angle)))
            }
        };
        frames.push((angle, origin));
        places.push((angle, plus(origin, turned(numbers.centre, angle))));
    }
    places
}

fn numbers(weights: &[f64]) -> Vec<BodyParameters<f64>> {
    let bodies = weights[GRAVITY_PARAMETERS..].chunks_exact(BODY_PARAMETERS);
    bodies.map(|numbers| BodyParameters::from_array(numbers.try_into().unwrap())).collect()
}

/// Energies T and V by the printed formulas, with velocities by central differences.
fn printed(bodies: &[TreeBody], weights: &[f64], q: &[f64], v: &[f64]) -> [f64; 2] {
    let moved = |t: f64| {
        let q: Vec<f64> = q.iter().zip(v).map(|(q, v)| q + t * v).collect();
        places(bodies, weights, &q)
    };
    let (back, now, forth) = (moved(-STEP), places(bodies, weights, q), moved(STEP));
    let rate = |forth: f64, back: f64| (forth - back) / (2.0 * STEP);
    let spin = |i: usize| rate(forth[i].0, back[i].0);
    let (mut kinetic, mut potential) = (0.0, 0.0);
    for (i, (body, numbers)) in bodies.iter().zip(self::numbers(weights)).enumerate() {
        let speed: f64 = (0..2).map(|k| rate(forth[i].1[k], back[i].1[k]).powi(2)).sum();
        let of_rotor = body.parent.map_or(0.0, |parent| spin(usize::from(parent))) + numbers.gear * v[i];
        kinetic +=
            numbers.mass * speed + numbers.inertia * spin(i).powi(2) + numbers.rotor * of_rotor.powi(2);
        potential -= numbers.mass * (0..2).map(|k| weights[k] * now[i].1[k]).sum::<f64>();
    }
    [0.5 * kinetic, potential]
}

fn model(bodies: &[TreeBody]) -> BodiesEnergies {
    BodiesEnergies::new(bodies.to_vec()).unwrap()
}

#[track_caller]
fn close(found: f64, expected: f64, tolerance: f64) {
    let error = (found - expected).abs() / (1.0 + expected.abs());
    assert!(error < tolerance, "{found} instead of {expected}");
}

fn check_energies<const N: usize>(bodies: [TreeBody; N], seed: u64) {
    let numbers = Numbers::<N>::new(weights(N, seed), 2.0, seed);
    let (found, _) = numbers.run(&System::new(&model(&bodies)).energies(), &[0, 1]);
    for sample in 0..WIDTH {
        let [q, v] = [0, 1].map(|vector| numbers.of(vector, sample));
        for (i, expected) in printed(&bodies, &numbers.weights, &q, &v).into_iter().enumerate() {
            close(found.output(i)[0].0[sample], expected, 1e-8);
        }
    }
}

#[test]
fn energies_are_the_printed_formulas() {
    check_energies(CHAIN, 1);
    check_energies(BRANCHED, 2);
    check_energies([body(Joint::Prismatic, None), body(Joint::Prismatic, Some(0)), CHAIN[0]], 3);
}

fn check_against_core<const N: usize>(bodies: [TreeBody; N], seed: u64) {
    let numbers = Numbers::<N>::new(weights(N, seed), 2.0, seed);
    let lagrangian = PlanarBodies::take(&mut &numbers.weights[..], BodyTree::new(bodies).unwrap()).unwrap();
    let core = forces::System::conservative(lagrangian);
    common::check_values(&System::new(&model(&bodies)), &core, &numbers, 10.0);
}

#[test]
fn values_and_derivatives_are_cores() {
    check_against_core([CHAIN[0]], 8);
    check_against_core(CHAIN, 9);
    check_against_core(BRANCHED, 10);
}

/// Checks the rows ∂/∂θ y·(L_q − L_vq v − M a) against differences of the equation of motion, for each number.
#[test]
fn gradients_are_the_differences_of_the_equation_of_motion() {
    const N: usize = BRANCHED.len();
    let system = System::new(&model(&BRANCHED));
    common::check_gradients_of_motion::<N>((&system, &weights(N, 4)), 4, |_| true);
}

/// The mass matrix M of the double pendulum is that of textbooks, with geared drives included.
#[test]
fn the_double_pendulum_has_its_textbook_inertia() {
    let weights = weights(2, 5);
    let mut plain = weights.clone();
    // The second joint is at the end of the first link, and both centres are on the x axes.
    for zero in [3, 7, 12, 16] {
        plain[zero] = 0.0;
    }
    let [one, two] = numbers(&plain).try_into().unwrap();
    let numbers = Numbers::<2>::new(plain, 2.0, 5);
    let (program, pattern) = System::new(&model(&CHAIN)).equation_of_motion();
    let (motion, _) = numbers.run(&program, &[0, 1, 2]);
    for sample in 0..WIDTH {
        let q = numbers.of(0, sample);
        let (length, cosine) = (two.place[0], (q[1] + two.angle).cos());
        let own = two.inertia + two.mass * two.centre[0].powi(2);
        let m12 = own + two.mass * length * two.centre[0] * cosine + two.gear * two.rotor;
        let m22 = own + two.gear.powi(2) * two.rotor;
        let m11 = one.inertia
            + one.mass * one.centre[0].powi(2)
            + own
            + two.mass * length.powi(2)
            + 2.0 * two.mass * length * two.centre[0] * cosine
            + one.gear.powi(2) * one.rotor
            + two.rotor;
        for (i, j, expected) in [(0, 0, m11), (0, 1, m12), (1, 0, m12), (1, 1, m22)] {
            let mass = motion.output(1 + pattern.direction(i, j).unwrap())[i].0[sample];
            close(mass, expected, 1e-12);
        }
    }
}

/// With gravity along x a body whose centre is on its x axis hangs at q = 0.
#[test]
fn bodies_hang_at_zero() {
    let mut weights = weights(1, 6);
    (weights[0], weights[1]) = (9.81, 0.0);
    (weights[4], weights[6], weights[7]) = (0.0, 0.7, 0.0);
    let numbers = Numbers::<1>::new(weights.clone(), 2.0, 6);
    let (gradient, _) = numbers.run(&System::new(&model(&CHAIN[..1])).gradient(), &[0, 1]);
    for sample in 0..WIDTH {
        let [q] = numbers.of(0, sample);
        let expected = -9.81 * weights[5] * weights[6] * q.sin();
        close(gradient.output(0)[0].0[sample], expected, 1e-12);
    }
}

/// Known numbers are constants: the values stay the same, the programs are shorter and have no derivatives with respect
/// to them.
#[test]
fn known_numbers_are_constants() {
    const N: usize = BRANCHED.len();
    let mut weights = weights(N, 7);
    (weights[2], weights[3], weights[7]) = (0.0, 0.0, 0.0);
    let known: Vec<_> = weights.iter().enumerate().map(|(i, w)| (i % 3 > 0).then_some(*w)).collect();
    let all = model(&BRANCHED);
    let some = all.clone().with_known(known.clone()).unwrap();
    let numbers = Numbers::<N>::new(weights.clone(), 1.5, 7);
    let rows = |model: &BodiesEnergies| numbers.run(&System::new(model).residual(1), &[0, 1, 2, 3, 4]).1;
    for ((all, some), known) in rows(&all)[0].iter().zip(&rows(&some)[0]).zip(&known) {
        for sample in 0..WIDTH {
            close(some.0[sample], if known.is_some() { 0.0 } else { all.0[sample] }, 1e-12);
        }
    }
    let energies = |model: &BodiesEnergies| numbers.run(&System::new(model).energies(), &[0, 1]).0;
    let of = |energies: &Workspace, i: usize| energies.output(i)[0].0[3];
    for i in 0..2 {
        close(of(&energies(&some), i), of(&energies(&all), i), 1e-12);
    }
    assert!(all.with_known(known[1..].to_vec()).is_none(), "a number is missing");
}

#[test]
fn what_is_no_tree_is_refused() {
    let new = |bodies: &[TreeBody]| BodiesEnergies::new(bodies.to_vec()).err();
    assert_eq!(new(&[]), Some(TreeError::Empty));
    assert_eq!(new(&[CHAIN[1]]), Some(TreeError::Parent { element: 0, parent: 0 }));
    assert_eq!(
        new(&[CHAIN[0], body(Joint::Revolute, Some(4))]),
        Some(TreeError::Parent { element: 1, parent: 4 })
    );
    assert_eq!(model(&BRANCHED).parameters(), 47);
}
