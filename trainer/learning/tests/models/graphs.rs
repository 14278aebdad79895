//! Graphs of particles: losses on rods, model files.

use leastaction_core::energy::graph::Graph;
use leastaction_core::lagrangian::Energies;
use leastaction_core::particles::Particles;
use leastaction_ground_truth::{ExactMotion, LgnnSettings, LgnnSystem, lgnn_set, lgnn_starts};
use leastaction_ground_truth::{lgnn_graph, lgnn_shape};
use leastaction_learning::training::{LossKind, Objective, Samples, objective};
use leastaction_models::file::{decode, encode};
use leastaction_models::{AnyFamily, Family as _, GraphArchitecture, HostTypes, Model};

fn samples(system: LgnnSystem, drag: f64, trajectories: usize) -> Samples {
    let published = LgnnSettings::published(system, 3);
    let settings = LgnnSettings { drag, trajectories, samples: 20, ..published };
    Samples::accelerations(&lgnn_set(&settings).expect("data")).expect("accelerations")
}

fn shape(system: LgnnSystem, drag: bool) -> GraphArchitecture {
    lgnn_shape(system, drag, false).expect("a shape")
}

fn loss(shape: &GraphArchitecture, samples: Samples, kind: LossKind) -> Box<dyn Objective> {
    objective(&shape.clone().into(), samples, kind, 2).expect("compiled")
}

fn triples(system: LgnnSystem, h: f64) -> Samples {
    let settings = LgnnSettings { h, trajectories: 2, samples: 12, ..LgnnSettings::published(system, 3) };
    Samples::triples(&lgnn_set(&settings).expect("data"))
}

/// Checks that ∂(mean square)/∂θ = 2Jᵀr/rows, by `gradient` and by the normal equations, equals central differences, and is 0 for known
/// numbers.
fn check_gradient(shape: &GraphArchitecture, objective: &dyn Objective) {
    // The weights avoid the point where laws are 0 and the kink of drag.
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
fn a_model_file_keeps_shape_rods_and_accelerations() {
    let mut shape = shape(LgnnSystem::Pendulum(3), true);
    shape.graphs.push(lgnn_graph(LgnnSystem::Pendulum(5)));
    shape.graphs[1].name = "five".to_owned();
    let weights: Vec<f64> = shape.initial_weights(4).iter().map(|w| f64::from((w + 0.5) as f32)).collect();
    let bytes = encode(&shape.clone().into(), &weights, None, "test").expect("fits the format");
    let read = decode(&bytes).expect("readable");
    assert_eq!(read.weights, weights);
    let AnyFamily::Graph(found) = &read.architecture.family else { panic!("another family") };
    assert_eq!((found.shape, &found.graphs), (shape.shape, &shape.graphs));
    let five = found.with_graph_named("five").expect("is there");
    assert_eq!(five.n(), 10);
    let settings = LgnnSettings { trajectories: 1, ..LgnnSettings::published(LgnnSystem::Pendulum(5), 0) };
    let start = &lgnn_starts(&settings)[0];
    let mut a = [0.0; 10];
    let found =
        Model::new(five.clone(), weights.clone()).with_accelerations(|f| f(&start.q, &start.v, &mut a));
    found.expect("any size").expect("exists");
    let truss = settings.truss().expect("exists");
    // At rest the rods take up all of the acceleration along them.
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

/// Graphs have their drag in their node types; an additional law of force is refused, not silently dropped.
#[test]
fn a_law_that_the_family_cannot_have_is_refused() {
    use leastaction_core::model::{Family, Laws, ModelError};
    use leastaction_models::Architecture;
    let system = LgnnSystem::Pendulum(2);
    let graph: Architecture = lgnn_shape(system, true, true).unwrap().into();
    for laws in [Laws::VISCOUS, Laws::COULOMB] {
        let found = graph.with_header(|family: Family| Architecture::from_header(&family, laws, &[0.0; 99]));
        assert_eq!(found.map(|_| ()), Err(ModelError::Law { number: laws.iter().next().unwrap() as u8 }));
    }
}
