//! Friction beside a family's forces, known and learned, against core in f64.

mod common;

use common::{Numbers, random_weights};
use leastaction_core::discrete::{self, Control, Galerkin, Midpoint, Path, State};
use leastaction_core::energy::rigid::{Coordinate, Inertia, Rigid, RigidShape};
use leastaction_core::forces::{Coulomb, DryFriction, Forces, System as CoreSystem, Viscous};
use leastaction_core::network::Activation;
use leastaction_programs::dynamics::{Del, Newton, Order};
use leastaction_programs::energies::FrictionNumber::{Known, Learned};
use leastaction_programs::energies::{Energies, Friction, MOST_LOAD, RigidEnergies, WIDTHS, WithFriction};
use leastaction_programs::{Row, System, WIDTH};

const N: usize = 3;
const KINDS: [Coordinate; N] = [Coordinate::Angle, Coordinate::Translation, Coordinate::Angle];
const INERTIA: Inertia = Inertia::Cholesky { epsilon: 1e-2 };
/// The groups of the coordinates.
const OF: [usize; N] = [1, 0, 1];

type Model = WithFriction<RigidEnergies>;

const KNOWN: Friction = Friction {
    viscous: Known(0.3),
    constant: Known(0.7),
    load: Known(0.25),
    smoothing: 0.4,
    width: Known(0.5),
};
const LEARNED: Friction =
    Friction { viscous: Learned, constant: Learned, load: Learned, smoothing: 0.15, width: Learned };

/// Two groups each: known, learned, partly, and with parts that are absent.
const CASES: [[Friction; 2]; 6] = [
    [KNOWN, Friction { constant: Known(0.2), width: Known(0.9), ..KNOWN }],
    [LEARNED, LEARNED],
    [KNOWN, LEARNED],
    [Friction { load: Learned, ..KNOWN }, Friction { viscous: Learned, width: Learned, ..Friction::NONE }],
    [Friction { load: Known(0.0), ..LEARNED }, Friction { load: Known(0.0), ..KNOWN }],
    [Friction { viscous: Learned, ..Friction::NONE }, Friction::NONE],
];

fn model(groups: [Friction; 2], damped: bool) -> Model {
    let rigid = RigidEnergies::new(KINDS.to_vec(), (&[6, 5], Activation::Tanh), INERTIA, damped);
    WithFriction::new(rigid, groups.to_vec(), OF.to_vec()).unwrap()
}

type Laws = (Viscous<f64, N>, Coulomb<f64, N>);

fn laws(model: &Model, weights: &[f64]) -> Laws {
    let numbers = model.physical(weights).unwrap();
    let of = |i: usize| numbers[OF[i]];
    let viscous = Viscous { coefficients: std::array::from_fn(|i| of(i).0) };
    (viscous, Coulomb { coordinates: std::array::from_fn(|i| of(i).1) })
}

fn core<'w>(model: &Model, weights: &'w [f64]) -> CoreSystem<Rigid<'w, f64, N, 8, 2>, Laws> {
    let shape = RigidShape::new(KINDS, &[6, 5], Activation::Tanh, INERTIA).unwrap();
    let lagrangian = Rigid::take(&mut &weights[..], &shape).unwrap();
    CoreSystem { lagrangian, forces: laws(model, weights) }
}

#[test]
fn values_and_derivatives_are_cores() {
    for (seed, groups) in (1..).zip(CASES) {
        let model = model(groups, false);
        let weights = random_weights(model.parameters(), seed);
        let numbers = Numbers::<N>::new(weights.clone(), 1.5, seed);
        common::check_values(&System::new(&model), &core(&model, &weights), &numbers, 1.0);
    }
}

/// A model's own damping stays, and its numbers come before those of friction.
#[test]
fn friction_adds_to_the_forces_of_the_model() {
    let (both, alone) = (model(CASES[3], true), model([Friction::NONE; 2], true));
    let weights = random_weights(both.parameters(), 5);
    assert_eq!(both.parameters(), alone.parameters() + 3);
    let friction = laws(&both, &weights);
    let numbers = Numbers::<N>::new(weights, 1.5, 5);
    let force = |model: &Model| {
        let own = Numbers::<N>::new(numbers.weights[..model.parameters()].to_vec(), 1.5, 5);
        own.run(&System::new(model).force_and_momentum(), &[0, 1, 2]).0
    };
    let (found, without) = (force(&both), force(&alone));
    for sample in 0..WIDTH {
        let [q, v, tau] = [0, 1, 2].map(|vector| numbers.of(vector, sample));
        let added = friction.force(&q, &v, &tau);
        for (i, added) in added.into_iter().enumerate() {
            let expected = without.output(0)[i].0[sample] + added;
            assert!((found.output(0)[i].0[sample] - expected).abs() < 1e-12);
        }
    }
}

