//! Pendulums that were trained with the LGNN authors' program, without and with drag, against arrays exported from it. The data
//! is not ours to ship: these tests run where `LEASTACTION_REFERENCE` names its folder.

#[path = "common/reference.rs"]
#[allow(dead_code, reason = "each test binary uses its own part")]
mod reference;

use leastaction_core::constraints::{Constraints, Holonomic, Positions};
use leastaction_core::energy::graph::{Fixed, Graph, MAX_NETWORKS};
use leastaction_core::forces::Forces;
use leastaction_core::lagrangian::Lagrangian;
use leastaction_learning::import::{Imported, LGNN_EMBEDDINGS, lgnn};
use leastaction_learning::training::{LossKind, Samples, objective};
use leastaction_models::particles::Driven;
use leastaction_models::{DEPTH, GraphArchitecture, HostTypes, MAX_ELEMENT_UNITS};
use reference::{Arrays, EXACT, assert_close, assert_within, data, scale};
use std::fs;

/// Number of coordinates of three nodes in the plane.
const N: usize = 6;
const BOBS: usize = N / 2;

fn network(name: &str, drag: bool) -> Imported {
    let file = fs::read(data("lgnn").join(format!("{name}_network.safetensors"))).expect("weights");
    lgnn(&file, BOBS, drag).expect("import")
}

fn graph(imported: &Imported) -> &GraphArchitecture {
    imported.architecture.family.graph().expect("a graph")
}

type Model<'a> = Fixed<'a, f64, 2, MAX_NETWORKS, MAX_ELEMENT_UNITS, DEPTH, N>;

fn types(imported: &Imported) -> HostTypes<'_, f64, 2> {
    graph(imported).host_types(&imported.weights).expect("weights of this shape")
}

fn arrays(name: &str) -> Arrays {
    Arrays::open(&data("lgnn").join(format!("{name}_reference.npz")))
}

/// Checks energies, their derivatives and the drag.
fn check_energies(name: &str, drag: bool) {
    let imported = network(name, drag);
    let layout = graph(&imported).graph().expect("a chain");
    let particles = Graph::new(types(&imported), &layout.nodes, &layout.edges).expect("a graph");
    let fixed: Model = Fixed::new(particles).expect("as many coordinates");
    let reference = arrays(name);
    let (q, v) = (reference.get("q"), reference.get("v"));
    let (mut kinetic, mut potential, mut l_q, mut mass, mut force) = (vec![], vec![], vec![], vec![], vec![]);
    for (q, v) in q.as_chunks::<N>().0.iter().zip(v.as_chunks::<N>().0) {
        let energies = Lagrangian::<f64, N>::energies(&fixed, q, v);
        kinetic.push(energies.kinetic);
        potential.push(energies.potential);
        let dynamics = fixed.dynamics(q, v);
        l_q.extend(dynamics.l_q);
        mass.extend_from_slice(dynamics.mass.as_flattened());
        force.extend(fixed.force(q, v, &[0.0; 6]));
    }
    assert_close("T", &kinetic, &reference.get("T"), EXACT);
    assert_close("V", &potential, &reference.get("V"), EXACT);
    assert_close("L_q", &l_q, &reference.get("Pi"), EXACT);
    assert_close("M", &mass, &reference.get("M"), EXACT);
    let drag = reference.get("drag");
    assert_within("drag", &force, &drag, scale(&drag).max(1.0), EXACT);
}

#[test]
#[ignore = "needs LEASTACTION_REFERENCE"]
fn energies_and_derivatives_agree() {
    check_energies("3_pendulum", false);
}

#[test]
#[ignore = "needs LEASTACTION_REFERENCE"]
fn energies_derivatives_and_drag_agree() {
    check_energies("3_pendulum_drag", true);
}

/// Rows of A, one constraint after the other, and Ȧv.
fn rows(rods: &[Holonomic<f64, 2>], q: &[f64], v: &[f64]) -> [Vec<f64>; 2] {
    let (x, rates) = (Positions::new(q.as_chunks().0), v.as_chunks().0);
    let mut rows = vec![0.0; rods.len() * N];
    for (k, row) in rows.chunks_exact_mut(N).enumerate() {
        for (slot, node) in rods.nodes(k).iter().enumerate() {
            row[2 * node..2 * (node + 1)].copy_from_slice(&rods.gradient(k, slot, x));
        }
    }
    [rows, (0..rods.len()).map(|k| rods.curvature(k, x, rates)).collect()]
}

