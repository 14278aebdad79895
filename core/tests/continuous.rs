//! Acceleration, inverse dynamics, energy.

mod common;

use common::{Random, assert_close, assert_vectors_close, shapes};
use leastaction_core::continuous::{
    ContinuousState, acceleration, energy, inverse_dynamics, momentum, rk4_step,
};
use leastaction_core::energy::trigonometric::{ACROBOT, CARTPOLE, PENDULUM};
use leastaction_core::forces::{System, Viscous};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::linear::SolveError;

fn check_inverse<L, const N: usize>(lagrangian: L)
where
    L: Lagrangian<f64, N>,
{
    let mut random = Random(12);
    let forces = Viscous { coefficients: core::array::from_fn(|i| 0.1 + 0.2 * i as f64) };
    let system = System { lagrangian, forces };
    for _ in 0..10 {
        let (q, v, u) = (random.array(3.0), random.array(2.0), random.array(5.0));
        let a = acceleration(&system, &q, &v, &u).unwrap();
        assert_vectors_close("u", &inverse_dynamics(&system, &q, &v, &a).unwrap(), &u, 1e-12);
    }
}

#[test]
fn inverse_dynamics_inverts_acceleration() {
    check_inverse(PENDULUM);
    check_inverse(CARTPOLE);
    check_inverse(ACROBOT);
    shapes::of_one().iter().for_each(|model| check_inverse(model.in_f64()));
    shapes::of_two().iter().for_each(|model| check_inverse(model.in_f64()));
    shapes::of_three().iter().for_each(|model| check_inverse(model.in_f64()));
}

/// The Euler–Lagrange equation itself: d/dt L_v = L_q + Q + u along the motion that the acceleration gives.
#[test]
fn momentum_changes_by_the_force() {
    const STEP: f64 = 1e-5;
    let model = &shapes::of_three()[0];
    let system = System { lagrangian: model.in_f64(), forces: Viscous { coefficients: [0.3, 0.0, 0.8] } };
    let (q, v, u) = ([0.4, -0.9, 1.7], [1.1, 0.6, -0.8], [0.5, -1.5, 2.5]);
    let a = acceleration(&system, &q, &v, &u).unwrap();
    let p = |t: f64| {
        let q = core::array::from_fn(|i| q[i] + t * v[i] + 0.5 * t * t * a[i]);
        momentum(&system.lagrangian, &q, &core::array::from_fn(|i| v[i] + t * a[i]))
    };
    let (late, early) = (p(STEP), p(-STEP));
    let l_q = system.lagrangian.gradient(&q, &v).l_q;
    for i in 0..3 {
        let force = l_q[i] - system.forces.coefficients[i] * v[i] + u[i];
        assert_close("dp/dt", (late[i] - early[i]) / (2.0 * STEP), force, 1e-7);
    }
}

#[test]
fn energy_is_conserved_without_forces_and_falls_with_damping() {
    let start = ContinuousState { q: [2.0, -1.0], v: [1.0, 2.0] };
    let run = |coefficients: [f64; 2]| {
        let system = System { lagrangian: ACROBOT, forces: Viscous { coefficients } };
        let mut state = start;
        for _ in 0..2_000 {
            state = rk4_step(&system, &state, &[0.0; 2], 1e-3).unwrap();
        }
        energy(&ACROBOT, &state.q, &state.v)
    };
    let initial = energy(&ACROBOT, &start.q, &start.v);
    assert_close("energy", run([0.0; 2]), initial, 1e-9);
    assert!(run([0.5, 0.5]) < initial - 0.5);
}

#[test]
fn a_singular_mass_matrix_is_an_error() {
    const NO_MASS: leastaction_core::energy::trigonometric::Trigonometric<'static, 2> =
        leastaction_core::energy::trigonometric::Trigonometric { inertia: &[], potential: &[] };
    let system = System::<_, Viscous<f64, 2>>::conservative(NO_MASS);
    assert_eq!(
        acceleration(&system, &[0.0; 2], &[0.0; 2], &[0.0; 2]),
        Err(SolveError::Singular { column: 0 })
    );
}