/// ∂(y·Q)/∂θ against central differences of core's force.
#[test]
fn gradients_are_the_differences_of_cores_force() {
    const STEP: f64 = 1e-5;
    for (seed, groups) in (1..).zip(CASES) {
        let model = model(groups, false);
        let weights = random_weights(model.parameters(), seed);
        let first = weights.len() - (model.parameters() - self::model([KNOWN; 2], false).parameters());
        let numbers = Numbers::<N>::new(weights.clone(), 1.5, seed);
        // y and v̇ are vectors 4 and 3.
        let (_, rows) = numbers.run(&System::new(&model).residual(1), &[0, 1, 2, 3, 4]);
        for place in first..weights.len() {
            let moved = |step: f64| {
                let mut moved = weights.clone();
                moved[place] += step;
                laws(&model, &moved)
            };
            let (forth, back) = (moved(STEP), moved(-STEP));
            for sample in 0..WIDTH {
                let [q, v, tau, y] = [0, 1, 2, 4].map(|vector| numbers.of(vector, sample));
                let work = |laws: &Laws| -> f64 {
                    laws.force(&q, &v, &tau).iter().zip(&y).map(|(f, y)| f * y).sum()
                };
                let expected = (work(&forth) - work(&back)) / (2.0 * STEP);
                let found = rows[0][place].0[sample];
                assert!((found - expected).abs() < 1e-8, "θ {}: {found} {expected}", place - first);
            }
        }
    }
}

/// Whatever θ is, numbers are in their range, in single precision too, and power is never positive.
#[test]
fn learned_friction_only_dissipates() {
    let model = model([LEARNED; 2], false);
    let start = model.parameters() - 8;
    let mut random = random_weights(16_000, 7).into_iter();
    for k in 0..1_000 {
        let mut weights = random_weights(start, 1);
        let size = [1.0, 10.0, 1e3, 1e9][k % 4];
        weights.extend(random.by_ref().take(8).map(|x| x * size));
        for (b, DryFriction { constant, load, smoothing, width }) in model.physical(&weights).unwrap() {
            assert!(b >= 0.0 && constant >= 0.0 && (b as f32) >= 0.0 && smoothing == 0.15);
            assert!((0.0..=MOST_LOAD).contains(&load) && (load as f32) < 1.0);
            assert!((WIDTHS[0] - 1e-15..=WIDTHS[1]).contains(&width) && width as f32 > 0.0, "{width}");
        }
        let laws = laws(&model, &weights);
        let [v, tau] = [0, 1].map(|i| std::array::from_fn(|j| 3.0 * weights[i * N + j]));
        assert!(laws.force(&v, &v, &tau).iter().zip(&v).all(|(f, v)| f * v <= 0.0));
    }
}

#[test]
fn groups_must_fit() {
    let rigid = || RigidEnergies::new(KINDS.to_vec(), (&[4], Activation::Tanh), INERTIA, false);
    assert!(WithFriction::new(rigid(), vec![KNOWN; 2], vec![0, 1]).is_none(), "two coordinates of three");
    assert!(WithFriction::new(rigid(), vec![KNOWN; 2], vec![0, 1, 2]).is_none(), "no third group");
    let model = WithFriction::new(rigid(), vec![LEARNED; 2], vec![0, 1, 1]).unwrap();
    assert!(model.physical(&vec![0.1; model.parameters() - 1]).is_none(), "a number is missing");
}

/// Friction as wide as in the cases, or so narrow that Newton's method alone jumps to and fro.
const STIFF: [Friction; 2] =
    [Friction { width: Known(0.005), ..KNOWN }, Friction { width: Known(0.01), ..KNOWN }];

/// Steps through the change of sign, pushed to and fro, are core's.
fn check_steps<P: Path>(order: Order, groups: [Friction; 2]) {
    let model = model(groups, false);
    let weights = random_weights(model.parameters(), 9);
    let (system, core, h) = (System::new(&model), core(&model, &weights), 0.01);
    let newton = Newton { max_iterations: 50, stop: 1e-13, accept: 1e-9 };
    let mut del = Del::new(&system, h, order, newton);
    let (q, v) = ([0.3, -0.2, 0.5], [0.8, -0.4, 0.3]);
    let rows = |x: [f64; N]| x.map(Row::splat);
    let mut found = del.start_at(&weights, &rows(q), &rows(v));
    let mut expected = State::new(&core.lagrangian, q, v).unwrap();
    let mut turned = 0;
    for k in 0..300 {
        let tau = [2.0, -1.5, 1.0].map(|push| if k / 50 % 2 == 0 { push } else { -push });
        let before = expected.last_increment();
        discrete::Del::<f64, P>::new(h).step(&core, &mut expected, &Control::held(tau)).unwrap();
        del.step(&weights, &mut found, [&rows(tau), &rows(tau)]);
        turned +=
            before.iter().zip(&expected.last_increment()).filter(|(a, b)| (**a > 0.0) != (**b > 0.0)).count();
        for (found, expected) in found.q.iter().zip(&expected.q()) {
            assert!((found.0[0] - expected).abs() < 1e-9, "step {k}: {} {expected}", found.0[0]);
        }
    }
    assert!(turned > 5, "only {turned} changes of sign");
}

#[test]
fn steps_are_cores() {
    for groups in [CASES[0], STIFF] {
        check_steps::<Midpoint>(Order::Two, groups);
        check_steps::<Galerkin>(Order::Four, groups);
    }
}
