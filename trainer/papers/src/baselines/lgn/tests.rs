//! Comparison with the equations of motion of a Lagrangian in plain loops.

use super::*;
use crate::baselines::oracle::{
    self, ADAM, Dual, assert_close, check_accelerations, check_epochs, constant, equation, messages, on_rods,
    random, squareplus, take,
};
use leastaction_core::energy::graph::Edge;
use leastaction_core::model::Rod;
use leastaction_ground_truth::{LgnnSystem, lgnn_graph};
use leastaction_learning::training::AdamSettings;
use leastaction_programs::{Row, System, WIDTH};
use std::array::from_fn;

/// The number of nodes and all sizes differ from one another, so that a swap of two shows. The node embedding is at
/// least as long as the velocity; otherwise L_vv would be singular.
const SIZES: GraphSizes = GraphSizes { dimension: 2, node: 4, edge: 1, hidden: 5 };
const NODES: usize = 3;
const N: usize = 2 * NODES;
const KINDS: [u8; NODES] = [0, 2, 1];
const EDGE: [u16; 2] = [0, 2];
/// Rods from the origin or a node to another node.
const RODS: [(Option<u16>, u16); 2] = [(None, 0), (Some(2), 1)];
/// Number of samples, not divisible by the number of lanes.
const SAMPLES: usize = 9;

/// Creates a model with its nodes in the given order; `order` lists their old numbers.
fn lgn(order: [usize; NODES], rods: &[(Option<u16>, u16)]) -> Lgn {
    let place = |node: u16| order.iter().position(|old| *old == usize::from(node)).unwrap() as u16;
    let rod = |(from, to): &(Option<u16>, u16)| Rod { from: from.map(place), to: place(*to), length: 1.0 };
    let graph = NamedGraph {
        name: "web".to_owned(),
        nodes: order.map(|old| KINDS[old]).to_vec(),
        edges: vec![Edge { kind: 0, ends: EDGE.map(place) }],
        rods: rods.iter().map(rod).collect(),
    };
    Lgn::new(SIZES, graph).unwrap()
}

const AS_IS: [usize; NODES] = [0, 1, 2];

fn samples() -> Samples {
    oracle::samples(N, SAMPLES, [1.0, 1.5, 2.0])
}

/// Weights that give a mass matrix far from singular at the samples.
fn weights() -> Vec<f64> {
    lgn(AS_IS, &[]).initial_weights(34)
}

/// L of a state that moves along three directions.
fn lagrangian(weights: &[Dual], rods: &[(Option<u16>, u16)], state: &[Dual]) -> Dual {
    let mut ends = vec![EDGE];
    ends.extend(rods.iter().filter_map(|(from, to)| Some([(*from)?, *to])));
    let (mut weights, (q, v)) = (weights, state.split_at(N));
    let nodes = messages(&mut weights, SIZES, (&KINDS.map(f64::from), &ends), [q, v]);
    let sum = (0..SIZES.node).map(|k| nodes.iter().fold(Dual::from(0.0), |sum, node| sum + node[k]));
    take(&mut weights, sum.collect(), &[SIZES.hidden, SIZES.hidden, 1], squareplus)[0]
}

/// Acceleration v̇, from second derivatives by num-dual.
fn naive(weights: &[f64], rods: &[(Option<u16>, u16)], q: &[f64], v: &[f64]) -> Vec<f64> {
    let weights = constant(weights);
    on_rods(equation(|state| lagrangian(&weights, rods, state), [q, v]), rods, [q, v])
}

#[test]
fn accelerations_and_their_normal_equations_are_those_of_plain_loops_and_differences() {
    let (lgn, weights) = (lgn(AS_IS, &RODS), weights());
    check_accelerations(&lgn, (&weights, &samples()), |w, q, v| naive(w, &RODS, q, v));
}

#[test]
fn accelerations_that_are_followed_are_the_same() {
    let (q, v, weights) = (random(N, 1.0, 7), random(N, 1.5, 8), weights());
    for rods in [&[][..], &RODS] {
        let mut a = [0.0; N];
        lgn(AS_IS, rods).motion(&weights).unwrap()(&q, &v, &mut a).unwrap();
        for (found, expected) in a.iter().zip(naive(&weights, rods, &q, &v)) {
            assert_close("acceleration", *found, expected, 1e-9);
        }
        assert!(a.iter().any(|a| a.abs() > 0.1));
    }
}

