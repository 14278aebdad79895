//! The rigid family against its printed formulas, exact derivatives, and finite differences.

mod common;

use common::dual::{self, Dual, derivatives};
use common::shapes::{self, Model};
use common::{Random, assert_close, assert_matrices_close, assert_vectors_close};
use leastaction_core::energy::Learnable;
use leastaction_core::lagrangian::{Lagrangian, MassMatrix};
use leastaction_core::linear;

const EXACT: f64 = 1e-12;

/// Calls `check` with every model at a few states.
fn everywhere(
    one: impl Fn(&Model<1>, &[f64; 1], &[f64; 1]),
    two: impl Fn(&Model<2>, &[f64; 2], &[f64; 2]),
    three: impl Fn(&Model<3>, &[f64; 3], &[f64; 3]),
) {
    at_states(&shapes::of_one(), one);
    at_states(&shapes::of_two(), two);
    at_states(&shapes::of_three(), three);
}

fn at_states<const N: usize>(models: &[Model<N>], check: impl Fn(&Model<N>, &[f64; N], &[f64; N])) {
    let mut random = Random(99);
    for model in models {
        for _ in 0..4 {
            check(model, &random.array(3.0), &random.array(2.0));
        }
    }
}

/// One generic check at all models of all sizes.
macro_rules! everywhere {
    ($check:ident) => {
        everywhere($check, $check, $check)
    };
}

#[test]
fn energies_are_those_of_the_printed_formulas() {
    fn check<const N: usize>(model: &Model<N>, q: &[f64; N], v: &[f64; N]) {
        let found = model.in_f64().energies(q, v);
        let (kinetic, potential) = model.naive_energies(q, v);
        assert_close("kinetic", found.kinetic, kinetic, EXACT);
        assert_close("potential", found.potential, potential, EXACT);
    }
    everywhere!(check);
}

#[test]
fn all_derivatives_are_those_of_the_energies() {
    fn check<const N: usize>(model: &Model<N>, q: &[f64; N], v: &[f64; N]) {
        let weights: Vec<Dual> = model.weights.iter().map(|w| Dual::constant(*w)).collect();
        let expected = derivatives(&model.over(&weights), q, v);
        let rigid = model.in_f64();
        let (g, d, h) = (rigid.gradient(q, v), rigid.dynamics(q, v), rigid.hessian(q, v));
        for (name, l_q, l_v) in
            [("gradient", g.l_q, g.l_v), ("dynamics", d.l_q, d.l_v), ("hessian", h.l_q, h.l_v)]
        {
            assert_vectors_close(&format!("{name} l_q"), &l_q, &expected.l_q, EXACT);
            assert_vectors_close(&format!("{name} l_v"), &l_v, &expected.l_v, EXACT);
        }
        assert_matrices_close("l_qq", &h.l_qq, &expected.l_qq, EXACT);
        assert_matrices_close("l_vq", &h.l_vq, &expected.l_vq, EXACT);
        assert_matrices_close("l_vv", &h.l_vv, &expected.l_vv, EXACT);
        assert_matrices_close("mass", &MassMatrix::dense(&d.mass), &expected.l_vv, EXACT);
        assert_vectors_close("l_vq v", &d.l_vq_v, &linear::multiply(&expected.l_vq, v), EXACT);
    }
    everywhere!(check);
}

#[test]
fn first_derivatives_are_the_finite_differences() {
    fn check<const N: usize>(model: &Model<N>, q: &[f64; N], v: &[f64; N]) {
        const STEP: f64 = 1e-5;
        let lagrangian = |q: &[f64; N], v: &[f64; N]| {
            let (kinetic, potential) = model.naive_energies(q, v);
            kinetic - potential
        };
        let found = model.in_f64().gradient(q, v);
        for i in 0..N {
            let along = dual::unit(i);
            let (forth, back) = (linear::add_scaled(q, STEP, &along), linear::add_scaled(q, -STEP, &along));
            assert_close(
                "l_q",
                found.l_q[i],
                (lagrangian(&forth, v) - lagrangian(&back, v)) / (2.0 * STEP),
                1e-8,
            );
            let (forth, back) = (linear::add_scaled(v, STEP, &along), linear::add_scaled(v, -STEP, &along));
            assert_close(
                "l_v",
                found.l_v[i],
                (lagrangian(q, &forth) - lagrangian(q, &back)) / (2.0 * STEP),
                1e-8,
            );
        }
    }
    everywhere!(check);
}

#[test]
fn second_derivatives_are_symmetric_and_the_mass_matrix_is_positive_definite() {
    fn check<const N: usize>(model: &Model<N>, q: &[f64; N], v: &[f64; N]) {
        let h = model.in_f64().hessian(q, v);
        assert_matrices_close("l_qq", &h.l_qq, &linear::transpose(&h.l_qq), 1e-14);
        assert_matrices_close("l_vv", &h.l_vv, &linear::transpose(&h.l_vv), 1e-14);
        let kinetic = linear::dot(v, &linear::multiply(&h.l_vv, v));
        assert!(kinetic > 0.0, "vᵀMv = {kinetic} at v = {v:?}");
    }
    everywhere!(check);
}

