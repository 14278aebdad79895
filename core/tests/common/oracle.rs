//! Properties of the energies of every family: they equal the printed formulas, and all derivatives are those of the
//! energies (checked by num-dual and finite differences). A family joins by implementing [`Learned`].

use super::dual::{self, Dual};
use super::{Random, assert_close, assert_matrices_close, assert_vectors_close};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::linear;
use leastaction_core::scalar::Scalar;

pub const EXACT: f64 = 1e-12;
/// Tolerance of central differences with [`STEP`].
const DIFFERENCES: f64 = 1e-8;
const STEP: f64 = 1e-5;

/// Learned energies of N coordinates that own their weights.
pub trait Learned<const N: usize>: Clone {
    /// Tolerance of [`Learned::naive_energies`].
    const NAIVE: f64 = EXACT;

    /// The energies of this shape over a weight block.
    type Over<'w, S: Scalar>: Lagrangian<S, N>
    where
        S::Weight: 'w,
        Self: 'w;

    fn energies_over<'w, S: Scalar>(&'w self, weights: &'w [S::Weight]) -> Self::Over<'w, S>;

    fn weights(&self) -> &[f64];

    /// T and V by the printed formulas.
    fn naive_energies(&self, q: &[f64; N], v: &[f64; N]) -> (f64, f64);

    fn energies_in_f64(&self) -> Self::Over<'_, f64> {
        self.energies_over(self.weights())
    }
}

/// Calls `check` with every model at a few states.
pub fn at_states<M, const N: usize>(models: &[M], check: impl Fn(&M, &[f64; N], &[f64; N])) {
    let mut random = Random(99);
    for model in models {
        for _ in 0..4 {
            check(model, &random.array(3.0), &random.array(2.0));
        }
    }
}

pub fn check_energies<M: Learned<N>, const N: usize>(model: &M, q: &[f64; N], v: &[f64; N]) {
    let found = model.energies_in_f64().energies(q, v);
    let (kinetic, potential) = model.naive_energies(q, v);
    assert_close("kinetic", found.kinetic, kinetic, M::NAIVE);
    assert_close("potential", found.potential, potential, EXACT);
}

pub fn check_derivatives<M: Learned<N>, const N: usize>(model: &M, q: &[f64; N], v: &[f64; N]) {
    let weights = constant_weights(model);
    check_lagrangian((&model.energies_in_f64(), &model.energies_over::<Dual>(&weights)), q, v);
}

/// Compares all derivatives with those of the same energies in [`Dual`].
pub fn check_lagrangian<const N: usize>(
    (energies, exact): (&impl Lagrangian<f64, N>, &impl Lagrangian<Dual, N>),
    q: &[f64; N],
    v: &[f64; N],
) {
    let expected = dual::derivatives(exact, q, v);
    let (g, d, h) = (energies.gradient(q, v), energies.dynamics(q, v), energies.hessian(q, v));
    for (name, l_q, l_v) in
        [("gradient", g.l_q, g.l_v), ("dynamics", d.l_q, d.l_v), ("hessian", h.l_q, h.l_v)]
    {
        assert_vectors_close(&format!("{name} l_q"), &l_q, &expected.l_q, EXACT);
        assert_vectors_close(&format!("{name} l_v"), &l_v, &expected.l_v, EXACT);
    }
    assert_matrices_close("l_qq", &h.l_qq, &expected.l_qq, EXACT);
    assert_matrices_close("l_vq", &h.l_vq, &expected.l_vq, EXACT);
    assert_matrices_close("l_vv", &h.l_vv, &expected.l_vv, EXACT);
    assert_matrices_close("mass", &d.mass, &expected.l_vv, EXACT);
    assert_vectors_close("l_vq v", &d.l_vq_v, &linear::multiply(&expected.l_vq, v), EXACT);
}

/// Compares L_q and L_v with central differences of the naive energies, without num-dual; only for models whose
/// energies are exactly these formulas.
pub fn check_first_differences<M: Learned<N>, const N: usize>(model: &M, q: &[f64; N], v: &[f64; N]) {
    let lagrangian = |q: &[f64; N], v: &[f64; N]| {
        let (kinetic, potential) = model.naive_energies(q, v);
        kinetic - potential
    };
    let found = model.energies_in_f64().gradient(q, v);
    for i in 0..N {
        let moved = |x: &[f64; N], step| linear::add_scaled(x, step, &dual::unit(i));
        let slope = |along: &dyn Fn(f64) -> f64| (along(STEP) - along(-STEP)) / (2.0 * STEP);
        assert_close("l_q", found.l_q[i], slope(&|step| lagrangian(&moved(q, step), v)), DIFFERENCES);
        assert_close("l_v", found.l_v[i], slope(&|step| lagrangian(q, &moved(v, step))), DIFFERENCES);
    }
}

pub fn check_symmetry<M: Learned<N>, const N: usize>(model: &M, q: &[f64; N], v: &[f64; N]) {
    check_second_derivatives(&model.energies_in_f64(), q, v);
}

/// Checks that second derivatives are symmetric, and that the mass matrix is positive definite.
pub fn check_second_derivatives<const N: usize>(
    energies: &impl Lagrangian<f64, N>,
    q: &[f64; N],
    v: &[f64; N],
) {
    let h = energies.hessian(q, v);
    assert_matrices_close("l_qq", &h.l_qq, &linear::transpose(&h.l_qq), 1e-14);
    assert_matrices_close("l_vv", &h.l_vv, &linear::transpose(&h.l_vv), 1e-14);
    let kinetic = linear::dot(v, &linear::multiply(&h.l_vv, v));
    assert!(kinetic > 0.0, "vᵀMv = {kinetic} at v = {v:?}");
}

/// The tests of every family; `$everywhere!(check)` calls a check at all models of one.
#[allow(unused_macros, reason = "only the tests of families use it")]
macro_rules! family_tests {
    ($everywhere:ident) => {
        #[test]
        fn energies_are_those_of_the_printed_formulas() {
            $everywhere!($crate::common::oracle::check_energies);
        }

        #[test]
        fn all_derivatives_are_those_of_the_energies() {
            $everywhere!($crate::common::oracle::check_derivatives);
        }

        #[test]
        fn second_derivatives_are_symmetric_and_the_mass_matrix_is_positive_definite() {
            $everywhere!($crate::common::oracle::check_symmetry);
        }
    };
}
#[allow(unused_imports, reason = "only the tests of families use it")]
pub(crate) use family_tests;

fn constant_weights<M: Learned<N>, const N: usize>(model: &M) -> Vec<Dual> {
    model.weights().iter().map(|w| Dual::constant(*w)).collect()
}
