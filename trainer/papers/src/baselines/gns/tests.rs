//! Comparison with messages in plain loops, and on permuted and other graphs.

use super::*;
use crate::baselines::oracle::{
    self, ADAM, assert_close, check_accelerations, check_epochs, messages, random, squareplus, take,
};
use leastaction_core::energy::graph::Edge;
use leastaction_ground_truth::{LgnnSystem, lgnn_graph};
use leastaction_models::NamedGraph;

/// Nodes, edges and sizes are pairwise distinct.
const SIZES: GraphSizes = GraphSizes { dimension: 3, node: 2, edge: 6, hidden: 7 };
const NODES: usize = 5;
const N: usize = 3 * NODES;
const ENDS: [[u16; 2]; 4] = [[0, 1], [3, 1], [1, 2], [4, 0]];
/// Number of samples, not divisible by the number of lanes.
const SAMPLES: usize = 11;

fn named(nodes: &[u8], ends: &[[u16; 2]]) -> NamedGraph {
    let edges = ends.iter().map(|ends| Edge { kind: 0, ends: *ends }).collect();
    NamedGraph { name: "web".to_owned(), nodes: nodes.to_vec(), edges, rods: Vec::new() }
}

fn gns() -> Gns {
    Gns::new(SIZES, &named(&[0, 1, 0, 2, 1], &ENDS)).unwrap()
}

fn samples() -> Samples {
    oracle::samples(N, SAMPLES, [1.0, 1.5, 2.0])
}

/// The model, written directly from its printed equations.
fn naive(mut weights: &[f64], kinds: &[f64], q: &[f64], v: &[f64]) -> Vec<f64> {
    let nodes = messages(&mut weights, SIZES, (kinds, &ENDS), [q, v]);
    let GraphSizes { dimension, hidden, .. } = SIZES;
    let read = |node| take(&mut { weights }, node, &[hidden, hidden, dimension], squareplus);
    nodes.into_iter().flat_map(read).collect()
}

#[test]
fn accelerations_and_their_normal_equations_are_those_of_plain_loops_and_differences() {
    let (gns, kinds) = (gns(), [0.0, 1.0, 0.0, 2.0, 1.0]);
    check_accelerations(&gns, (&gns.initial_weights(4), &samples()), |w, q, v| naive(w, &kinds, q, v));
}

#[test]
fn nodes_without_edges_have_accelerations_of_their_own() {
    let alone = Gns::new(SIZES, &named(&[0, 2], &[])).unwrap();
    let weights = alone.initial_weights(4);
    let motion = |gns: &Gns, q: &[f64], v: &[f64]| {
        let mut a = vec![0.0; q.len()];
        gns.motion(&weights).unwrap()(q, v, &mut a).unwrap();
        a
    };
    let (q, v) = (random(6, 1.0, 7), random(6, 1.0, 8));
    let first = motion(&Gns::new(SIZES, &named(&[0], &[])).unwrap(), &q[..3], &v[..3]);
    assert_eq!(first, motion(&alone, &q, &v)[..3]);
}

#[test]
fn nodes_in_another_order_have_the_accelerations_in_that_order() {
    let order: [usize; NODES] = [3, 0, 4, 1, 2];
    let place = |node: u16| order.iter().position(|old| *old == usize::from(node)).unwrap() as u16;
    let (gns, kinds) = (gns(), [0, 1, 0, 2, 1]);
    let ends = ENDS.map(|ends| ends.map(place));
    let permuted = Gns::new(SIZES, &named(&order.map(|old| kinds[old]), &ends)).unwrap();
    let permute =
        |x: &[f64]| order.iter().flat_map(|old| x[3 * old..3 * (old + 1)].to_vec()).collect::<Vec<_>>();
    let (weights, q, v) = (gns.initial_weights(6), random(N, 1.0, 7), random(N, 1.0, 8));
    let (mut before, mut after) = ([0.0; N], [0.0; N]);
    gns.motion(&weights).unwrap()(&q, &v, &mut before).unwrap();
    permuted.motion(&weights).unwrap()(&permute(&q), &permute(&v), &mut after).unwrap();
    for (after, before) in after.iter().zip(permute(&before)) {
        assert_close("acceleration", *after, before, 1e-12);
    }
    assert!(before.iter().zip(&after).any(|(a, b)| (a - b).abs() > 1e-3));
}

#[test]
fn weights_of_five_springs_serve_a_ring_of_any_size() {
    let on = |nodes| Gns::new(GraphSizes::LGNN, &lgnn_graph(LgnnSystem::Spring(nodes))).unwrap();
    let five = on(5);
    assert_eq!((five.parameters(), five.initial_weights(0).len()), (2_130, 2_130));
    // If all nodes have the same state and type, their number makes no difference.
    let weights = five.initial_weights(1);
    let alike = |nodes: usize| {
        let (q, v) = ([0.3, 0.4].repeat(nodes), [0.1, -0.2].repeat(nodes));
        let mut a = vec![0.0; 2 * nodes];
        on(nodes).motion(&weights).unwrap()(&q, &v, &mut a).unwrap();
        a
    };
    assert_eq!(alike(5).repeat(10), alike(50));
}

#[test]
fn a_few_epochs_lower_the_loss() {
    let system = LgnnSystem::Spring(5);
    let gns = Gns::new(GraphSizes::LGNN, &lgnn_graph(system)).unwrap();
    check_epochs(&gns, (system, 2), (ADAM, 30));
}

#[test]
fn what_does_not_fit_is_refused() {
    let shape = |what, found, compiled| Some(ModelError::Shape { what, found, compiled });
    assert_eq!(Gns::new(SIZES, &named(&[0, 0], &[[0, 2]])).err(), shape("nodes", 3, 2));
    let ring = Gns::new(GraphSizes::LGNN, &lgnn_graph(LgnnSystem::Spring(5))).unwrap();
    assert_eq!(ring.objective(samples()).err(), shape("coordinates", 15, 10));
    assert_eq!(ring.motion(&[0.0; 9]).err(), shape("weights", 9, ring.parameters()));
    let weights = ring.initial_weights(0);
    assert!(ring.motion(&weights).unwrap()(&[0.0; 9], &[0.0; 10], &mut [0.0; 10]).is_none());
}
