//! Forces Q(q, v, τ): derivatives, sums, dissipation, inverse dynamics.

use crate::common::dual::{Dual, unit};
use crate::common::forces::{LoadFriction, all, coulomb, directional, dry, sticking};
use crate::common::{Random, assert_matrices_close, assert_vectors_close, graphs, shapes, trees};
use leastaction_core::continuous::{acceleration, inverse_dynamics};
use leastaction_core::discrete::StepError;
use leastaction_core::energy::trigonometric::CARTPOLE;
use leastaction_core::forces::{Forces, System, Viscous};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::linear::{Matrix, dot};

/// ∂Q/∂q, ∂Q/∂v, ∂Q/∂τ by dual numbers.
fn derivatives<F: Forces<Dual, N>, const N: usize>(
    law: &F,
    [q, v, tau]: [[f64; N]; 3],
) -> [Matrix<f64, N>; 3] {
    let moving = |x: [f64; N], along: [f64; N]| {
        core::array::from_fn::<_, N, _>(|i| Dual::moving(x[i], [along[i], 0.0]))
    };
    let still = [0.0; N];
    [0, 1, 2].map(|of| {
        let columns: [[f64; N]; N] = core::array::from_fn(|j| {
            let along = |which| if which == of { unit(j) } else { still };
            let (q, v, tau) = (moving(q, along(0)), moving(v, along(1)), moving(tau, along(2)));
            law.force(&q, &v, &tau).map(|force| force.0.eps1)
        });
        core::array::from_fn(|i| core::array::from_fn(|j| columns[j][i]))
    })
}

pub fn check_derivatives<F, G, const N: usize>(name: &str, law: F, dual: &G, seed: u64)
where
    F: Forces<f64, N>,
    G: Forces<Dual, N>,
{
    let mut random = Random(seed);
    for _ in 0..20 {
        let point = [random.array(2.0), random.array(2.0), random.array(4.0)];
        let [q, v, tau] = point;
        let [in_q, in_v, in_tau] = derivatives(dual, point);
        let (found_q, found_v) = law.derivatives(&q, &v, &tau);
        assert_matrices_close(&format!("{name}, q"), &found_q, &in_q, 1e-14);
        assert_matrices_close(&format!("{name}, v"), &found_v, &in_v, 1e-14);
        assert_matrices_close(&format!("{name}, τ"), &law.load_derivative(&q, &v, &tau), &in_tau, 1e-14);
        let numbers = [in_q, in_v, in_tau].map(|matrix| matrix.concat()).concat();
        assert!(numbers.iter().any(|x| *x != 0.0), "{name} has derivatives");
    }
}

#[test]
fn derivatives_are_those_of_dual_numbers() {
    fn check<const N: usize>(seed: u64) {
        let (law, dual) = (all::<f64, N>(), all::<Dual, N>());
        check_derivatives("viscous", law.0, &dual.0, seed);
        check_derivatives("friction", law.1.0, &dual.1.0, seed);
        check_derivatives::<_, _, N>("coupling", law.1.1, &dual.1.1, seed);
        check_derivatives("all", law, &dual, seed);
        check_derivatives("dry friction", coulomb::<f64, N>(), &coulomb::<Dual, N>(), seed);
        check_derivatives("friction by direction", directional::<f64, N>(), &directional::<Dual, N>(), seed);
        check_derivatives("friction that sticks", sticking::<f64, N>(), &sticking::<Dual, N>(), seed);
        check_derivatives("damping and dry friction", dry::<f64, N>(), &dry::<Dual, N>(), seed);
        let reference = &law;
        check_derivatives("a reference", reference, &dual, seed);
    }
    check::<1>(1);
    check::<2>(2);
    check::<3>(3);
}

/// All entries of ∂Q/∂x of the combined laws differ from each other, so no index can be mistaken for another.
#[test]
fn no_derivative_is_that_of_another_place() {
    let [q, v, tau] = [[0.3, 0.8, -1.1], [1.4, -0.6, 0.9], [2.0, -1.3, 0.7]];
    let mut entries: Vec<f64> = derivatives(&all::<Dual, 3>(), [q, v, tau])
        .into_iter()
        .flat_map(|matrix| matrix.concat())
        .filter(|x| *x != 0.0)
        .collect();
    entries.sort_by(f64::total_cmp);
    assert!(entries.len() >= 15 && entries.windows(2).all(|pair| pair[1] - pair[0] > 1e-6), "{entries:?}");
}

