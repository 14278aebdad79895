//! Graphs of particles: losses on rods, training by laws and networks, rollouts, model files.

use leastaction::architecture::{Architecture, GraphArchitecture, HostTypes};
use leastaction::evaluate::learned::with_accelerations;
use leastaction::ground_truth::{LgnnSettings, LgnnSystem, Motion, lgnn_set, lgnn_starts};
use leastaction::model_file::{decode, encode};
use leastaction::reproduce::lgnn::{Case, Options, architecture, graph, run, train};
use leastaction::training::{LossKind, Objective, Samples, objective};
use leastaction_core::energy::graph::Graph;
use leastaction_core::lagrangian::Energies;
use leastaction_core::particles::Particles;

fn samples(system: LgnnSystem, drag: f64, trajectories: usize) -> Samples {
    let published = LgnnSettings::published(system, 3);
    let settings = LgnnSettings { drag, trajectories, samples: 20, ..published };
    Samples::accelerations(&lgnn_set(&settings).expect("data")).expect("accelerations")
}

fn shape(system: LgnnSystem, drag: bool) -> GraphArchitecture {
    architecture(system, drag, false).expect("a shape")
}

fn loss(shape: &GraphArchitecture, samples: Samples, kind: LossKind) -> Box<dyn Objective> {
    objective(&shape.clone().into(), samples, kind, 2).expect("compiled")
}

fn triples(system: LgnnSystem, h: f64) -> Samples {
    let settings = LgnnSettings { h, trajectories: 2, samples: 12, ..LgnnSettings::published(system, 3) };
    Samples::triples(&lgnn_set(&settings).expect("data"))
}

/// ∂(mean square)/∂θ = 2Jᵀr/rows, by `gradient` and by the normal equations, is that of central differences; where a number is
/// known it is 0.
fn check_gradient(shape: &GraphArchitecture, objective: &dyn Objective) {
    // Away from where laws are 0, and drag without a kink.
    let mut weights: Vec<f64> = shape.initial_weights(9).iter().map(|w| w + 0.05).collect();
    let equations = objective.normal_equations(&weights).expect("evaluates");
    let gradient = objective.gradient(&weights, 0..objective.samples()).expect("evaluates");
    let factor = 2.0 / equations.rows as f64;
    let (fixed, step) = (shape.fixed_positions(), 1e-6);
    for k in 0..weights.len() {
        let weight = weights[k];
        let mut at = |w: f64| {
            weights[k] = w;
            objective.loss(&weights)
        };
        let difference = (at(weight + step) - at(weight - step)) / (2.0 * step);
        weights[k] = weight;
        let expected = if fixed.contains(&k) { 0.0 } else { difference };
        for found in [equations.gradient[k], gradient.gradient[k]] {
            let off = (factor * found - expected).abs();
            assert!(off <= 1e-6 * (1.0 + expected.abs()), "weight {k}: {found} {expected}");
        }
    }
}

#[test]
fn gradients_of_accelerations_on_rods_are_those_of_the_loss() {
    let (system, shape) = (LgnnSystem::Pendulum(3), shape(LgnnSystem::Pendulum(3), true));
    check_gradient(&shape, &*loss(&shape, samples(system, 0.1, 2), LossKind::Acceleration));
}

#[test]
fn gradients_of_springs_are_those_of_the_loss() {
    let (system, shape) = (LgnnSystem::Spring(3), shape(LgnnSystem::Spring(3), false));
    check_gradient(&shape, &*loss(&shape, samples(system, 0.0, 2), LossKind::Acceleration));
    check_gradient(&shape, &*loss(&shape, triples(system, 0.05), LossKind::NextPosition));
}

#[test]
fn the_exact_numbers_have_no_error_on_rods() {
    let (system, drag) = (LgnnSystem::Pendulum(3), 0.1);
    let shape = shape(system, true);
    let mut weights = shape.with_corrections_scaled(shape.initial_weights(0), 0.0);
    let numbers = weights.len() - 4;
    weights[numbers..].copy_from_slice(&[1.0, drag, 0.0, 10.0]);
    let objective = loss(&shape, samples(system, drag, 2), LossKind::Acceleration);
    assert!(objective.loss(&weights) < 1e-24);
}

