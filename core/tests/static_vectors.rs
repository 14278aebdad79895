//! nalgebra's vectors and matrices carry the numbers of our arrays, rows as rows. Needs the feature `nalgebra`.
#![cfg(feature = "nalgebra")]

mod common;

use common::Random;
use common::shapes;
use leastaction_core::continuous::{self, ContinuousState};
use leastaction_core::control::riccati::{Weights, stationary};
use leastaction_core::control::{Plant, Stepped};
use leastaction_core::discrete::{Control, Del, Galerkin, State};
use leastaction_core::energy::trigonometric::CARTPOLE;
use leastaction_core::forces::{Actuator, System};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::static_vectors::{acceleration, inverse_dynamics, matrix, rows};
use nalgebra::{SMatrix, SVector};

#[test]
fn rows_stay_rows() {
    let of_rows = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]];
    let m = matrix(&of_rows);
    assert_eq!((m[(0, 2)], m[(1, 0)]), (3.0, 4.0));
    assert_eq!(rows(&m), of_rows);
    // nalgebra's own conversion reads the rows as columns.
    assert_eq!(SMatrix::<f64, 3, 2>::from(of_rows), m.transpose());
}

#[test]
fn a_learned_system_gives_the_numbers_of_its_arrays() {
    let model = &shapes::of_three()[0];
    let system = System::conservative(model.in_f64());
    let mut random = Random(9);
    let (q, v, u): ([f64; 3], [f64; 3], [f64; 3]) = (random.array(1.0), random.array(1.0), random.array(1.0));
    let [qs, vs, us] = [q, v, u].map(SVector::from);

    let a = acceleration(&system, &qs, &vs, &us).unwrap();
    assert_eq!(<[f64; 3]>::from(a), continuous::acceleration(&system, &q, &v, &u).unwrap());
    let back = inverse_dynamics(&system, &qs, &vs, &a).unwrap();
    assert!((back - us).norm() < 1e-12, "{back} {us}");

    let (h, d, g) = (
        system.lagrangian.hessian(&q, &v),
        system.lagrangian.dynamics(&q, &v),
        system.lagrangian.gradient(&q, &v),
    );
    assert_eq!(rows(&h.mass_matrix()), h.l_vv);
    assert_eq!((rows(&h.l_qq_matrix()), rows(&h.l_vq_matrix())), (h.l_qq, h.l_vq));
    assert_eq!(rows(&d.mass_matrix()), d.mass);
    assert!((d.mass_matrix() * vs - g.l_v_vector()).norm() < 1e-12);
    assert_eq!(g.l_q_vector(), SVector::from(g.l_q));
    // L_vq is not symmetric: M(q)v has this derivative along q.
    assert!((h.l_vq_matrix() * vs - SVector::from(d.l_vq_v)).norm() < 1e-12);
}

#[test]
fn states_and_controls_are_those_of_arrays() {
    let model = &shapes::of_two()[0];
    let system = System::conservative(model.in_f64());
    let (q, v, u) = ([0.3, -0.4], [0.2, 0.5], [0.1, -0.7]);
    let [qs, vs] = [q, v].map(SVector::from);
    let state = ContinuousState::from_vectors(&qs, &vs);
    assert_eq!((state.q_vector(), state.v_vector()), (qs, vs));
    let mut of_vectors = State::from_vectors(&system.lagrangian, &qs, &vs).unwrap();
    let mut of_arrays = State::new(&system.lagrangian, q, v).unwrap();
    let del = Del::<f64, Galerkin>::new(0.01);
    del.step(&system, &mut of_vectors, &Control::from(SVector::from(u))).unwrap();
    del.step(&system, &mut of_arrays, &Control::held(u)).unwrap();
    assert_eq!(of_vectors, of_arrays);
    assert_eq!(<[f64; 2]>::from(of_vectors.q_vector()), of_arrays.q());
    assert_eq!(<[f64; 2]>::from(of_vectors.p_vector()), of_arrays.p());
}

/// The regulator of a cart-pole, in nalgebra's arithmetic: P solves Riccati's equation, and every motion dies out.
#[test]
fn a_regulator_is_that_of_its_matrices() {
    let system = System::conservative(CARTPOLE);
    let del = Del::<f64, Galerkin>::new(0.01);
    let plant = Stepped { system: &system, del, actuator: Actuator::ideal(), inputs: [0], stride: 1 };
    let transition = plant.linearise_at(&[0.0; 4], (1, &[0.0])).unwrap();
    let weights = Weights { x: [10.0, 25.0, 3.0, 3.0], u: [0.7] };
    let regulator = stationary(&transition, &weights).unwrap();
    let (a, b, k, p) =
        (transition.a_matrix(), transition.b_matrix(), regulator.gain_matrix(), regulator.cost_matrix());
    assert_eq!((rows(&a), rows(&b), rows(&k)), (transition.a, transition.b, regulator.gain));
    let q = SMatrix::from_diagonal(&SVector::from(weights.x));
    let closed = a - b * k;
    assert!((p - (q + a.transpose() * p * closed)).amax() < 1e-9 * p.amax());
    assert!((SMatrix::from([weights.u]) * k - b.transpose() * p * closed).amax() < 1e-9 * k.amax());
    let fastest = |m: &SMatrix<f64, 4, 4>| m.complex_eigenvalues().map(|z| z.norm()).max();
    assert!(fastest(&closed) < 1.0 && fastest(&a) > 1.0, "{} {}", fastest(&closed), fastest(&a));
}