/// Two laws together give the sum of their forces, in either order and nested either way.
#[test]
fn a_pair_is_the_sum_of_its_laws() {
    let (viscous, (friction, coupling)) = all::<f64, 3>();
    let mut random = Random(5);
    let [q, v, tau] = [random.array(2.0), random.array(2.0), random.array(4.0)];
    let sum = |laws: [[f64; 3]; 3]| core::array::from_fn(|i| laws.iter().map(|law| law[i]).sum::<f64>());
    let expected =
        sum([viscous.force(&q, &v, &tau), friction.force(&q, &v, &tau), coupling.force(&q, &v, &tau)]);
    let nested = ((viscous, friction), coupling);
    let turned = (coupling, (friction, viscous));
    let found = [all().force(&q, &v, &tau), nested.force(&q, &v, &tau), turned.force(&q, &v, &tau)];
    for found in found {
        assert_vectors_close("Q", &found, &expected, 1e-15);
    }
    let (_, [in_q, in_v, in_tau]) = ((), derivatives(&all::<Dual, 3>(), [q, v, tau]));
    let (found_q, found_v) = turned.derivatives(&q, &v, &tau);
    assert_matrices_close("q", &found_q, &in_q, 1e-14);
    assert_matrices_close("v", &found_v, &in_v, 1e-14);
    assert_matrices_close("τ", &nested.load_derivative(&q, &v, &tau), &in_tau, 1e-14);
}

#[test]
fn damping_and_friction_only_dissipate() {
    let mut random = Random(6);
    for _ in 0..10_000 {
        let (q, v, tau) = (random.array::<3>(10.0), random.array::<3>(10.0), random.array::<3>(20.0));
        let coefficients = random.array(3.0).map(f64::abs);
        let laws = (Viscous { coefficients }, LoadFriction { c: random.array(1.0).map(f64::abs) });
        for power in [laws.0.force(&q, &v, &tau), laws.1.force(&q, &v, &tau), laws.force(&q, &v, &tau)] {
            assert!(dot(&power, &v) <= 0.0, "{power:?} · {v:?}");
        }
        assert!(v.iter().all(|v| *v != 0.0) && dot(&laws.0.force(&q, &v, &tau), &v) < 0.0);
    }
}

// ---- Acceleration and inverse dynamics ----

/// M a − L_q + L_vq v = τ + Q(q, v, τ).
fn check_inverse<L: Lagrangian<f64, N>, const N: usize>(lagrangian: L) {
    check_inverse_under(&lagrangian, all());
    check_inverse_under_dry_friction(&lagrangian);
}

fn check_inverse_under_dry_friction<L: Lagrangian<f64, N>, const N: usize>(lagrangian: &L) {
    let (viscous, coulomb) = dry();
    check_inverse_under(lagrangian, (viscous, coulomb));
    check_inverse_under(lagrangian, (coulomb, viscous));
}

pub fn check_inverse_under<L: Lagrangian<f64, N>, F: Forces<f64, N>, const N: usize>(
    lagrangian: &L,
    forces: F,
) {
    let mut random = Random(12);
    let system = System { lagrangian, forces };
    for _ in 0..20 {
        let (q, v, tau) = (random.array(2.0), random.array(2.0), random.array(5.0));
        let a = acceleration(&system, &q, &v, &tau).unwrap();
        let d = system.lagrangian.dynamics(&q, &v);
        let force = system.forces.force(&q, &v, &tau);
        let left: [f64; N] = core::array::from_fn(|i| dot(&d.mass[i], &a) - d.l_q[i] + d.l_vq_v[i]);
        assert_vectors_close("the equation", &left, &core::array::from_fn(|i| tau[i] + force[i]), 1e-12);
        // Size of the terms that cancel.
        let sizes = d.mass.map(|row| row.iter().zip(&a).map(|(m, a)| (m * a).abs()).sum::<f64>());
        let size = sizes.into_iter().fold(1.0, f64::max);
        assert_vectors_close("τ", &inverse_dynamics(&system, &q, &v, &a).unwrap(), &tau, 1e-12 * size);
    }
}

#[test]
fn inverse_dynamics_inverts_acceleration_also_where_friction_sees_the_load() {
    shapes::for_each_model!(check_inverse);
    for tree in trees::of_three() {
        check_inverse_under_dry_friction(&tree.in_f64());
    }
    check_inverse_under_dry_friction(&graphs::FixedModel::<2, 8>(graphs::flat()).in_f64());
}

/// A law that cancels the control: no force has any effect.
#[derive(Clone, Copy)]
struct Cancelled;

impl<const N: usize> Forces<f64, N> for Cancelled {
    fn force(&self, _: &[f64; N], _: &[f64; N], tau: &[f64; N]) -> [f64; N] {
        tau.map(|tau| -tau)
    }

    fn derivatives(&self, _: &[f64; N], _: &[f64; N], _: &[f64; N]) -> (Matrix<f64, N>, Matrix<f64, N>) {
        ([[0.0; N]; N], [[0.0; N]; N])
    }

    fn load_derivative(&self, _: &[f64; N], _: &[f64; N], _: &[f64; N]) -> Matrix<f64, N> {
        core::array::from_fn(|i| unit::<N>(i).map(|x| -x))
    }
}

#[test]
fn a_control_without_effect_cannot_be_found() {
    let system = System { lagrangian: CARTPOLE, forces: Cancelled };
    let found = inverse_dynamics(&system, &[0.1, 0.2], &[0.3, 0.4], &[1.0, 2.0]);
    assert_eq!(found, Err(StepError::Singular { column: 0 }));
}