/// Checks the constraints, their multipliers and the accelerations: φ is |d|² − ℓ² in their program, (|d|² − ℓ²)/2ℓ in ours, and their rods
/// have 1 m; their λ has the other sign. The second half of the states lies off the rods.
fn check_motion(name: &str, drag: bool) {
    let imported = network(name, drag);
    let layout = graph(&imported).graph().expect("a chain");
    let particles = Graph::new(types(&imported), &layout.nodes, &layout.edges).expect("a graph");
    let rods = layout.constraints::<2>();
    let driven = Driven::new(&particles, &rods).expect("rods");
    let reference = arrays(name);
    let (q, v) = (reference.get("q"), reference.get("v"));
    let (mut jacobian, mut bend, mut lambda, mut acceleration) = (vec![], vec![], vec![], vec![]);
    for (q, v) in q.chunks_exact(N).zip(v.chunks_exact(N)) {
        let [rows, rate] = rows(&rods, q, v);
        jacobian.extend(rows.iter().map(|x| 2.0 * x));
        bend.extend(rate.iter().map(|x| 2.0 * x));
        lambda.extend(driven.multipliers(q, v, &[]).expect("rods that do not contradict each other"));
        let mut a = [0.0; N];
        driven.acceleration(q, v, &[], &mut a).expect("rods that do not contradict each other");
        acceleration.extend(a);
    }
    assert_close("A", &jacobian, &reference.get("A"), EXACT);
    assert_close("dA/dt v", &bend, &reference.get("Adot_v"), EXACT);
    let theirs: Vec<f64> = reference.get("lam").iter().map(|lambda| -2.0 * lambda).collect();
    assert_close("lambda", &lambda, &theirs, 1e-9);
    assert_close("acceleration", &acceleration, &reference.get("acc"), 1e-9);
}

#[test]
#[ignore = "needs LEASTACTION_REFERENCE"]
fn rods_and_accelerations_agree() {
    check_motion("3_pendulum", false);
    check_motion("3_pendulum_drag", true);
}

/// Gradient of their program in the order of our weight block. The import adds an embedding's weight and bias; in a
/// gradient both are equal to the gradient of the embedding, so their sum is halved.
fn gradient(arrays: &Arrays, prefix: &str) -> Vec<f64> {
    let imported = lgnn(&arrays.as_weights(prefix), BOBS, false).expect("gradient as weights");
    let embeddings: usize =
        LGNN_EMBEDDINGS.iter().map(|name| arrays.get(&format!("{prefix}{name}.0.bias")).len()).sum();
    let mut gradient = imported.weights;
    let end = gradient.len() - 2;
    gradient[end - embeddings..end].iter_mut().for_each(|g| *g *= 0.5);
    gradient
}

/// Diagonals of the mass matrices at states.
fn masses(imported: &Imported, q: &[f64], v: &[f64]) -> Vec<f64> {
    let layout = graph(imported).graph().expect("a chain");
    let particles = Graph::new(types(imported), &layout.nodes, &layout.edges).expect("a graph");
    let fixed: Model = Fixed::new(particles).expect("as many coordinates");
    let states = q.as_chunks::<N>().0.iter().zip(v.as_chunks::<N>().0);
    let mass = states.map(|(q, v)| fixed.dynamics(q, v).mass);
    mass.flat_map(|mass| std::array::from_fn::<f64, N, _>(|i| mass[i][i])).collect()
}

#[test]
#[ignore = "needs LEASTACTION_REFERENCE"]
fn losses_and_parameter_gradients_agree() {
    let training = Arrays::open(&data("lgnn").join("3_pendulum_gradients.npz"));
    let states = ["R", "V", "F"].map(|key| training.get(key));
    let free = vec![0.0; states[0].len()];
    let samples =
        Samples { n: N, h: 0.0, controls: [free.clone(), free.clone(), free], states, ..Samples::default() };
    let acceleration_loss = |imported: &Imported| {
        objective(&imported.architecture, samples.clone(), LossKind::Acceleration, 2).expect("compiled")
    };
    let trained = network("3_pendulum", false);
    let loss = acceleration_loss(&trained);
    assert_close("loss", &[loss.loss(&trained.weights)], &training.get("loss_trained"), 1e-9);
    let equations = loss.gradient(&trained.weights, 0..loss.samples()).expect("finite");
    let factor = 2.0 / equations.rows as f64;
    let ours: Vec<f64> = equations.gradient.iter().map(|g| factor * g).collect();
    assert_close("gradient", &ours, &gradient(&training, "grad_trained."), 1e-9);
    // Their initial network has negative masses: such samples count as not solved.
    let initial = lgnn(&training.as_weights("init."), BOBS, false).expect("import");
    let masses = masses(&initial, &samples.states[0], &samples.states[1]);
    println!("initial masses: {:?}", (masses.iter().copied().fold(f64::INFINITY, f64::min), scale(&masses)));
    assert!(masses.iter().any(|mass| *mass < 0.0));
    let loss = acceleration_loss(&initial);
    assert!(loss.solved(&initial.weights).unsolved > 0);
    assert!(loss.loss(&initial.weights).is_finite());
}
