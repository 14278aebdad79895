//! Trees of rigid bodies in space against the point masses that they are made of and exact derivatives.

use crate::common::arms::{self, Arm};
use crate::common::dual::Dual;
use crate::common::oracle::{at_states, check_lagrangian, check_second_derivatives};
use crate::common::{Random, assert_close, assert_matrices_close, assert_vectors_close};
use leastaction_core::continuous::{acceleration, inverse_dynamics};
use leastaction_core::energy::arm::{
    ARM_GRAVITY_PARAMETERS, ARM_PARAMETERS, ArmBodies, ArmParameters, BodyInertia,
};
use leastaction_core::forces::{System, Viscous};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::linear::{self, SolveError};
use leastaction_core::scalar::{LANES, Lanes};

macro_rules! everywhere {
    ($check:path) => {
        at_states(&arms::of_one(), $check);
        at_states(&arms::of_three(), $check);
        at_states(&[arms::chain_of_seven()], $check);
        at_states(&[arms::branched(), arms::along_z()], $check);
    };
}

#[test]
fn energies_are_those_of_the_point_masses() {
    fn check<const N: usize>(arm: &Arm<N>, q: &[f64; N], v: &[f64; N]) {
        let found = arm.in_f64().energies(q, v);
        let (kinetic, potential) = arm.naive_energies(q, v);
        // Velocities are differences in the naive energies.
        assert_close("kinetic", found.kinetic, kinetic, 1e-8);
        assert_close("potential", found.potential, potential, 1e-13);
    }
    everywhere!(check);
}

#[test]
fn all_derivatives_are_those_of_the_energies() {
    fn check<const N: usize>(arm: &Arm<N>, q: &[f64; N], v: &[f64; N]) {
        let weights: Vec<Dual> = arm.weights.iter().map(|w| Dual::constant(*w)).collect();
        check_lagrangian((&arm.in_f64(), &arm.over(&weights)), q, v);
    }
    everywhere!(check);
}

#[test]
fn what_a_step_needs_is_part_of_the_hessian() {
    fn check<const N: usize>(arm: &Arm<N>, q: &[f64; N], v: &[f64; N]) {
        let arm = arm.in_f64();
        assert_eq!(arm.linearization(q, v), arm.hessian(q, v).into());
    }
    everywhere!(check);
}

#[test]
fn second_derivatives_are_symmetric_and_the_mass_matrix_is_positive_definite() {
    fn check<const N: usize>(arm: &Arm<N>, q: &[f64; N], v: &[f64; N]) {
        check_second_derivatives(&arm.in_f64(), q, v);
    }
    everywhere!(check);
}

/// The recursion of Newton and Euler against the Euler–Lagrange equation, whose terms the duals confirm.
#[test]
fn inverse_dynamics_is_the_equation_of_motion() {
    fn check<const N: usize>(arm: &Arm<N>, q: &[f64; N], v: &[f64; N]) {
        let a: [f64; N] = Random(7).array(4.0);
        let (bodies, still) = (arm.in_f64(), [0.0; N]);
        let d = bodies.dynamics(q, v);
        let inertial = linear::multiply(&d.mass, &a);
        let expected = core::array::from_fn(|i| inertial[i] + d.l_vq_v[i] - d.l_q[i]);
        assert_vectors_close("inverse dynamics", &bodies.inverse_dynamics(q, v, &a), &expected, 1e-12);
        let held = bodies.gravity_torque(q);
        assert_vectors_close("gravity", &held, &bodies.inverse_dynamics(q, &still, &still), 1e-12);
        assert_vectors_close("gravity", &held, &bodies.gradient(q, &still).l_q.map(|l_q| -l_q), 1e-12);
        assert_matrices_close("M", &bodies.mass_matrix(q), &d.mass, 1e-13);
    }
    everywhere!(check);
}

#[test]
fn acceleration_and_inverse_dynamics_invert_each_other() {
    fn check<const N: usize>(arm: &Arm<N>, q: &[f64; N], v: &[f64; N]) {
        let tau: [f64; N] = Random(8).array(5.0);
        let viscous = Viscous { coefficients: core::array::from_fn(|i| 0.1 * i as f64) };
        let system = System { lagrangian: arm.in_f64(), forces: viscous };
        let a = acceleration(&system, q, v, &tau).unwrap();
        assert_vectors_close("τ", &inverse_dynamics(&system, q, v, &a).unwrap(), &tau, 1e-10);
        let bodies = core::array::from_fn(|i| tau[i] - system.forces.coefficients[i] * v[i]);
        assert_vectors_close("τ", &system.lagrangian.inverse_dynamics(q, v, &a), &bodies, 1e-10);
    }
    everywhere!(check);
}