#[test]
fn nothing_depends_on_a_cyclic_coordinate() {
    fn check<const N: usize>(model: &Model<N>, q: &[f64; N], v: &[f64; N]) {
        let rigid = model.in_f64();
        let mut moved = *q;
        for (i, kind) in model.coordinates.iter().enumerate() {
            if *kind == shapes::Cyclic {
                moved[i] += 17.0;
                assert_eq!(rigid.gradient(q, v).l_q[i].abs(), 0.0);
            }
        }
        assert_eq!(rigid.hessian(q, v), rigid.hessian(&moved, v));
    }
    everywhere!(check);
}

/// Collects what a parameter derivative visits, and checks that it visits every parameter once.
fn visited<const N: usize>(model: &Model<N>, gradient: impl FnOnce(&mut dyn FnMut(usize, f64))) -> Vec<f64> {
    let mut values = vec![None; model.weights.len()];
    gradient(&mut |position, value| {
        assert!(values[position].replace(value).is_none(), "parameter {position} was visited twice");
    });
    values.into_iter().map(|value| value.expect("every parameter is visited")).collect()
}

/// The third-order term of L along two directions and every weight in turn: exact.
fn exact_weight_derivatives<const N: usize>(
    model: &Model<N>,
    (q, v): (&[f64; N], &[f64; N]),
    [first, second]: [dual::Direction<N>; 2],
    part: impl Fn(num_dual::HyperHyperDual64) -> f64,
) -> Vec<f64> {
    let still = ([0.0; N], [0.0; N]);
    let mut weights: Vec<Dual> = model.weights.iter().map(|w| Dual::constant(*w)).collect();
    (0..weights.len())
        .map(|k| {
            weights[k] = Dual::moving(model.weights[k], [0.0, 0.0, 1.0]);
            let derivative = part(dual::lagrangian(&model.over(&weights), q, v, [first, second, still]));
            weights[k] = Dual::constant(model.weights[k]);
            derivative
        })
        .collect()
}

/// Central differences of `f` over every weight in turn.
fn weight_differences<const N: usize>(model: &Model<N>, f: impl Fn(&Model<N>) -> f64) -> Vec<f64> {
    const STEP: f64 = 1e-5;
    let mut varied = model.clone();
    (0..model.weights.len())
        .map(|k| {
            let mut at = |weight| {
                varied.weights[k] = weight;
                f(&varied)
            };
            let difference = at(model.weights[k] + STEP) - at(model.weights[k] - STEP);
            at(model.weights[k]);
            difference / (2.0 * STEP)
        })
        .collect()
}

fn assert_all_close(name: &str, found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    for (k, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert_close(&format!("{name}, parameter {k}"), *found, *expected, tolerance);
    }
}

#[test]
fn directional_gradient_is_the_parameter_derivative() {
    fn check<const N: usize>(model: &Model<N>, q: &[f64; N], v: &[f64; N]) {
        let mut random = Random(5);
        let (dq, dv) = (random.array(1.0), random.array(1.0));
        let rigid = model.in_f64();
        let found = visited(model, |row| rigid.directional_gradient((q, v), (&dq, &dv), row));
        let still = ([0.0; N], [0.0; N]);
        let exact = exact_weight_derivatives(model, (q, v), [(dq, dv), still], |x| x.eps1eps3);
        assert_all_close("exact", &found, &exact, EXACT);
        let differences = weight_differences(model, |model| {
            let g = model.in_f64().gradient(q, v);
            linear::dot(&g.l_q, &dq) + linear::dot(&g.l_v, &dv)
        });
        assert_all_close("differences", &found, &differences, 1e-8);
    }
    everywhere!(check);
}

#[test]
fn momentum_rate_gradient_is_the_parameter_derivative() {
    fn check<const N: usize>(model: &Model<N>, q: &[f64; N], v: &[f64; N]) {
        let mut random = Random(6);
        let (a, y) = (random.array(1.0), random.array(1.0));
        let rigid = model.in_f64();
        let found = visited(model, |row| rigid.momentum_rate_gradient((q, v), &a, &y, row));
        let along = [([0.0; N], y), (*v, a)];
        let exact = exact_weight_derivatives(model, (q, v), along, |x| x.eps1eps2eps3);
        assert_all_close("exact", &found, &exact, EXACT);
        let differences = weight_differences(model, |model| {
            let d = model.in_f64().dynamics(q, v);
            linear::dot(&y, &linear::add_scaled(&d.l_vq_v, 1.0, &d.mass.multiply(&a)))
        });
        assert_all_close("differences", &found, &differences, 1e-8);
    }
    everywhere!(check);
}

#[test]
fn a_block_that_does_not_fit_is_refused() {
    let model = &shapes::of_two()[0];
    let shape = model.shape();
    let mut short = &model.weights[1..];
    assert!(leastaction_core::energy::rigid::Rigid::<f64, 2, 13, 3>::take(&mut short, &shape).is_none());
    let mut block = &model.weights[..];
    assert!(
        leastaction_core::energy::rigid::Rigid::<f64, 2, 6, 3>::take(&mut block, &shape).is_none(),
        "too wide"
    );
    let mut block = &model.weights[..];
    assert!(
        leastaction_core::energy::rigid::Rigid::<f64, 2, 13, 1>::take(&mut block, &shape).is_none(),
        "too deep"
    );
}
