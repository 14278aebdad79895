//! The graph family against its printed formulas, exact derivatives, and its symmetries.

use crate::common::graphs::{self, FixedModel, Model, edge, every_term, with_messages};
use crate::common::oracle::{self, at_states};
use crate::common::{Random, assert_close, assert_vectors_close};
use leastaction_core::energy::graph::{Edge, Fixed, Graph, GraphError, GraphShape, MAX_NODES};
use leastaction_core::forces::Forces;
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::particles::Particles;
use leastaction_core::scalar::{LANES, Lanes, Real};

fn of_eight() -> [FixedModel<2, 8>; 3] {
    [graphs::flat(), graphs::talking(), graphs::alike()].map(FixedModel)
}

fn of_nine() -> [FixedModel<3, 9>; 1] {
    [FixedModel(graphs::spatial())]
}

/// One generic check at all graphs.
macro_rules! everywhere {
    ($check:path) => {
        at_states(&of_eight(), $check);
        at_states(&of_nine(), $check);
    };
}

oracle::family_tests!(everywhere);

/// A ring with chords, whose nodes and edges come in runs longer and shorter than a pack.
fn ring(shape: GraphShape, nodes: usize) -> Model<2> {
    let mut random = Random(11);
    let kinds: Vec<u8> = (0..nodes).map(|i| if i < 11 { 1 } else { (random.bits() % 3) as u8 }).collect();
    let next = |i: usize, by: usize| ((i + by) % nodes) as u16;
    let ring = (0..nodes).map(|i| edge(0, i as u16, next(i, 1)));
    let chords = (0..nodes / 2).map(|i| edge((random.bits() % 2) as u8, next(i, 5), i as u16));
    let edges: Vec<Edge> = ring.chain(chords).collect();
    Model::new(shape, &kinds, &edges, 12)
}

const NODES: usize = 37;

fn state() -> ([[f64; 2]; NODES], [[f64; 2]; NODES]) {
    let mut random = Random(13);
    (core::array::from_fn(|_| random.array(3.0)), core::array::from_fn(|_| random.array(2.0)))
}

/// A workspace that already holds something, here NaN.
fn workspace<R: Real>(graph: &impl Particles<R, 2>) -> Vec<R> {
    vec![R::constant(f64::NAN); graph.workspace()]
}

fn l_q<const N: usize>(model: &Model<2>, q: &[[f64; 2]; N]) -> [[f64; 2]; N] {
    let (graph, mut l_q) = (model.in_f64(), [[f64::NAN; 2]; N]);
    graph.l_q(q, &mut workspace(&graph), &mut l_q);
    l_q
}

#[test]
fn forces_on_many_nodes_are_differences_of_the_printed_potential() {
    forces_are_differences(&ring(every_term(2), NODES));
    forces_are_differences(&ring(with_messages(2), NODES));
}

fn forces_are_differences(model: &Model<2>) {
    const STEP: f64 = 1e-5;
    let (q, v) = state();
    let found = l_q(model, &q);
    for i in 0..NODES {
        for k in 0..2 {
            let at = |step: f64| {
                let mut q = q;
                q[i][k] += step;
                model.naive_potential(&q)
            };
            assert_close("l_q", found[i][k], (at(-STEP) - at(STEP)) / (2.0 * STEP), 1e-8);
        }
    }
    let graph = model.in_f64();
    let energies = Particles::energies(&graph, &q, &v, &mut workspace(&graph));
    let kinetic: f64 = model.nodes.iter().zip(&v).map(|(kind, v)| model.naive_kinetic(*kind, v)).sum();
    assert_close("potential", energies.potential, model.naive_potential(&q), 1e-13);
    assert_close("kinetic", energies.kinetic, kinetic, 1e-13);
}

#[test]
fn packs_have_the_bits_of_one_after_another() {
    for shape in [every_term(2), with_messages(2)] {
        packs_have_the_same_bits(&ring(shape, NODES));
    }
}

fn packs_have_the_same_bits(model: &Model<2>) {
    let (graph, (q, v)) = (model.in_f64(), state());
    let flat = |x: &[[f64; 2]; NODES]| -> [f64; 2 * NODES] { x.as_flattened().try_into().unwrap() };
    let alone = Fixed::<_, 2, _, _, _, { 2 * NODES }>::new(graph).unwrap();
    let (q_alone, v_alone) = (flat(&q), flat(&v));
    assert_eq!(alone.gradient(&q_alone, &v_alone).l_q, flat(&l_q(model, &q)));
    let packed = Particles::energies(&graph, &q, &v, &mut workspace(&graph));
    assert_eq!(packed, Lagrangian::<f64, _>::energies(&alone, &q_alone, &v_alone));
}

