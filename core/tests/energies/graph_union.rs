//! Trained graphs joined on one set of nodes, and edges from a cutoff.

use crate::common::graphs::{LearnedGraph, Model, edge, every_term, with_messages};
use crate::common::{Random, assert_close, assert_vectors_close};
use leastaction_core::energy::graph::{Edge, GraphError, Member, Union, cutoff_edges};
use leastaction_core::particles::Particles;

const NODES: usize = 6;
/// The nodes of the two members; 1 and 4 are in both.
const FIRST: [u16; 4] = [0, 1, 4, 5];
const SECOND: [u16; 4] = [1, 2, 3, 4];

fn models() -> [Model<2>; 2] {
    let edges = [edge(0, 0, 1), edge(1, 2, 1), edge(0, 3, 0)];
    [
        Model::new(every_term(2), &[0, 1, 2, 1], &edges, 1),
        Model::new(with_messages(2), &[1, 0, 2, 1], &edges[..2], 2),
    ]
}

fn member<'a>(model: &'a Model<2>, nodes: &'a [u16]) -> Member<'a, f64, 2, 11, 11, 3> {
    Member { graph: model.in_f64(), nodes }
}

fn workspace(of: &impl Particles<f64, 2>) -> Vec<f64> {
    vec![f64::NAN; of.workspace()]
}

fn own<const N: usize>(nodes: &[u16; N], x: &[[f64; 2]; NODES]) -> [[f64; 2]; N] {
    nodes.map(|node| x[usize::from(node)])
}

#[test]
fn potentials_and_drags_add_and_kinetic_energy_counts_once() {
    let [a, b] = models();
    let members = [member(&a, &FIRST), member(&b, &SECOND)];
    let union = Union::new(&members, NODES).unwrap();
    let mut random = Random(3);
    let q: [[f64; 2]; NODES] = core::array::from_fn(|_| random.array(2.0));
    let v: [[f64; 2]; NODES] = core::array::from_fn(|_| random.array(2.0));
    let energies = union.energies(&q, &v, &mut workspace(&union));
    let potential = a.naive_potential(&own(&FIRST, &q)) + b.naive_potential(&own(&SECOND, &q));
    assert_close("potential", energies.potential, potential, 1e-13);
    let first = FIRST.iter().zip(&a.nodes).map(|(node, kind)| a.naive_kinetic(*kind, &v[usize::from(*node)]));
    let rest = b.naive_kinetic(0, &v[2]) + b.naive_kinetic(2, &v[3]);
    assert_close("kinetic", energies.kinetic, first.sum::<f64>() + rest, 1e-13);

    let mut found = [[f64::NAN; 2]; NODES];
    union.l_q(&q, &mut workspace(&union), &mut found);
    let mut sums = [[0.0; 2]; NODES];
    for (model, nodes) in [(&a, &FIRST), (&b, &SECOND)] {
        let (graph, mut forces) = (model.in_f64(), [[f64::NAN; 2]; 4]);
        graph.l_q(&own(nodes, &q), &mut workspace(&graph), &mut forces);
        for (node, force) in nodes.iter().zip(forces) {
            (0..2).for_each(|k| sums[usize::from(*node)][k] += force[k]);
        }
    }
    for (found, sum) in found.iter().zip(&sums) {
        assert_vectors_close("l_q", found, sum, 1e-15);
    }
}

#[test]
fn a_node_has_the_mass_of_the_first_member_and_the_drag_of_all() {
    let [a, b] = models();
    let members = [member(&a, &FIRST), member(&b, &SECOND)];
    let union = Union::new(&members, NODES).unwrap();
    let (first, second): (LearnedGraph<f64, 2>, _) = (a.in_f64(), b.in_f64());
    let v = [0.7, -0.3];
    // Node 4 is node 2 of the first member and node 3 of the second.
    assert_eq!(union.l_v(4, &v), first.l_v(2, &v));
    assert_eq!(Particles::mass(&union, 4, &v), Particles::mass(&first, 2, &v));
    assert_eq!(union.l_v(3, &v), second.l_v(2, &v));
    // Node 1: a network's drag, and viscous drag.
    let sum = |x: [f64; 2], y: [f64; 2]| [x[0] + y[0], x[1] + y[1]];
    assert_eq!(union.drag(1, &v), sum(first.drag(1, &v), second.drag(0, &v)));
    assert_eq!(union.drag_slope(1, &v), sum(first.drag_slope(1, &v), second.drag_slope(0, &v)));
    assert_ne!(first.drag(1, &v), [0.0; 2]);
    assert_ne!(second.drag(0, &v), [0.0; 2]);
}

#[test]
fn members_that_do_not_fit_are_refused() {
    let [a, b] = models();
    let union = |first: &[u16], second: &[u16], nodes| {
        Union::new(&[member(&a, first), member(&b, second)], nodes).map(|_| ()).err()
    };
    assert_eq!(union(&FIRST, &SECOND, NODES), None);
    assert_eq!(union(&FIRST, &SECOND, 0), Some(GraphError::Empty));
    let short = GraphError::MemberNodes { member: 1, found: 3, needed: 4 };
    assert_eq!(union(&FIRST, &[1, 2, 3], NODES), Some(short));
    let order = |member, node| Some(GraphError::MemberOrder { member, node });
    assert_eq!(union(&[0, 4, 1, 5], &SECOND, NODES), order(0, 1));
    assert_eq!(union(&FIRST, &[1, 2, 2, 3], NODES), order(1, 2));
    assert_eq!(union(&[0, 1, 4, 6], &SECOND, NODES), order(0, 6));
    assert_eq!(union(&FIRST, &[0, 1, 2, 4], NODES), Some(GraphError::Ownerless { node: 3 }));
    assert_eq!(union(&FIRST, &SECOND, NODES + 1), Some(GraphError::Ownerless { node: 6 }));
}

#[test]
fn edges_join_all_that_are_nearer_than_the_cutoff() {
    let mut random = Random(4);
    let q: [[f64; 3]; 40] = core::array::from_fn(|_| random.array(1.0));
    let near = |a: usize, b: usize| (0..3).map(|k| (q[a][k] - q[b][k]).powi(2)).sum::<f64>().sqrt() < 0.6;
    let expected: Vec<Edge> = (0..40)
        .flat_map(|b| (0..b).map(move |a| (a, b)))
        .filter(|(a, b)| near(*a, *b))
        .map(|(a, b)| edge(3, a as u16, b as u16))
        .collect();
    let needed = expected.len();
    assert!((20..400).contains(&needed), "{needed} edges");
    let mut edges = vec![Edge::default(); needed + 1];
    assert_eq!(cutoff_edges(&q, 0.6, 3, &mut edges), Ok(needed));
    assert_eq!(edges[..needed], expected);
    assert_eq!(cutoff_edges(&q, 0.6, 3, &mut edges[..needed]), Ok(needed));
    let few = cutoff_edges(&q, 0.6, 3, &mut edges[..needed - 1]);
    assert_eq!(few, Err(GraphError::TooManyEdges { capacity: needed - 1, needed }));
    assert_eq!(cutoff_edges(&q, 0.0, 3, &mut edges), Ok(0));
}