/// Elimination from the tips against elimination with pivots, the acceleration of the solvers included, and states side by side against states
/// alone.
#[test]
fn forward_dynamics_solves_the_equation_of_motion() {
    fn check<const N: usize>(arm: &Arm<N>, q: &[f64; N], v: &[f64; N]) {
        let (bodies, force): (_, [f64; N]) = (arm.in_f64(), Random(9).array(5.0));
        let d = bodies.dynamics(q, v);
        let right = core::array::from_fn(|i| force[i] + d.l_q[i] - d.l_vq_v[i]);
        let expected = linear::solve(d.mass, right).unwrap();
        assert_vectors_close("v̇", &bodies.forward_dynamics(q, v, &force), &expected, 1e-10);
        let scaled = |x: &[f64; N], lane: usize| x.map(|x| x * (1.0 - 0.21 * lane as f64));
        let lanes = |x: &[f64; N]| -> [Lanes; N] {
            core::array::from_fn(|i| Lanes(core::array::from_fn(|lane| scaled(x, lane)[i])))
        };
        let together = bodies.forward_dynamics(&lanes(q), &lanes(v), &lanes(&force));
        for lane in 0..LANES {
            let [q, v, force] = [q, v, &force].map(|x| scaled(x, lane));
            let alone = bodies.forward_dynamics(&q, &v, &force);
            assert_eq!(together.map(|x| x.0[lane].to_bits()), alone.map(f64::to_bits));
        }
    }
    everywhere!(check);
}

#[test]
fn an_arm_without_masses_has_no_acceleration() {
    let mut arm = arms::chain_of_seven();
    for body in arm.weights[3..].chunks_exact_mut(ARM_PARAMETERS) {
        body[15..].fill(0.0);
    }
    let system = System { lagrangian: arm.in_f64(), forces: Viscous { coefficients: [0.0; 7] } };
    let refused = acceleration(&system, &[0.1; 7], &[0.2; 7], &[1.0; 7]);
    assert_eq!(refused, Err(SolveError::Singular { column: 6 }));
    let massive = arms::chain_of_seven();
    let system = System { lagrangian: massive.in_f64(), forces: Viscous { coefficients: [0.0; 7] } };
    for (q, tau) in [([f64::NAN; 7], [1.0; 7]), ([0.1; 7], [f64::INFINITY; 7])] {
        assert_eq!(acceleration(&system, &q, &[0.2; 7], &tau), Err(SolveError::NotFinite));
    }
}

/// Joints without mass and rotor at two tips.
#[test]
fn a_joint_that_carries_nothing_is_named() {
    for k in [9, 11] {
        let mut arm = arms::along_z();
        let start = ARM_GRAVITY_PARAMETERS + k * ARM_PARAMETERS;
        arm.weights[start + 15..start + ARM_PARAMETERS].fill(0.0);
        let system = System { lagrangian: arm.in_f64(), forces: Viscous { coefficients: [0.0; 12] } };
        let refused = acceleration(&system, &[0.1; 12], &[0.2; 12], &[1.0; 12]);
        assert_eq!(refused, Err(SolveError::Singular { column: k as u8 }));
    }
}

/// An axis that is almost the z axis takes the way for all axes, and gives almost the same.
#[test]
fn both_ways_of_turning_agree() {
    fn check<const N: usize>(arm: &Arm<N>, q: &[f64; N], v: &[f64; N]) {
        let mut near = arm.clone();
        for body in near.weights[ARM_GRAVITY_PARAMETERS..].chunks_exact_mut(ARM_PARAMETERS) {
            assert_eq!(body[12..14], [0.0; 2]);
            body[12] = 1e-200;
        }
        let a: [f64; N] = Random(12).array(4.0);
        let (arm, near) = (arm.in_f64(), near.in_f64());
        let expected = near.inverse_dynamics(q, v, &a);
        assert_vectors_close("inverse dynamics", &arm.inverse_dynamics(q, v, &a), &expected, 1e-13);
        assert_matrices_close("M", &arm.mass_matrix(q), &near.mass_matrix(q), 1e-13);
    }
    at_states(&[arms::along_z()], check);
}

