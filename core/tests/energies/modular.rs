//! The modular family against its printed formulas, exact derivatives, and its symmetries.

use crate::common::oracle::{self, at_states};
use crate::common::trees::{self, Tree, node};
use crate::common::{Random, assert_vectors_close};
use leastaction_core::continuous::{acceleration, inverse_dynamics, momentum};
use leastaction_core::discrete::{Control, Del, Galerkin, Midpoint, Path, State};
use leastaction_core::energy::modular::{Input, PairInput, TreeElement, TreeError};
use leastaction_core::forces::System;
use proptest::prelude::*;

/// One generic check at all trees.
macro_rules! everywhere {
    ($check:path) => {
        at_states(&trees::of_three(), $check);
        at_states(&trees::of_six(), $check);
    };
}

oracle::family_tests!(everywhere);

#[test]
fn bodies_of_one_type_may_be_exchanged() {
    let tree = &trees::of_six()[1];
    let exchange = |[ax, ay, bx, by, cx, cy]: [f64; 6]| [cx, cy, bx, by, ax, ay];
    let (mut random, modular) = (Random(8), tree.in_f64());
    let (q, v) = (random.array(2.0), random.array(2.0));
    let system = System::conservative(modular);
    let still = [0.0; 6];
    let found = acceleration(&system, &exchange(q), &exchange(v), &still).unwrap();
    assert_vectors_close(
        "exchanged",
        &found,
        &exchange(acceleration(&system, &q, &v, &still).unwrap()),
        1e-14,
    );
}

/// Linear and angular momentum about the origin.
fn total_momentum(q: &[f64; 6], p: &[f64; 6]) -> [f64; 3] {
    let turn: f64 = (0..3).map(|e| q[2 * e] * p[2 * e + 1] - q[2 * e + 1] * p[2 * e]).sum();
    [p[0] + p[2] + p[4], p[1] + p[3] + p[5], turn]
}

/// A tree of the element type without a potential of its own.
fn free_bodies() -> Tree<6> {
    let tree = &trees::of_six()[0];
    Tree { nodes: vec![node(0, None); 3], ..tree.clone() }
}

#[test]
fn a_pair_potential_of_the_distance_conserves_linear_and_angular_momentum() {
    fn check<P: Path>() {
        let tree = free_bodies();
        let system = System::conservative(tree.in_f64());
        let mut random = Random(9);
        let (q, v): ([f64; 6], [f64; 6]) = (random.array(2.0), random.array(1.0));
        let mut state = State::new(&system.lagrangian, q, v).unwrap();
        let before = total_momentum(&q, &momentum(&system.lagrangian, &q, &v));
        let del = Del::<f64, P>::new(0.02);
        for _ in 0..500 {
            del.step(&system, &mut state, &Control::held([0.0; 6])).unwrap();
        }
        let after = total_momentum(&state.q(), &state.p());
        assert_vectors_close("momentum", &after, &before, 1e-11);
    }
    check::<Midpoint>();
    check::<Galerkin>();
}

#[test]
fn what_is_no_tree_is_refused() {
    let shape = trees::of_three()[0].shape;
    let tree = |nodes: &[TreeElement]| shape.tree::<2>(nodes.iter().copied()).err();
    assert_eq!(tree(&[]), Some(TreeError::Empty));
    assert_eq!(tree(&[node(0, Some(0))]), Some(TreeError::Parent { element: 0, parent: 0 }));
    let cycle = [node(0, Some(1)), node(0, Some(0))];
    assert_eq!(tree(&cycle), Some(TreeError::Parent { element: 0, parent: 1 }));
    assert_eq!(tree(&[node(3, None)]), Some(TreeError::Kind { element: 0, kind: 3, kinds: 3 }));
    let long = [node(0, None); 3];
    assert_eq!(tree(&long), Some(TreeError::Coordinates { found: 3, compiled: 2 }));
    assert_eq!(tree(&[node(1, None)]), Some(TreeError::Coordinates { found: 1, compiled: 2 }));
    assert_eq!(tree(&[node(1, None), node(2, Some(0))]), None);
}

/// Elements with N coordinates in all, made from any numbers: each is of a type that exists, on the ground or on an
/// earlier element.
fn nodes_from<const N: usize>(raw: &[(u8, u8)], kinds: u8, free: bool) -> Vec<TreeElement> {
    let each = if free { 2 } else { 1 };
    let elements = raw.iter().take(N / each).enumerate();
    elements
        .map(|(e, (kind, parent))| {
            node(kind % kinds, (*parent as usize % (e + 1)).checked_sub(1).map(|p| p as u8))
        })
        .collect()
}

const INPUTS: [Input; 3] = [Input::Translation, Input::Angle, Input::WrappedAngle];
const PAIRS: [PairInput; 3] = [PairInput::Concat, PairInput::Difference, PairInput::Distance];

/// A tree of N coordinates of random types on random parents, with random weights.
fn random_tree<const N: usize>() -> impl Strategy<Value = Tree<N>> {
    let elements = prop::collection::vec((any::<u8>(), any::<u8>()), N);
    let shape = (sample(&INPUTS), prop::option::of(sample(&PAIRS)), any::<bool>(), any::<bool>());
    (elements, shape, any::<u64>()).prop_map(|(raw, (input, pair, own_velocity, free), seed)| {
        let free = free && N.is_multiple_of(2);
        let shape = match pair {
            Some(pair) if free => trees::bodies(pair),
            pair => trees::chain(input, own_velocity.then_some(2), pair),
        };
        let free = free && pair.is_some();
        Tree::new(shape, &nodes_from::<N>(&raw, if free { 2 } else { 3 }, free), seed)
    })
}

fn sample<T: Clone + std::fmt::Debug>(of: &'static [T]) -> impl Strategy<Value = T> {
    prop::sample::select(of)
}

/// Energies by the printed formulas, and a = M⁻¹(L_q − L_vq v + u) ⇔ u = M a − L_q + L_vq v.
fn check_random<const N: usize>(tree: &Tree<N>, seed: u64) -> Result<(), TestCaseError> {
    let mut random = Random(seed);
    let (q, v, u) = (random.array(3.0), random.array(2.0), random.array::<N>(5.0));
    oracle::check_energies(tree, &q, &v);
    let system = tree.damped::<f64>(&tree.weights);
    match acceleration(&system, &q, &v, &u) {
        Ok(a) => {
            // Relative to the terms that cancel if M is nearly singular.
            let size = 1.0 + a.iter().fold(0.0_f64, |largest, a| largest.max(a.abs()));
            for (found, u) in inverse_dynamics(&system, &q, &v, &a).unwrap().iter().zip(u) {
                prop_assert!((found - u).abs() <= 1e-11 * size, "{found} instead of {u}, a = {a:?}");
            }
        }
        Err(singular) => prop_assert!(false, "{singular:?}"),
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(128) })]

    #[test]
    fn random_trees_are_their_printed_formulas_and_invert(
        (one, two, four, six) in (random_tree::<1>(), random_tree::<2>(), random_tree::<4>(), random_tree::<6>()),
        seed in any::<u64>(),
    ) {
        check_random(&one, seed)?;
        check_random(&two, seed)?;
        check_random(&four, seed)?;
        check_random(&six, seed)?;
    }
}
