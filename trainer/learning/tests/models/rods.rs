//! The discrete losses on rods (RATTLE), and their derivatives.

use leastaction_core::constraints::Constrained;
use leastaction_core::discrete::{
    Order,
    rattle::{ParticleState, Rattle},
};
use leastaction_core::energy::NetworkShape;
use leastaction_core::energy::graph::{
    Drag, EDGE_NUMBERS, Edge, EdgeShape, Graph, GraphShape, Kinetic, NodeShape, Potential, Separation,
};
use leastaction_core::forces::ControlKind;
use leastaction_core::model::Rod;
use leastaction_core::network::Activation;
use leastaction_ground_truth::lgnn_shape;
use leastaction_ground_truth::{LgnnSettings, LgnnSystem, lgnn_set};
use leastaction_learning::training::{LossKind, Objective, Samples, objective};
use leastaction_models::Family as _;
use leastaction_models::{GraphArchitecture, GraphType, HostTypes, NamedGraph, Number};

const KINDS: [LossKind; 2] = [LossKind::DelResidual, LossKind::NextPosition];
const ORDERS: [(u8, Order); 2] = [(2, Order::Two), (4, Order::Four)];
/// Steps of the logged motion.
const STEPS: usize = 7;
const H: f64 = 0.06;

/// A number between −1 and 1, different for every k.
fn wave(k: usize) -> f64 {
    (1.7 * k as f64 + 0.4).sin()
}

/// Two types of nodes, one with a kinetic energy that is not quadratic, drag of both kinds, and a spring; all learned.
fn shape(dimension: u8, graph: NamedGraph) -> GraphArchitecture {
    let network = |inputs, units| NetworkShape {
        inputs,
        widths: [units, 0, 0, 0],
        outputs: 1,
        activation: Activation::Squareplus,
    };
    let networks = [network(1, 2), network(dimension, 3), network(1, 2), network(1, 3)];
    let odd =
        NodeShape { kinetic: Kinetic::Network(0), potential: Potential::Network(1), drag: Drag::Network(2) };
    let plain = NodeShape { kinetic: Kinetic::Mass, potential: Potential::Uniform, drag: Drag::Viscous };
    let spring = EdgeShape { separation: Separation::Squared, potential: Some(3), embedding: None };
    let learned =
        |name: &str, count| GraphType { name: name.to_owned(), numbers: vec![Number::learned(0.7); count] };
    let numbers = 2 + usize::from(dimension);
    GraphArchitecture {
        shape: GraphShape::new(dimension, &networks, &[odd, plain], &[spring]).expect("fits"),
        node_types: vec![learned("odd", numbers), learned("plain", numbers)],
        edge_types: vec![learned("spring", EDGE_NUMBERS)],
        graphs: vec![graph],
        graph: 0,
    }
}

/// Two nodes on rods and a third on a spring: 6 coordinates, 2 rods.
fn in_the_plane() -> GraphArchitecture {
    let rods = vec![Rod { from: None, to: 1, length: 0.75 }, Rod { from: Some(1), to: 0, length: 1.25 }];
    let edges = vec![Edge { kind: 0, ends: [0, 2] }];
    shape(2, NamedGraph { name: "plane".to_owned(), nodes: vec![0, 1, 1], edges, rods })
}

/// A pendulum with another node on a spring: 6 coordinates, 1 rod.
fn in_space() -> GraphArchitecture {
    let rods = vec![Rod { from: None, to: 1, length: 0.75 }];
    let edges = vec![Edge { kind: 0, ends: [1, 0] }];
    shape(3, NamedGraph { name: "space".to_owned(), nodes: vec![0, 1], edges, rods })
}

/// Positive weights: kinetic energies are convex, drag has no kink.
fn weights(shape: &GraphArchitecture) -> Vec<f64> {
    shape.initial_weights(5).iter().map(|w| 0.3 + 0.6 * w.abs()).collect()
}

