//! The trigonometric family against exact derivatives, finite differences, and the mechanisms' printed formulas.

use crate::common::dual::derivatives;
use crate::common::{Random, assert_close, assert_matrices_close, assert_vectors_close};
use leastaction_core::continuous::acceleration;
use leastaction_core::energy::trigonometric::{ACROBOT, CARTPOLE, PENDULUM, Trigonometric, Wave};
use leastaction_core::forces::System;
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::linear;

const EXACT: f64 = 1e-12;
const G: f64 = 9.81;

/// Three coordinates, and waves that depend on several of them, so that no swapped index goes unnoticed.
const COUPLED: Trigonometric<'static, 3> = Trigonometric {
    inertia: &[
        (0, 0, Wave { amplitude: 5.0, wave: [0.0, 1.0, -2.0] }),
        (1, 0, Wave { amplitude: 0.7, wave: [1.0, -1.0, 0.0] }),
        (2, 0, Wave { amplitude: -0.3, wave: [0.5, 0.0, 1.0] }),
        (1, 1, Wave { amplitude: 4.0, wave: [0.0, 0.0, 0.0] }),
        (2, 1, Wave { amplitude: 0.9, wave: [0.0, 2.0, 1.0] }),
        (2, 2, Wave { amplitude: 6.0, wave: [1.0, 0.0, 0.0] }),
    ],
    potential: &[
        Wave { amplitude: 2.0, wave: [1.0, 1.0, 0.0] },
        Wave { amplitude: -3.0, wave: [0.0, -1.0, 3.0] },
    ],
};

fn check_derivatives<const N: usize>(system: &Trigonometric<N>) {
    let mut random = Random(3);
    for _ in 0..8 {
        let (q, v): ([f64; N], [f64; N]) = (random.array(3.0), random.array(4.0));
        let expected = derivatives(system, &q, &v);
        let (g, d, h) = (system.gradient(&q, &v), system.dynamics(&q, &v), system.hessian(&q, &v));
        for (l_q, l_v) in [(g.l_q, g.l_v), (d.l_q, d.l_v), (h.l_q, h.l_v)] {
            assert_vectors_close("l_q", &l_q, &expected.l_q, EXACT);
            assert_vectors_close("l_v", &l_v, &expected.l_v, EXACT);
        }
        assert_matrices_close("l_qq", &h.l_qq, &expected.l_qq, EXACT);
        assert_matrices_close("l_vq", &h.l_vq, &expected.l_vq, EXACT);
        assert_matrices_close("l_vv", &h.l_vv, &expected.l_vv, EXACT);
        assert_matrices_close("mass", &d.mass, &expected.l_vv, EXACT);
        assert_vectors_close("l_vq v", &d.l_vq_v, &linear::multiply(&expected.l_vq, &v), EXACT);
        assert_matrices_close("symmetric l_qq", &h.l_qq, &linear::transpose(&h.l_qq), 1e-14);
        assert_close("energy", system.energy(&q, &v), sum_of_energies(system, &q, &v), EXACT);
    }
}

fn sum_of_energies<const N: usize>(system: &Trigonometric<N>, q: &[f64; N], v: &[f64; N]) -> f64 {
    let wave = |w: &Wave<N>| w.amplitude * (0..N).map(|i| w.wave[i] * q[i]).sum::<f64>().cos();
    let kinetic: f64 =
        system.inertia.iter().map(|(i, j, w)| wave(w) * v[*i] * v[*j] * if i == j { 0.5 } else { 1.0 }).sum();
    kinetic + system.potential.iter().map(wave).sum::<f64>()
}

#[test]
fn derivatives_are_those_of_the_energies() {
    check_derivatives(&PENDULUM);
    check_derivatives(&CARTPOLE);
    check_derivatives(&ACROBOT);
    check_derivatives(&COUPLED);
}

#[test]
fn first_derivatives_are_the_finite_differences() {
    const STEP: f64 = 1e-5;
    let (q, v) = ([0.4, -1.2, 2.1], [1.5, -0.6, 0.9]);
    let lagrangian = |q: &[f64; 3], v: &[f64; 3]| {
        let energies = COUPLED.energies(q, v);
        energies.kinetic - energies.potential
    };
    let found = COUPLED.gradient(&q, &v);
    for i in 0..3 {
        let along = crate::common::dual::unit(i);
        let at = |c: f64| (linear::add_scaled(&q, c, &along), linear::add_scaled(&v, c, &along));
        let ((q_forth, v_forth), (q_back, v_back)) = (at(STEP), at(-STEP));
        assert_close(
            "l_q",
            found.l_q[i],
            (lagrangian(&q_forth, &v) - lagrangian(&q_back, &v)) / (2.0 * STEP),
            1e-8,
        );
        assert_close(
            "l_v",
            found.l_v[i],
            (lagrangian(&q, &v_forth) - lagrangian(&q, &v_back)) / (2.0 * STEP),
            1e-8,
        );
    }
}

#[test]
fn pendulum_is_symos() {
    let system = System::conservative(PENDULUM);
    for (theta, u) in [(0.0, 0.0), (0.3, 0.0), (-2.9, 1.7), (1.6, -0.4)] {
        let found = acceleration(&system, &[theta], &[2.2], &[u]).unwrap();
        assert_close("acceleration", found[0], 1.5 * G * f64::sin(theta) + 3.0 * u, EXACT);
        let energies = PENDULUM.energies(&[theta], &[2.0]);
        assert_close("T", energies.kinetic, 2.0 / 3.0, EXACT);
        assert_close("V", energies.potential, G * (1.0 + theta.cos()) / 2.0, EXACT);
    }
}

#[test]
fn cartpole_is_symos() {
    for theta in [0.0, 0.5, -1.9, 3.0] {
        let q = [0.7, theta];
        let coupling = 0.05 * f64::cos(theta);
        assert_matrices_close(
            "H",
            &CARTPOLE.mass_matrix(&q),
            &[[1.1, coupling], [coupling, 0.1 / 3.0]],
            EXACT,
        );
        assert_close("V", CARTPOLE.energies(&q, &[0.0, 0.0]).potential, 0.4905 * theta.cos(), EXACT);
    }
}

#[test]
fn acrobot_is_symos() {
    for (a, b) in [(0.0, 0.0), (0.4, -1.1), (2.7, 1.9)] {
        let (c, q) = (f64::cos(b), [a, b]);
        let h = [[3.5 + c, 1.25 + c / 2.0], [1.25 + c / 2.0, 1.25]];
        assert_matrices_close("H", &ACROBOT.mass_matrix(&q), &h, EXACT);
        let v = -(G / 2.0) * a.cos() - G * (a.cos() + (a + b).cos() / 2.0);
        assert_close("V", ACROBOT.energies(&q, &[0.0, 0.0]).potential, v, EXACT);
    }
}

#[test]
fn terms_outside_the_matrix_are_left_out() {
    let wave = Wave { amplitude: 2.0, wave: [1.0, 0.5] };
    let inertia = [(0, 0, wave), (2, 0, wave), (1, 7, wave), (1, 1, wave)];
    let system = Trigonometric { inertia: &inertia, potential: &[wave] };
    let inside = Trigonometric { inertia: &[(0, 0, wave), (1, 1, wave)], potential: &[wave] };
    let (q, v) = ([0.3, -0.8], [1.0, 2.0]);
    assert_eq!(system.hessian(&q, &v), inside.hessian(&q, &v));
}