#[test]
fn derivatives_of_inverse_dynamics_are_exact() {
    fn check<const N: usize>(arm: &Arm<N>, q: &[f64; N], v: &[f64; N]) {
        let a: [f64; N] = Random(11).array(4.0);
        let found = arm.in_f64().inverse_dynamics_derivatives(q, v, &a);
        let weights: Vec<Dual> = arm.weights.iter().map(|w| Dual::constant(*w)).collect();
        let exact = arm.over(&weights);
        for j in 0..N {
            let moving = |x: &[f64; N], axis: usize| -> [Dual; N] {
                core::array::from_fn(|i| Dual::moving(x[i], [0, 1].map(|k| f64::from(i == j && k == axis))))
            };
            let force = exact.inverse_dynamics(&moving(q, 0), &moving(v, 1), &moving(&a, 2));
            for (i, force) in force.iter().enumerate() {
                assert_close(&format!("∂τ_{i}/∂q_{j}"), found.force_q[i][j], force.0.eps1, 1e-12);
                assert_close(&format!("∂τ_{i}/∂v_{j}"), found.force_v[i][j], force.0.eps2, 1e-12);
            }
        }
    }
    everywhere!(check);
}

/// Compares f32, over numbers rounded to it, with f64 over the same numbers.
#[test]
fn single_precision_is_near() {
    fn check<const N: usize>(arm: &Arm<N>, q: &[f64; N], v: &[f64; N]) {
        let (single, a) = (arm.single(), Random(9).array::<N>(4.0));
        let [q, v, a] = [q, v, &a].map(|x| x.map(|x| x as f32));
        let [q64, v64, a64] = [q, v, a].map(|x| x.map(f64::from));
        let wide: Vec<f64> = single.iter().map(|w| f64::from(*w)).collect();
        let (found, exact) = (arm.over(&single), arm.over(&wide));
        let size = |x: &[f64; N]| x.iter().fold(1.0, |most: f64, x| most.max(x.abs()));
        let expected = exact.inverse_dynamics(&q64, &v64, &a64);
        let off = linear::add_scaled(&found.inverse_dynamics(&q, &v, &a).map(f64::from), -1.0, &expected);
        assert!(size(&off.map(|x| 1e6 * x)) <= 4.0 * size(&expected), "{off:?} of {expected:?}");
        let (rows, exact) = (found.mass_matrix(&q), exact.mass_matrix(&q64));
        for (row, exact) in rows.iter().zip(&exact) {
            let off = linear::add_scaled(&row.map(f64::from), -1.0, exact);
            assert!(size(&off.map(|x| 1e6 * x)) <= 4.0 * size(exact), "{off:?} of {exact:?}");
        }
    }
    everywhere!(check);
}

#[test]
fn numbers_keep_their_order() {
    let numbers = core::array::from_fn(|i| i as f64);
    let body = ArmParameters::from_array(numbers);
    assert_eq!(body.into_array(), numbers);
    assert_eq!(
        (body.rotation[1], body.place, body.axis),
        ([3.0, 4.0, 5.0], [9.0, 10.0, 11.0], [12.0, 13.0, 14.0])
    );
    let inertia =
        BodyInertia { mass: 15.0, moment: [16.0, 17.0, 18.0], matrix: [19.0, 20.0, 21.0, 22.0, 23.0, 24.0] };
    assert_eq!((body.inertia, body.rotor), (inertia, 25.0));
    assert_eq!(inertia.into_array(), core::array::from_fn(|i| 15.0 + i as f64));
}

#[test]
fn a_block_takes_what_is_its_own() {
    let arm = arms::chain_of_seven();
    assert!(ArmBodies::take(&mut &arm.weights[1..], arm.tree()).is_none(), "too short");
    let longer = [&arm.weights[..], &[1.0, 2.0]].concat();
    let mut block = &longer[..];
    assert!(ArmBodies::take(&mut block, arm.tree()).is_some());
    assert_eq!(block, [1.0, 2.0]);
}