fn start<const D: usize>(rods: &[Rod], nodes: usize) -> (Vec<[f64; D]>, Vec<[f64; D]>) {
    let vector = |k: usize| -> [f64; D] { std::array::from_fn(|i| 1.3 * wave(5 * k + i)) };
    let mut q: Vec<[f64; D]> = (0..nodes).map(vector).collect();
    for rod in rods {
        let from = rod.from.map_or([0.0; D], |from| q[usize::from(from)]);
        let d = vector(usize::from(rod.to) + 3);
        let size = d.iter().map(|x| x * x).sum::<f64>().sqrt();
        q[usize::from(rod.to)] = std::array::from_fn(|i| from[i] + f64::from(rod.length) * d[i] / size);
    }
    (q, (0..nodes).map(|k| vector(k + 7)).collect())
}

/// Triples of the RATTLE motion under a control that changes at every step.
fn stepped<const D: usize>(shape: &GraphArchitecture, weights: &[f64], order: Order) -> Samples {
    let types: HostTypes<'_, f64, D> = shape.host_types(weights).expect("fits");
    let layout = shape.graph().expect("is there");
    let (graph, rods) =
        (Graph::new(types, &layout.nodes, &layout.edges).expect("a graph"), layout.constraints::<D>());
    let mechanism = Constrained::new(&graph, &rods[..]).expect("rods");
    let (nodes, n) = (layout.nodes.len(), shape.n());
    let mut workspace = vec![0.0; ParticleState::<f64, D>::workspace(nodes, rods.len())];
    let mut work = vec![0.0; Rattle::workspace(&mechanism)];
    let (q, v) = start::<D>(&layout.rods, nodes);
    let mut state = ParticleState::new(&mechanism, &q, &v, &mut workspace, &mut work).expect("on its rods");
    let control = |k: usize| (0..n).map(|i| 3.0 * wave(11 * k + i)).collect::<Vec<f64>>();
    let mut positions = vec![state.q().as_flattened().to_vec()];
    for k in 0..STEPS {
        let force: Vec<f64> = control(k).iter().zip(control(k + 1)).map(|(a, b)| 0.5 * (a + b)).collect();
        let rattle = Rattle::new(H, order);
        rattle.step(&mechanism, &mut state, Some(force.as_chunks().0), &mut work).expect("steps");
        positions.push(state.q().as_flattened().to_vec());
    }
    let controls: Vec<Vec<f64>> = (0..=STEPS).map(control).collect();
    let triples = |rows: &[Vec<f64>]| [0, 1, 2].map(|k| rows[k..k + STEPS - 1].concat());
    let (states, controls) = (triples(&positions), triples(&controls));
    Samples { n, h: H, states, controls, control: ControlKind::Linear, ..Samples::default() }
}

/// All shapes, each with a motion of its own at its weights.
fn cases(order: Order) -> [(GraphArchitecture, Vec<f64>, Samples); 2] {
    let (plane, space) = (in_the_plane(), in_space());
    let (of_plane, of_space) = (weights(&plane), weights(&space));
    let motions = (stepped::<2>(&plane, &of_plane, order), stepped::<3>(&space, &of_space, order));
    [(plane, of_plane, motions.0), (space, of_space, motions.1)]
}

fn loss(shape: &GraphArchitecture, samples: &Samples, kind: LossKind, order: u8) -> Box<dyn Objective> {
    objective(&shape.clone().into(), samples.clone(), kind, order).expect("compiled")
}

/// A direction in the weights.
fn direction(weights: &[f64], seed: usize) -> Vec<f64> {
    (0..weights.len()).map(|k| wave((3 + 4 * seed) * k + seed)).collect()
}

fn moved(weights: &[f64], by: f64, along: &[f64]) -> Vec<f64> {
    weights.iter().zip(along).map(|(w, d)| w + by * d).collect()
}

#[test]
fn the_step_of_the_losses_is_that_of_rattle() {
    for (order, rattle) in ORDERS {
        for (shape, weights, samples) in cases(rattle) {
            let [residual, position] =
                KINDS.map(|kind| loss(&shape, &samples, kind, order).loss(&weights).sqrt());
            println!("order {order}: momentum {residual:.1e}, position {position:.1e}");
            assert!(position < 3e-16 && residual < 1e-13, "order {order}: {residual} {position}");
            // A step of the other order differs.
            let other = loss(&shape, &samples, LossKind::NextPosition, 6 - order).loss(&weights).sqrt();
            assert!(other > 1e-7, "{other}");
        }
    }
}

