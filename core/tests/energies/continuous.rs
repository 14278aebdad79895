//! Acceleration, inverse dynamics, energy.

use crate::common::{Random, assert_close, assert_vectors_close, shapes};
use leastaction_core::constraints::ConstraintError;
use leastaction_core::continuous::{
    ContinuousState, acceleration, energy, inverse_dynamics, midpoint_step, momentum, rk4_step,
};
use leastaction_core::discrete::rattle::{ParticleState, Rattle};
use leastaction_core::discrete::{Del, Galerkin, State, StepError};
use leastaction_core::energy::trigonometric::{ACROBOT, CARTPOLE, Trigonometric};
use leastaction_core::forces::{System, Viscous};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::linear::SolveError;
use leastaction_core::model::{GraphModel, InertiaNetworkModel, ModularModel};

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
    shapes::for_each_model!(check_inverse);
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

/// NaN is an error wherever it enters, not a result.
#[test]
fn what_is_not_finite_is_refused() {
    let system = System::conservative(CARTPOLE);
    let (q, v, zero) = ([0.2, 1.3], [0.5, -0.7], [0.0; 2]);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for wrong in [[bad, 0.0], [0.0, bad]] {
            let state = ContinuousState { q, v };
            assert_eq!(acceleration(&system, &q, &v, &wrong), Err(SolveError::NotFinite));
            assert_eq!(acceleration(&system, &q, &wrong, &zero), Err(SolveError::NotFinite));
            assert_eq!(acceleration(&system, &[0.0, bad], &v, &zero), Err(SolveError::NotFinite));
            assert_eq!(inverse_dynamics(&system, &q, &v, &wrong), Err(StepError::NotFinite));
            for step in [rk4_step, midpoint_step] {
                assert_eq!(step(&system, &state, &wrong, 0.01), Err(SolveError::NotFinite));
                assert_eq!(step(&system, &state, &zero, bad), Err(SolveError::NotFinite));
            }
        }
    }
}

#[test]
fn everything_of_a_loop_can_move_to_another_thread() {
    fn moves<T: Send + Sync>() {}
    moves::<ContinuousState<f32, 2>>();
    moves::<State<f32, 2>>();
    moves::<Del<f32, Galerkin>>();
    moves::<Rattle<f32>>();
    moves::<ParticleState<'_, f32, 2>>();
    moves::<System<Trigonometric<'_, 2>, Viscous<f32, 2>>>();
    moves::<System<InertiaNetworkModel<'_, 2, 8, 2>, Viscous<f32, 2>>>();
    moves::<ModularModel<'_, 2, 1, 8, 2>>();
    moves::<GraphModel<'_, 2, 1, 8, 2>>();
    moves::<StepError<f32>>();
    moves::<ConstraintError<f32>>();
}
