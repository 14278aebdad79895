//! Inertia networks against their printed formulas, exact derivatives, and finite differences.

use crate::common::oracle::{self, at_states};
use crate::common::shapes::{self, Model};
use leastaction_core::lagrangian::Lagrangian;

/// One generic check at all models of all sizes.
macro_rules! everywhere {
    ($check:path) => {
        at_states(&shapes::of_one(), $check);
        at_states(&shapes::of_two(), $check);
        at_states(&shapes::of_three(), $check);
    };
}

oracle::family_tests!(everywhere);

#[test]
fn first_derivatives_are_the_finite_differences() {
    everywhere!(oracle::check_first_differences);
}

#[test]
fn nothing_depends_on_a_cyclic_coordinate() {
    fn check<const N: usize>(model: &Model<N>, q: &[f64; N], v: &[f64; N]) {
        let inertia_network = model.in_f64();
        let mut moved = *q;
        for (i, kind) in model.coordinates.iter().enumerate() {
            if *kind == shapes::Cyclic {
                moved[i] += 17.0;
                assert_eq!(inertia_network.gradient(q, v).l_q[i].abs(), 0.0);
            }
        }
        assert_eq!(inertia_network.hessian(q, v), inertia_network.hessian(&moved, v));
    }
    everywhere!(check);
}

#[test]
fn a_block_that_does_not_fit_is_refused() {
    let model = &shapes::of_two()[0];
    let shape = model.shape();
    let mut short = &model.weights[1..];
    assert!(
        leastaction_core::energy::inertia_network::InertiaNetwork::<f64, 2, 13, 3>::take(&mut short, &shape)
            .is_none()
    );
    let mut block = &model.weights[..];
    assert!(
        leastaction_core::energy::inertia_network::InertiaNetwork::<f64, 2, 6, 3>::take(&mut block, &shape)
            .is_none(),
        "too wide"
    );
    let mut block = &model.weights[..];
    assert!(
        leastaction_core::energy::inertia_network::InertiaNetwork::<f64, 2, 13, 1>::take(&mut block, &shape)
            .is_none(),
        "too deep"
    );
}
