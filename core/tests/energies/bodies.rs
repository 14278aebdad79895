//! Trees of rigid bodies against their printed formulas and exact derivatives.

use crate::common::bodies::{self, Bodies, CHAIN, body};
use crate::common::dual::Dual;
use crate::common::oracle::{at_states, check_lagrangian, check_second_derivatives};
use crate::common::{assert_close, assert_matrices_close};
use leastaction_core::energy::bodies::{BodyTree, Joint, PlanarBodies, TreeBody, TreeError};
use leastaction_core::lagrangian::Lagrangian;

macro_rules! everywhere {
    ($check:path) => {
        at_states(&bodies::of_one(), $check);
        at_states(&bodies::of_two(), $check);
        at_states(&bodies::of_five(), $check);
    };
}

#[test]
fn energies_are_those_of_the_printed_formulas() {
    fn check<const N: usize>(bodies: &Bodies<N>, q: &[f64; N], v: &[f64; N]) {
        let found = bodies.in_f64().energies(q, v);
        let (kinetic, potential) = bodies.naive_energies(q, v);
        // Velocities are central differences in the naive energies.
        assert_close("kinetic", found.kinetic, kinetic, 1e-8);
        assert_close("potential", found.potential, potential, 1e-13);
    }
    everywhere!(check);
}

#[test]
fn all_derivatives_are_those_of_the_energies() {
    fn check<const N: usize>(bodies: &Bodies<N>, q: &[f64; N], v: &[f64; N]) {
        let weights: Vec<Dual> = bodies.weights.iter().map(|w| Dual::constant(*w)).collect();
        check_lagrangian((&bodies.in_f64(), &bodies.over(&weights)), q, v);
    }
    everywhere!(check);
}

#[test]
fn second_derivatives_are_symmetric_and_the_mass_matrix_is_positive_definite() {
    fn check<const N: usize>(bodies: &Bodies<N>, q: &[f64; N], v: &[f64; N]) {
        check_second_derivatives(&bodies.in_f64(), q, v);
    }
    everywhere!(check);
}

/// The mass matrix of the double pendulum equals the textbook formula, with the inertia of geared drives added.
#[test]
fn the_double_pendulum_has_its_textbook_inertia() {
    let double = Bodies { bodies: CHAIN, ..bodies::of_two()[0].clone() };
    let mut weights = double.weights.clone();
    // The second joint is at the end of the first link, both centres on the x axes, the joints not turned.
    for zero in [3, 4, 7, 12, 13, 16] {
        weights[zero] = 0.0;
    }
    let double = Bodies { weights, ..double };
    let [one, two] = double.numbers();
    let (length, q) = (two.place[0], [0.7, -1.9]);
    let reach = two.mass * length * two.centre[0] * f64::cos(q[1]);
    let own = two.inertia + two.mass * two.centre[0].powi(2);
    let first = one.inertia + one.mass * one.centre[0].powi(2) + two.mass * length * length;
    let m11 = first + own + 2.0 * reach + one.gear.powi(2) * one.rotor + two.rotor;
    let m12 = own + reach + two.gear * two.rotor;
    let m22 = own + two.gear.powi(2) * two.rotor;
    let found = double.in_f64().hessian(&q, &[0.3, -0.2]).l_vv;
    assert_matrices_close("M", &found, &[[m11, m12], [m12, m22]], 1e-14);
}

#[test]
fn what_is_no_tree_is_refused() {
    let tree = |bodies: &[TreeBody]| BodyTree::<2>::new(bodies.iter().copied()).err();
    assert_eq!(tree(&[]), Some(TreeError::Empty));
    assert_eq!(tree(&[CHAIN[1], CHAIN[1]]), Some(TreeError::Parent { element: 0, parent: 0 }));
    let later = [CHAIN[0], body(Joint::Prismatic, Some(2)), CHAIN[0]];
    assert_eq!(tree(&later), Some(TreeError::Parent { element: 1, parent: 2 }));
    assert_eq!(tree(&CHAIN[..1]), Some(TreeError::Coordinates { found: 1, compiled: 2 }));
    assert_eq!(tree(&[CHAIN[0]; 3]), Some(TreeError::Coordinates { found: 3, compiled: 2 }));
    assert_eq!(tree(&CHAIN), None);
}

#[test]
fn a_block_takes_what_is_its_own() {
    let five = &bodies::of_five()[0];
    assert!(PlanarBodies::take(&mut &five.weights[1..], five.tree()).is_none(), "too short");
    let longer = [&five.weights[..], &[1.0, 2.0]].concat();
    let mut block = &longer[..];
    assert!(PlanarBodies::take(&mut block, five.tree()).is_some());
    assert_eq!(block, [1.0, 2.0]);
}
