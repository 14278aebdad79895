//! Columns of inertial numbers and of coefficients of friction, against the momentum and the forces of systems with other numbers.

use crate::common::arms::{self, Arm};
use crate::common::bodies::{self, Bodies};
use crate::common::oracle::at_states;
use crate::common::{assert_vectors_close, forces};
use leastaction_core::energy::arm::{ARM_GRAVITY_PARAMETERS, ARM_PARAMETERS, INERTIAL_PARAMETERS};
use leastaction_core::energy::bodies::{
    BODY_PARAMETERS, BodyParameters, GRAVITY_PARAMETERS, PLANAR_INERTIAL_PARAMETERS, PlanarInertia,
};
use leastaction_core::forces::{Coefficient, Forces, Viscous};
use leastaction_core::lagrangian::{Column, Gradient, Lagrangian};
use leastaction_core::linear::add_scaled;

/// Compares the columns of a body with the differences that one more of each of its numbers makes; L is linear in them.
fn check_columns<L: Lagrangian<f64, N>, const K: usize, const N: usize>(
    lagrangian: &L,
    body: usize,
    (q, v): (&[f64; N], &[f64; N]),
    with_one_more: impl Fn(usize) -> Gradient<f64, N>,
) {
    let mut columns = [Column::zero(); K];
    assert_eq!(lagrangian.inertial_columns(body, q, v, &mut columns), K);
    let before = lagrangian.gradient(q, v);
    for (j, column) in columns.iter().enumerate() {
        let after = with_one_more(j);
        let name = |what: &str| format!("{what} of number {j} of body {body}");
        let momentum = add_scaled(&after.l_v, -1.0, &before.l_v);
        assert_vectors_close(&name("momentum"), &column.momentum, &momentum, 1e-11);
        let force = add_scaled(&after.l_q, -1.0, &before.l_q);
        assert_vectors_close(&name("L_q"), &column.force, &force, 1e-11);
    }
}

#[test]
fn columns_of_a_body_in_space_are_differences() {
    fn check<const N: usize>(arm: &Arm<N>, q: &[f64; N], v: &[f64; N]) {
        for body in 0..N {
            let first =
                ARM_GRAVITY_PARAMETERS + body * ARM_PARAMETERS + ARM_PARAMETERS - 1 - INERTIAL_PARAMETERS;
            check_columns::<_, INERTIAL_PARAMETERS, N>(&arm.in_f64(), body, (q, v), |j| {
                let mut weights = arm.weights.clone();
                weights[first + j] += 1.0;
                arm.over(&weights).gradient(q, v)
            });
        }
    }
    at_states(&arms::of_one(), check);
    at_states(&arms::of_three(), check);
    at_states(&[arms::chain_of_seven()], check);
    at_states(&[arms::branched()], check);
}

#[test]
fn columns_of_a_body_in_the_plane_are_differences() {
    fn check<const N: usize>(bodies: &Bodies<N>, q: &[f64; N], v: &[f64; N]) {
        for (body, numbers) in bodies.numbers().into_iter().enumerate() {
            check_columns::<_, PLANAR_INERTIAL_PARAMETERS, N>(&bodies.in_f64(), body, (q, v), |j| {
                let mut inertia = PlanarInertia::of_body(&numbers).into_array();
                inertia[j] += 1.0;
                let changed = PlanarInertia::from_array(inertia).given_to(&numbers);
                let mut weights = bodies.weights.clone();
                let first = GRAVITY_PARAMETERS + body * BODY_PARAMETERS;
                weights[first..first + BODY_PARAMETERS].copy_from_slice(&changed.into_array());
                bodies.over(&weights).gradient(q, v)
            });
        }
    }
    at_states(&bodies::of_one(), check);
    at_states(&bodies::of_two(), check);
    at_states(&bodies::of_five(), check);
}

#[test]
fn bodies_that_are_not_there_have_no_columns() {
    let mut columns = [Column { momentum: [1.0; 3], force: [1.0; 3] }; 2];
    let arm = &arms::of_three()[0];
    assert_eq!(arm.in_f64().inertial_columns(3, &[0.1; 3], &[0.2; 3], &mut columns), 0);
}

#[test]
fn planar_inertia_is_given_back() {
    let body = BodyParameters::from_array([0.3, -0.2, 0.4, 1.7, 0.25, -0.15, 0.03, 0.001, 5.0]);
    let again = PlanarInertia::of_body(&body).given_to(&body);
    assert_vectors_close("numbers", &again.into_array(), &body.into_array(), 1e-14);
}

/// Force of a law with one more of a coefficient, minus its force.
fn difference<F: Forces<f64, 3> + Clone>(law: &F, more: impl FnOnce(&mut F), v: &[f64; 3]) -> [f64; 3] {
    let (q, tau, mut changed) = ([0.3, 0.1, -0.4], [1.2, -0.7, 0.3], law.clone());
    more(&mut changed);
    add_scaled(&changed.force(&q, v, &tau), -1.0, &law.force(&q, v, &tau))
}

#[test]
fn slopes_of_coefficients_are_differences() {
    let v = [0.7, -0.04, -1.3];
    let close = |name, law: &dyn Forces<f64, 3>, coefficient, expected: [f64; 3]| {
        assert_vectors_close(name, &law.slopes(coefficient, &v), &expected, 1e-14);
        assert!(expected.iter().all(|slope| *slope != 0.0));
    };
    let viscous = Viscous { coefficients: [0.2, 0.3, 0.5] };
    let more = difference(&viscous, |law| law.coefficients.iter_mut().for_each(|c| *c += 1.0), &v);
    close("viscous", &viscous, Coefficient::Viscous, more);
    let coulomb = forces::coulomb::<f64, 3>();
    let more = difference(&coulomb, |law| law.coordinates.iter_mut().for_each(|of| of.constant += 1.0), &v);
    close("Coulomb", &coulomb, Coefficient::Coulomb, more);
    let directional = forces::directional::<f64, 3>();
    let more =
        difference(&directional, |law| law.coordinates.iter_mut().for_each(|of| of.constant += 1.0), &v);
    close("dry, by direction", &directional, Coefficient::Directional, more);
    let more =
        difference(&directional, |law| law.coordinates.iter_mut().for_each(|of| of.viscous += 1.0), &v);
    close("viscous, by direction", &directional, Coefficient::DirectionalViscous, more);
    let sticking = forces::sticking::<f64, 3>();
    let more = difference(&sticking, |law| law.coordinates.iter_mut().for_each(|of| of.constant += 1.0), &v);
    close("sticking", &sticking, Coefficient::Sticking, more);
    let both = (viscous, (coulomb, sticking));
    for coefficient in [Coefficient::Viscous, Coefficient::Coulomb, Coefficient::Sticking] {
        let alone = add_scaled(&viscous.slopes(coefficient, &v), 1.0, &coulomb.slopes(coefficient, &v));
        let alone = add_scaled(&alone, 1.0, &sticking.slopes(coefficient, &v));
        assert_eq!(both.slopes(coefficient, &v), alone);
    }
}