/// ∂(mean square)/∂θ = 2Jᵀr/rows, by `gradient` and by the normal equations, equals central differences along every direction.
#[test]
fn gradients_are_those_of_the_losses() {
    for (order, rattle) in ORDERS {
        for (shape, exact, samples) in cases(rattle) {
            let weights = moved(&exact, 0.1, &direction(&exact, 0));
            for kind in KINDS {
                let objective = loss(&shape, &samples, kind, order);
                let equations = objective.normal_equations(&weights).expect("evaluates");
                let gradient = objective.gradient(&weights, 0..objective.samples()).expect("evaluates");
                let size = gradient.gradient.iter().map(|g| g * g).sum::<f64>().sqrt();
                for seed in 1..=6 {
                    let d = direction(&weights, seed);
                    let [behind, ahead] = [-1e-5, 1e-5].map(|by| objective.loss(&moved(&weights, by, &d)));
                    let expected = (ahead - behind) / 2e-5 * 0.5 * equations.rows as f64;
                    for found in [&equations.gradient, &gradient.gradient] {
                        let found: f64 = found.iter().zip(&d).map(|(g, d)| g * d).sum();
                        let off = (found - expected).abs();
                        assert!(off <= 1e-6 * size, "{kind:?} {order}: {found} {expected}, of {size}");
                    }
                }
            }
        }
    }
}

/// At loss 0 the second difference of the loss along d is 2 dᵀJᵀJd/rows.
#[test]
fn normal_matrices_are_the_curvature_of_the_losses() {
    for (order, rattle) in ORDERS {
        for (shape, weights, samples) in cases(rattle) {
            for kind in KINDS {
                let objective = loss(&shape, &samples, kind, order);
                let equations = objective.normal_equations(&weights).expect("evaluates");
                let (d, step) = (direction(&weights, 0), 1e-4);
                let entry = |i: usize, j: usize| equations.gram[(i.max(j), i.min(j))];
                let pairs = (0..d.len()).flat_map(|i| (0..d.len()).map(move |j| (i, j)));
                let expected: f64 =
                    pairs.map(|(i, j)| d[i] * entry(i, j) * d[j]).sum::<f64>() / equations.rows as f64;
                let sum: f64 = [-step, step].map(|by| objective.loss(&moved(&weights, by, &d))).iter().sum();
                let found = 0.5 * sum / (step * step);
                assert!((found / expected - 1.0).abs() < 1e-5, "{kind:?} {order}: {found} {expected}");
            }
        }
    }
}

/// The residual of a momentum of order p is ∝ hᵖ⁺¹ on exact motion, that of a position ∝ hᵖ⁺².
#[test]
fn losses_of_exact_motion_have_their_order() {
    let system = LgnnSystem::Pendulum(2);
    let shape = lgnn_shape(system, false, false).expect("a shape");
    let mut weights = shape.with_corrections_scaled(shape.initial_weights(0), 0.0);
    let numbers = weights.len() - 4;
    weights[numbers..].copy_from_slice(&[1.0, 0.0, 0.0, 10.0]);
    for kind in KINDS {
        for (order, h) in [(2, 4e-3), (4, 16e-3)] {
            let residual = |h: f64, samples: usize| {
                let published = LgnnSettings::published(system, 3);
                let data = lgnn_set(&LgnnSettings { h, trajectories: 2, samples, ..published });
                loss(&shape, &Samples::triples(&data.expect("data")), kind, order).loss(&weights).sqrt()
            };
            // The span of time is the same; otherwise the bobs would not have the same speed.
            let (coarse, fine) = (residual(h, 11), residual(0.5 * h, 21));
            let slope = (coarse / fine).log2();
            println!("{kind:?} {order}: {coarse:.1e} {fine:.1e}, slope {slope:.2}");
            // A position is a momentum times h/m.
            let expected = f64::from(order) + if kind == LossKind::NextPosition { 2.0 } else { 1.0 };
            assert!((slope - expected).abs() < 0.3, "{kind:?} {order}: {slope}");
        }
    }
}