#[test]
fn lanes_have_the_bits_of_one_state_after_another() {
    let [_, talking, _] = of_eight();
    let fixed = talking.in_f64();
    let mut random = Random(18);
    let states: [([f64; 8], [f64; 8]); LANES] =
        core::array::from_fn(|_| (random.array(2.0), random.array(2.0)));
    let (q, v) = (states.map(|(q, _)| q), states.map(|(_, v)| v));
    let packed = |x: [[f64; 8]; LANES]| core::array::from_fn(|i| Lanes(x.map(|x| x[i])));
    let found = Lagrangian::<Lanes, 8>::gradient(&fixed, &packed(q), &packed(v));
    for (l, (q, v)) in states.iter().enumerate() {
        let alone = fixed.gradient(q, v);
        assert_eq!(found.l_q.map(|x| x.0[l]), alone.l_q);
        assert_eq!(found.l_v.map(|x| x.0[l]), alone.l_v);
    }
}

#[test]
fn momenta_masses_and_drag_are_those_of_the_fixed_graph() {
    let [fixed, ..] = of_eight();
    let (fixed, mut random) = (fixed.in_f64(), Random(14));
    let (q, v): ([f64; 8], [f64; 8]) = (random.array(2.0), random.array(2.0));
    let (dynamics, (_, slopes)) = (fixed.dynamics(&q, &v), fixed.derivatives(&q, &v, &[0.0; 8]));
    let (mass, force) = (dynamics.mass, fixed.force(&q, &v, &[0.0; 8]));
    for (i, v) in v.as_chunks::<2>().0.iter().enumerate() {
        let (graph, at) = (fixed.graph(), |k: usize| 2 * i + k);
        assert_eq!(graph.l_v(i, v), [0, 1].map(|k| dynamics.l_v[at(k)]));
        assert_eq!(graph.drag(i, v), [0, 1].map(|k| force[at(k)]));
        assert_eq!(graph.drag_slope(i, v), [0, 1].map(|k| slopes[at(k)][at(k)]));
        assert_eq!(Particles::mass(graph, i, v), [0, 1].map(|k| [0, 1].map(|l| mass[at(k)][at(l)])));
    }
}

/// Neighbouring nodes, starting in the middle of the list, across runs of types and past a whole pack.
#[test]
fn neighbours_have_the_bits_of_one_after_another() {
    const FIRST: usize = 5;
    let (model, (_, v)) = (ring(every_term(2), NODES), state());
    let (graph, v) = (model.in_f64(), &v[FIRST..NODES - 2]);
    let (mut l_v, mut drags, mut slopes) = (v.to_vec(), v.to_vec(), v.to_vec());
    let mut masses = vec![[[f64::NAN; 2]; 2]; v.len()];
    graph.momenta(FIRST, v, &mut l_v);
    graph.masses(FIRST, v, &mut masses);
    graph.drags(FIRST, v, &mut drags);
    graph.drag_slopes(FIRST, v, &mut slopes);
    for (i, v) in v.iter().enumerate() {
        let node = FIRST + i;
        assert_eq!((l_v[i], masses[i]), (graph.l_v(node, v), Particles::mass(&graph, node, v)));
        assert_eq!((drags[i], slopes[i]), (graph.drag(node, v), graph.drag_slope(node, v)));
    }
}

#[test]
fn single_precision_is_near() {
    let (model, (q, _)) = (ring(with_messages(2), NODES), state());
    let weights: Vec<f32> = model.weights.iter().map(|w| *w as f32).collect();
    let mut found = [[f32::NAN; 2]; NODES];
    let graph = model.graph(&weights);
    graph.l_q(&q.map(|x| x.map(|x| x as f32)), &mut workspace(&graph), &mut found);
    for (found, exact) in found.iter().zip(l_q(&model, &q)) {
        assert_vectors_close("l_q", &found.map(f64::from), &exact, 1e-5);
    }
}

#[test]
fn pairs_give_no_force_and_no_torque_to_the_whole() {
    let nodes = [0; 9];
    let edges: Vec<Edge> =
        (0..9).flat_map(|b| (0..b).map(move |a| edge(((a + b) % 2) as u8, a, b))).collect();
    let model = Model::<2>::new(with_messages(2), &nodes, &edges, 15);
    let mut random = Random(16);
    let q: [[f64; 2]; 9] = core::array::from_fn(|_| random.array(2.0));
    let forces = l_q(&model, &q);
    assert!(forces.iter().flatten().any(|force| force.abs() > 1e-2), "{forces:?}");
    let sum = |of: &dyn Fn(usize) -> f64| (0..9).map(of).sum::<f64>();
    assert_close("force", sum(&|i| forces[i][0] + forces[i][1]), 0.0, 1e-14);
    assert_close("torque", sum(&|i| q[i][0] * forces[i][1] - q[i][1] * forces[i][0]), 0.0, 1e-14);
    let turned_and_moved = q.map(|[x, y]| [0.6 * x - 0.8 * y + 3.0, 0.8 * x + 0.6 * y - 1.0]);
    let turned = l_q(&model, &turned_and_moved);
    for (force, [x, y]) in turned.iter().zip(forces) {
        assert_vectors_close("turned", force, &[0.6 * x - 0.8 * y, 0.8 * x + 0.6 * y], 1e-13);
    }
}