#[test]
fn nodes_in_another_order_have_the_same_lagrangian_and_the_accelerations_in_that_order() {
    let order = [2, 0, 1];
    let permute =
        |x: &[f64]| order.iter().flat_map(|old| x[2 * old..2 * (old + 1)].to_vec()).collect::<Vec<_>>();
    let (weights, q, v) = (weights(), random(N, 1.0, 7), random(N, 1.0, 8));
    let (before, after) = (lgn(AS_IS, &RODS), lgn(order, &RODS));
    let l = |lgn: &Lgn, [q, v]: [&[f64]; 2]| {
        let (program, rows) = (System::new(lgn).energies(), |x: &[f64]| -> Vec<Row> {
            x.iter().copied().map(Row::splat).collect()
        });
        let mut workspace = program.workspace();
        program.run(&weights, &[&rows(q), &rows(v)], &mut workspace, &mut []);
        workspace.output(0)[0].0[0]
    };
    let l = [l(&before, [&q, &v]), l(&after, [&permute(&q), &permute(&v)])];
    assert_close("L", l[0], l[1], 1e-13);
    let (mut a, mut permuted) = ([0.0; N], [0.0; N]);
    before.motion(&weights).unwrap()(&q, &v, &mut a).unwrap();
    after.motion(&weights).unwrap()(&permute(&q), &permute(&v), &mut permuted).unwrap();
    for (found, expected) in permuted.iter().zip(permute(&a)) {
        assert_close("acceleration", *found, expected, 1e-9);
    }
    assert!(a.iter().zip(&permuted).any(|(a, b)| (a - b).abs() > 1e-3));
}

#[test]
fn a_few_epochs_lower_the_loss() {
    for system in [LgnnSystem::Spring(5), LgnnSystem::Pendulum(3)] {
        let lgn = Lgn::new(SIZES, lgnn_graph(system)).unwrap();
        check_epochs(&lgn, (system, 1), (AdamSettings { learning_rate: 1e-3, ..ADAM }, 30));
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let shape = |what, found, compiled| Some(ModelError::Shape { what, found, compiled });
    let on = |sizes, nodes| Lgn::new(sizes, lgnn_graph(LgnnSystem::Spring(nodes)));
    assert_eq!(on(GraphSizes { dimension: 3, ..SIZES }, 5).err(), shape("dimensions", 3, 2));
    let five = on(GraphSizes::LGNN, 5).unwrap();
    assert_eq!((five.parameters(), five.initial_weights(0).len()), (2_113, 2_113));
    assert_eq!(five.objective(samples()).err(), shape("coordinates", N, 10));
    let needed = five.parameters();
    assert_eq!(five.motion(&[0.0; 9]).err(), shape("weights", 9, needed));
    let weights = five.initial_weights(0);
    assert!(five.motion(&weights).unwrap()(&[0.0; 9], &[0.0; 10], &mut [0.0; 10]).is_none());
}

/// A graph with more coordinates than lanes, so that the mass matrix is computed in several blocks.
#[test]
fn accelerations_of_many_nodes_are_those_that_are_learned_from() {
    let lgn = Lgn::new(SIZES, lgnn_graph(LgnnSystem::Spring(10))).unwrap();
    let n = lgn.n();
    assert!(n > WIDTH);
    let (q, v, weights) = (random(n, 1.0, 5), random(n, 1.5, 6), lgn.initial_weights(34));
    let mut a = vec![0.0; n];
    lgn.motion(&weights).unwrap()(&q, &v, &mut a).unwrap();
    let states = [q, v, a.clone()];
    let samples = Samples { n, states, controls: from_fn(|_| vec![0.0; n]), ..Samples::default() };
    let size = a.iter().map(|a| a * a).sum::<f64>() / n as f64;
    assert!(size > 1e-2 && lgn.objective(samples).unwrap().loss(&weights) < 1e-18 * size);
}