#[test]
fn laws_are_learned_to_rounding() {
    for (system, drag) in [(LgnnSystem::Pendulum(2), 0.1), (LgnnSystem::Spring(3), 0.0)] {
        let (_, [train_mse, validation_mse]) =
            train(shape(system, drag > 0.0), &samples(system, drag, 5), 20, 0, |_, _| ()).expect("learns");
        assert!(train_mse < 1e-20 && validation_mse < 1e-20, "{system:?}: {train_mse} {validation_mse}");
    }
}

#[test]
fn networks_learn_what_they_are_not_told() {
    let system = LgnnSystem::Spring(3);
    let alone = architecture(system, false, true).expect("a shape");
    let samples = samples(system, 0.0, 10);
    let (model, [train_mse, _]) = train(alone, &samples, 40, 0, |_, _| ()).expect("learns");
    assert!(train_mse < 1e-4 * samples.mean_square(), "{train_mse}");
    let fixed = model.architecture.fixed_positions();
    let learned = fixed.iter().map(|k| model.weights[*k]).filter(|number| *number != 0.0 && *number != 1.0);
    assert_eq!(learned.count(), 0, "known numbers stay");
}

#[test]
fn a_model_runs_on_graphs_that_it_was_not_trained_on() {
    let options = Options { iterations: 20, starts: 2, ..Options::new(1) };
    for case in [Case::Pendulum, Case::Hybrid, Case::HybridForce] {
        let rows = run(case, &options, &|_| ()).expect("runs");
        for row in rows {
            let rolled_out = row.rolled_out.expect("rolled out");
            assert_eq!(rolled_out.failed, 0);
            assert!(rolled_out.rollout_error < 1e-5, "{case:?} {}: {rolled_out:?}", row.count);
            assert!(rolled_out.energy_violation < 1e-8, "{case:?} {}: {rolled_out:?}", row.count);
            let pulls = row.insight.rods.iter().flat_map(|rod| &rod.rows);
            assert!(pulls.clone().count() > 0);
            for [_, learned, exact] in pulls {
                assert!((learned - exact).abs() < 1e-6 * (1.0 + exact.abs()), "{learned} {exact}");
            }
        }
    }
}

#[test]
fn a_model_file_keeps_shape_rods_and_accelerations() {
    let mut shape = shape(LgnnSystem::Pendulum(3), true);
    shape.graphs.push(graph(LgnnSystem::Pendulum(5)));
    shape.graphs[1].name = "five".to_owned();
    let weights: Vec<f64> = shape.initial_weights(4).iter().map(|w| f64::from((w + 0.5) as f32)).collect();
    let bytes = encode(&shape.clone().into(), &weights, None, "test").expect("fits the format");
    let read = decode(&bytes).expect("readable");
    assert_eq!(read.weights, weights);
    let Architecture::Graph(found) = &read.architecture else { panic!("another family") };
    assert_eq!((found.shape, &found.graphs), (shape.shape, &shape.graphs));
    let five = found.with_graph_named("five").expect("is there");
    assert_eq!(five.n(), 10);
    let settings = LgnnSettings { trajectories: 1, ..LgnnSettings::published(LgnnSystem::Pendulum(5), 0) };
    let start = &lgnn_starts(&settings)[0];
    let mut a = [0.0; 10];
    let found = with_accelerations(&five.clone().into(), &weights, |f| f(&start.q, &start.v, &mut a));
    found.expect("any size").expect("exists");
    let truss = settings.truss().expect("exists");
    // At rest the rods take all of the acceleration along them.
    let state = [start.q.as_slice(), &a].concat();
    let mut projected = state.clone();
    truss.project(&mut projected).expect("near");
    assert!(state.iter().zip(&projected).all(|(a, b)| (a - b).abs() < 1e-9));
    let (types, layout): (HostTypes<'_, f64, 2>, _) =
        (five.host_types(&weights).expect("fits"), five.graph().expect("is there"));
    let particles = Graph::new(types, &layout.nodes, &layout.edges).expect("a graph");
    let Energies { kinetic, potential } =
        particles.energies(start.q.as_chunks().0, start.v.as_chunks().0, &mut []);
    assert!((kinetic + potential).is_finite());
}
