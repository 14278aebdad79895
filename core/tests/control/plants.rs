//! A mechanism as a plant.

use crate::common::{assert_close, forces, shapes};
use leastaction_core::continuous::inverse_dynamics;
use leastaction_core::control::{Plant, Stepped, Transition};
use leastaction_core::discrete::{Del, Galerkin, Midpoint, Newton, Path, StepError};
use leastaction_core::energy::trigonometric::{Trigonometric, Wave};
use leastaction_core::forces::{Actuator, System};
use leastaction_core::linear::add_scaled;
use proptest::prelude::*;

const X: [f64; 6] = [0.4, -0.3, 1.1, 0.7, -0.5, 0.2];
const U: [f64; 2] = [0.6, -0.9];
const STEP: f64 = 1e-5;

/// Columns of A and B by central differences of the node's end.
fn check<P: Path>(ticks: u16, stride: u16) {
    for model in shapes::of_three() {
        let system = System { lagrangian: model.in_f64(), forces: forces::all() };
        let newton = Newton { max_iterations: 40, stop: 0.0, accept: 1e-8 };
        let actuator = Actuator { gain: [0.7, -1.3, 0.4], offset: [0.2, -0.1, 0.3], delay: 0.0 };
        let del = Del::<f64, P>::with_newton(0.01, newton);
        let plant = Stepped { system: &system, del, actuator, inputs: [2, 0], stride };
        let end = |x: [f64; 6], u: [f64; 2]| -> [f64; 6] {
            plant.advance(&mut plant.begin(&x).unwrap(), (ticks, &u), &mut [0.0; 6]).unwrap()
        };
        let found = plant.linearise_at(&X, (ticks, &U)).unwrap();
        for j in 0..6 {
            let moved =
                |step: f64| end(add_scaled(&X, step, &core::array::from_fn(|i| f64::from(i == j))), U);
            let (forth, back) = (moved(STEP), moved(-STEP));
            for i in 0..6 {
                assert_close("A", found.a[i][j], (forth[i] - back[i]) / (2.0 * STEP), 1e-8);
            }
        }
        for j in 0..2 {
            let moved =
                |step: f64| end(X, add_scaled(&U, step, &core::array::from_fn(|i| f64::from(i == j))));
            let (forth, back) = (moved(STEP), moved(-STEP));
            for i in 0..6 {
                assert_close("B", found.b[i][j], (forth[i] - back[i]) / (2.0 * STEP), 1e-8);
            }
        }
    }
}

#[test]
fn nodes_are_linearised_exactly() {
    check::<Midpoint>(1, 1);
    check::<Midpoint>(3, 1);
    check::<Midpoint>(3, 3);
    check::<Galerkin>(2, 1);
    check::<Galerkin>(5, 2);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Any number of ticks with any stride is linearised exactly, and lasts as long as that number of single ticks.
    #[test]
    fn nodes_of_any_length_are_linearised_exactly(ticks in 1_u16..12, stride in 1_u16..14) {
        check::<Midpoint>(ticks, stride);
        check_time::<Midpoint>(ticks, stride);
        check_time::<Galerkin>(ticks, stride);
    }
}

/// A free mass moves by its velocity times the time of the node, whatever its steps are.
fn check_time<P: Path>(ticks: u16, stride: u16) {
    let mass = [(0, 0, Wave { amplitude: 2.0, wave: [0.0] })];
    let system = System::conservative(Trigonometric { inertia: &mass, potential: &[] });
    let del = Del::<f64, P>::new(0.01);
    let plant = Stepped { system: &system, del, actuator: Actuator::ideal(), inputs: [0], stride };
    let end: [f64; 2] =
        plant.advance(&mut plant.begin(&[0.3, 1.5]).unwrap(), (ticks, &[0.0]), &mut [0.0; 2]).unwrap();
    assert_close("q", end[0], 0.3 + 1.5 * 0.01 * f64::from(ticks), 1e-14);
    assert_close("v", end[1], 1.5, 1e-14);
}

/// About a rest, the derivatives are those of the steps that stay there.
fn check_rest<P: Path>(ticks: u16, stride: u16) {
    for model in shapes::of_three() {
        let lagrangian = model.in_f64();
        let system = System { lagrangian, forces: forces::all() };
        let newton = Newton { max_iterations: 40, stop: 0.0, accept: 1e-8 };
        let del = Del::<f64, P>::with_newton(0.01, newton);
        let (q, rest) = ([0.4, -0.3, 1.1], [0.0; 3]);
        let u = inverse_dynamics(&system, &q, &rest, &rest).unwrap();
        let inputs = [2, 0, 1];
        let plant = Stepped { system: &system, del, actuator: Actuator::ideal(), inputs, stride };
        let u: [f64; 3] = inputs.map(|input| u[input]);
        let expected: Transition<f64, 6, 3> =
            plant.linearise_at(&[q[0], q[1], q[2], 0.0, 0.0, 0.0], (ticks, &u)).unwrap();
        let found = plant.linearise_rest::<6>(&q, (ticks, &u)).unwrap();
        let entries = |t: &Transition<f64, 6, 3>| [t.a.as_flattened(), t.b.as_flattened()].concat();
        for (found, expected) in entries(&found).into_iter().zip(entries(&expected)) {
            assert_close("at rest", found, expected, 1e-9);
        }
    }
}

#[test]
fn nodes_at_rest_need_no_step() {
    check_rest::<Midpoint>(1, 1);
    check_rest::<Midpoint>(3, 1);
    check_rest::<Midpoint>(5, 3);
    check_rest::<Galerkin>(1, 1);
    check_rest::<Galerkin>(2, 2);
}

#[test]
fn the_slope_of_the_energy_is_exact() {
    for model in shapes::of_three() {
        // Friction of every law is in the forces, and none of it at rest.
        let system = System { lagrangian: model.in_f64(), forces: forces::all() };
        let del = Del::<f64, Midpoint>::new(0.01);
        let plant = Stepped { system: &system, del, actuator: Actuator::ideal(), inputs: [2, 0], stride: 1 };
        let energy = |x: &[f64; 6]| Plant::<f64, 6, 2>::energy(&plant, x).unwrap();
        let (_, slope) = energy(&X);
        for (i, slope) in slope.into_iter().enumerate() {
            let moved =
                |step: f64| energy(&add_scaled(&X, step, &core::array::from_fn(|k| f64::from(i == k)))).0;
            assert_close("slope", slope, (moved(STEP) - moved(-STEP)) / (2.0 * STEP), 1e-8);
        }
    }
}

#[test]
fn a_state_that_is_not_a_number_is_refused() {
    let model = &shapes::of_three()[0];
    let system = System { lagrangian: model.in_f64(), forces: forces::all() };
    let del = Del::<f64, Midpoint>::new(0.01);
    let plant = Stepped { system: &system, del, actuator: Actuator::ideal(), inputs: [2, 0], stride: 1 };
    let mut x = X;
    x[1] = f64::NAN;
    assert_eq!(plant.begin(&x), Err(StepError::NotFinite));
    let mut motion = plant.begin(&X).unwrap();
    let end: Result<[f64; 6], _> = plant.advance(&mut motion, (1, &[f64::NAN, 0.0]), &mut [0.0; 6]);
    assert_eq!(end, Err(StepError::NotFinite));
}
