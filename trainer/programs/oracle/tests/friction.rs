//! Comparison of friction, which is read from a weight block, with core in f64.

mod common;

use common::{Numbers, random_weights};
use leastaction_core::discrete::{self, Control, Galerkin, Midpoint, Path, State};
use leastaction_core::energy::inertia_network::{Coordinate, Inertia, InertiaNetwork, InertiaNetworkShape};
use leastaction_core::forces::{Coulomb, DryFriction, Forces, System as CoreSystem, Viscous};
use leastaction_core::network::Activation;
use leastaction_programs::dynamics::{Del, Newton, Order};
use leastaction_programs::energies::{Energies, GroupForce, InertiaNetworkEnergies, with_group_laws};
use leastaction_programs::{Row, System, WIDTH};

const N: usize = 3;
const KINDS: [Coordinate; N] = [Coordinate::Angle, Coordinate::Translation, Coordinate::Angle];
const INERTIA: Inertia = Inertia::Cholesky { epsilon: 1e-2 };
/// The groups of the coordinates.
const OF: [usize; N] = [1, 0, 1];

type Model = Box<dyn Energies>;

/// b of both groups.
const VISCOUS: [f64; 2] = [0.3, 0.05];
/// c, c_load, τ_s and ε of both groups.
const DRY: [[f64; 4]; 2] = [[0.7, 0.25, 0.4, 0.5], [0.2, 0.6, 0.15, 0.9]];
const LOADED: GroupForce = GroupForce::Coulomb { loaded: true };
const UNLOADED: GroupForce = GroupForce::Coulomb { loaded: false };
const ALL: &[GroupForce] = &[GroupForce::Viscous, LOADED];
const CASES: [&[GroupForce]; 4] = [ALL, &[LOADED], &[GroupForce::Viscous], &[GroupForce::Viscous, UNLOADED]];

fn inertia_network(damped: bool) -> InertiaNetworkEnergies {
    InertiaNetworkEnergies::new(KINDS.to_vec(), (&[6, 5], Activation::Tanh), INERTIA, damped)
}

fn model(laws: &[GroupForce], damped: bool) -> Model {
    with_group_laws(Box::new(inertia_network(damped)), laws, (2, &OF)).unwrap()
}

/// Numbers of the laws in the order of a weight block.
fn numbers(laws: &[GroupForce], dry: [[f64; 4]; 2]) -> Vec<f64> {
    let unloaded = |[c, _, smoothing, width]: [f64; 4]| [c, 0.0, smoothing, width];
    let of = |law: &GroupForce| match *law {
        GroupForce::Viscous => VISCOUS.to_vec(),
        UNLOADED => dry.map(unloaded).concat(),
        _ => dry.concat(),
    };
    laws.iter().flat_map(of).collect()
}

/// Random weights of the model, followed by these numbers.
fn weights(laws: &[GroupForce], dry: [[f64; 4]; 2], damped: bool, seed: u64) -> Vec<f64> {
    let mut weights = random_weights(inertia_network(damped).parameters(), seed);
    weights.extend(numbers(laws, dry));
    weights
}

type Laws = (Viscous<f64, N>, Coulomb<f64, N>);

/// The laws of core with the numbers at the end of a weight block.
fn laws(which: &[GroupForce], weights: &[f64]) -> Laws {
    let own = &weights[weights.len() - numbers(which, DRY).len()..];
    let (viscous, dry) = own.split_at(if which.contains(&GroupForce::Viscous) { 2 } else { 0 });
    let dry_friction = |group: usize| {
        let [constant, load, smoothing, width] = *dry.as_chunks::<4>().0.get(group)?;
        Some(DryFriction { constant, load, smoothing, width })
    };
    let coefficients = OF.map(|group| viscous.get(group).copied().unwrap_or(0.0));
    let coordinates = OF.map(|group| dry_friction(group).unwrap_or(DryFriction::none()));
    (Viscous { coefficients }, Coulomb { coordinates })
}

fn core<'w>(which: &[GroupForce], weights: &'w [f64]) -> CoreSystem<InertiaNetwork<'w, f64, N, 8, 2>, Laws> {
    let shape = InertiaNetworkShape::new(KINDS, &[6, 5], Activation::Tanh, INERTIA).unwrap();
    let lagrangian = InertiaNetwork::take(&mut &weights[..], &shape).unwrap();
    CoreSystem { lagrangian, forces: laws(which, weights) }
}

#[test]
fn values_and_derivatives_are_cores() {
    for (seed, which) in (1..).zip(CASES) {
        let (model, weights) = (model(which, false), weights(which, DRY, false, seed));
        assert_eq!(model.parameters(), weights.len());
        let numbers = Numbers::<N>::new(weights.clone(), 1.5, seed);
        common::check_values(&System::new(&model), &core(which, &weights), &numbers, 1.0);
    }
}