#[test]
fn drag_is_the_printed_formula_and_its_derivatives_are_differences() {
    const STEP: f64 = 1e-6;
    let [model, ..] = of_eight();
    let mut random = Random(17);
    let (q, v): ([f64; 8], [f64; 8]) = (random.array(2.0), random.array(2.0));
    let force = |model: &FixedModel<2, 8>, v: &[f64; 8]| model.in_f64().force(&q, v, &[0.0; 8]);
    let naive: [f64; 8] = core::array::from_fn(|i| model.0.naive_drag(model.0.nodes[i / 2], v[i]));
    assert_vectors_close("drag", &force(&model, &v), &naive, 1e-14);
    assert!(naive.iter().zip(&v).all(|(force, v)| force * v <= 0.0), "{naive:?} against {v:?}");
    let (by_q, by_v) = model.in_f64().derivatives(&q, &v, &[0.0; 8]);
    assert_eq!(by_q, [[0.0; 8]; 8]);
    for (j, step) in (0..8).map(|j| (j, crate::common::dual::unit::<8>(j).map(|x| STEP * x))) {
        let at = |sign: f64| force(&model, &core::array::from_fn(|i| v[i] + sign * step[i]));
        let (back, forth) = (at(-1.0), at(1.0));
        for i in 0..8 {
            assert_close("slope", by_v[i][j], (forth[i] - back[i]) / (2.0 * STEP), 1e-8);
        }
    }
}

#[test]
fn what_is_no_graph_is_refused() {
    let model = graphs::flat();
    let types = model.types(&model.weights);
    let graph = |nodes: &[u8], edges: &[Edge]| Graph::new(types, nodes, edges).err();
    assert_eq!(graph(&[], &[]), Some(GraphError::Empty));
    assert_eq!(graph(&[0, 3], &[]), Some(GraphError::NodeKind { node: 1, kind: 3, kinds: 3 }));
    let edges = [edge(1, 0, 1), edge(2, 0, 1)];
    assert_eq!(graph(&[0, 0], &edges), Some(GraphError::EdgeKind { edge: 1, kind: 2, kinds: 2 }));
    assert_eq!(graph(&[0, 0], &[edge(0, 1, 2)]), Some(GraphError::End { edge: 0, node: 2, nodes: 2 }));
    assert_eq!(graph(&[0, 0], &[edge(0, 7, 0)]), Some(GraphError::End { edge: 0, node: 7, nodes: 2 }));
    assert_eq!(graph(&[0, 0], &[edge(0, 1, 1)]), Some(GraphError::Loop { edge: 0, node: 1 }));
    let many = vec![0; MAX_NODES + 1];
    let found = MAX_NODES + 1;
    assert_eq!(graph(&many, &[]), Some(GraphError::TooManyNodes { found, most: MAX_NODES }));
    assert_eq!(graph(&many[1..], &[]), None);
    let fixed = Fixed::<_, 2, _, _, _, 7>::new(model.in_f64()).err();
    assert_eq!(fixed, Some(GraphError::Coordinates { found: 8, compiled: 7 }));
}

#[test]
fn numbers_that_must_be_positive_are_checked() {
    let start = graphs::flat().weights.len() - every_term(2).all_numbers();
    let check = |position: usize, number: f64| {
        let mut model = graphs::flat();
        model.weights[start + position] = number;
        model.types(&model.weights).check_numbers()
    };
    let second = every_term(2).numbers();
    assert_eq!(check(0, 1e-9), Ok(()));
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(check(0, bad), Err(GraphError::Mass { kind: 0 }));
        assert_eq!(check(2 * second, bad), Err(GraphError::Mass { kind: 2 }));
        // The second type has networks instead.
        assert_eq!(check(second, bad), Ok(()));
    }
    assert_eq!(check(1, 0.0), Ok(()));
    for bad in [-1e-9, f64::NAN, f64::INFINITY] {
        assert_eq!(check(1, bad), Err(GraphError::Drag { kind: 0 }));
        assert_eq!(check(2 * second + 1, bad), Ok(()));
    }
}