/// A model's own damping stays, and its numbers precede those of friction.
#[test]
fn friction_adds_to_the_forces_of_the_model() {
    let which = &[LOADED];
    let both = model(which, true);
    let (alone, weights) = (inertia_network(true), weights(which, DRY, true, 5));
    assert_eq!((both.parameters(), alone.parameters() + 8), (weights.len(), weights.len()));
    let friction = laws(which, &weights);
    let numbers = Numbers::<N>::new(weights, 1.5, 5);
    let force = |model: &dyn Energies| {
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

/// Checks ∂(y·Q)/∂w for every number against central differences of core's force.
#[test]
fn gradients_are_the_differences_of_cores_force() {
    const STEP: f64 = 1e-5;
    for (seed, which) in (1..).zip(CASES) {
        let (model, weights) = (model(which, false), weights(which, DRY, false, seed));
        let own = Numbers::<N>::new(weights.clone(), 1.5, seed);
        // Vectors 4 and 3 are y and v̇.
        let (_, rows) = own.run(&System::new(&model).residual(1), &[0, 1, 2, 3, 4]);
        for place in weights.len() - numbers(which, DRY).len()..weights.len() {
            let moved = |step: f64| {
                let mut moved = weights.clone();
                moved[place] += step;
                laws(which, &moved)
            };
            let (forth, back) = (moved(STEP), moved(-STEP));
            // There is no derivative with respect to a c_load that is known to be 0; c_load is the second and the sixth
            // number of dry friction.
            let is_load = (weights.len() - place) % 4 == 3;
            for sample in (0..WIDTH).filter(|_| !which.contains(&UNLOADED) || !is_load) {
                let [q, v, tau, y] = [0, 1, 2, 4].map(|vector| own.of(vector, sample));
                let work = |laws: &Laws| -> f64 {
                    laws.force(&q, &v, &tau).iter().zip(&y).map(|(f, y)| f * y).sum()
                };
                let expected = (work(&forth) - work(&back)) / (2.0 * STEP);
                let found = rows[0][place].0[sample];
                assert!((found - expected).abs() < 1e-8, "number {place}: {found} {expected}");
            }
        }
    }
}

/// Friction with such a small width that Newton's method without safeguards jumps back and forth.
const STIFF: [[f64; 4]; 2] = [[0.7, 0.25, 0.4, 0.005], [0.2, 0.6, 0.15, 0.01]];

/// Checks that steps through the change of sign, under a force that pushes back and forth, equal core's.
fn check_steps<P: Path>(order: Order, dry: [[f64; 4]; 2]) {
    let weights = weights(ALL, dry, false, 9);
    let (system, core, h) = (System::new(&model(ALL, false)), core(ALL, &weights), 0.01);
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
    for dry in [DRY, STIFF] {
        check_steps::<Midpoint>(Order::Two, dry);
        check_steps::<Galerkin>(Order::Four, dry);
    }
}

/// Checks that the state determined by two positions equals core's, even where the early friction makes the bubble's
/// equation non-monotonic.
fn check_starts<P: Path>(order: Order, dry: [[f64; 4]; 2]) {
    let weights = weights(ALL, dry, false, 9);
    let (system, core, h) = (System::new(&model(ALL, false)), core(ALL, &weights), 0.01);
    let newton = Newton { max_iterations: 50, stop: 1e-13, accept: 1e-9 };
    let mut del = Del::new(&system, h, order, newton);
    let numbers = Numbers::<N>::new(weights.clone(), 0.3, 4);
    for push in [0.0, 3.0, -20.0] {
        let [q, v] = [0, 1]
            .map(|vector| std::array::from_fn(|i| Row(std::array::from_fn(|k| numbers.of(vector, k)[i]))));
        let q: [Row; N] = q;
        let v: [Row; N] = v;
        let next: [Row; N] = std::array::from_fn(|i| {
            let mut next = q[i];
            next.add_scaled(h, &v[i]);
            next
        });
        let tau = [Row::splat(push); N];
        let found = del.start(&weights, [&q, &next], [&tau, &tau]);
        for sample in 0..WIDTH {
            let of = |rows: &[Row; N]| rows.map(|row| row.0[sample]);
            let control = Control::held([push; N]);
            let expected =
                discrete::Del::<f64, P>::new(h).start(&core, &of(&q), &of(&next), &control).unwrap();
            assert!(!found.failed.0[sample], "{order:?}, pushed by {push}, sample {sample}");
            for (found, expected) in found.p.iter().zip(&expected.p()) {
                let found = found.0[sample];
                assert!((found - expected).abs() < 1e-8, "{order:?}, sample {sample}: {found} {expected}");
            }
        }
    }
}

#[test]
fn starts_are_cores() {
    for dry in [DRY, STIFF, STIFF.map(|[c, load, smoothing, width]| [20.0 * c, load, smoothing, width])] {
        check_starts::<Midpoint>(Order::Two, dry);
        check_starts::<Galerkin>(Order::Four, dry);
    }
}
