//! The regulator's gains against a Riccati iteration in f64 over a numerically linearised flow.

use leastaction_core::continuous::{ContinuousState, rk4_step};
use leastaction_core::energy::trigonometric::{ACROBOT, CARTPOLE, PENDULUM, Trigonometric};
use leastaction_core::forces::{System, Viscous};
use leastaction_firmware_sim::SetupError;
use leastaction_firmware_sim::control::{Linear, Regulator, Tolerance, riccati};
use nalgebra::{SMatrix, SVector};

const H: f64 = 0.01;

/// The state after a tick, in f64.
fn flow<const N: usize, const D: usize>(
    system: &System<Trigonometric<'static, N>, Viscous<f64, N>>,
    x: &SVector<f64, D>,
    u: f64,
    input: usize,
) -> SVector<f64, D> {
    let mut state =
        ContinuousState { q: core::array::from_fn(|i| x[i]), v: core::array::from_fn(|i| x[i + N]) };
    let force = core::array::from_fn(|i| if i == input { u } else { 0.0 });
    for _ in 0..20 {
        state = rk4_step(system, &state, &force, H / 20.0).unwrap();
    }
    SVector::from_fn(|i, _| if i < N { state.q[i] } else { state.v[i - N] })
}

/// K by central differences and 20,000 Riccati iterations.
fn oracle<const N: usize, const D: usize>(
    system: &System<Trigonometric<'static, N>, Viscous<f64, N>>,
    target: &SVector<f64, D>,
    input: usize,
    tolerance: &Tolerance<N>,
) -> SVector<f64, D> {
    let e = 1e-5;
    let mut a = SMatrix::<f64, D, D>::zeros();
    for j in 0..D {
        let shift = SVector::from_fn(|i, _| if i == j { e } else { 0.0 });
        let difference =
            flow(system, &(target + shift), 0.0, input) - flow(system, &(target - shift), 0.0, input);
        a.set_column(j, &(difference / (2.0 * e)));
    }
    let b = (flow(system, target, e, input) - flow(system, target, -e, input)) / (2.0 * e);
    let weight = |x: f32| 1.0 / f64::from(x * x);
    let q = SMatrix::from_diagonal(&SVector::from_fn(|i, _| {
        weight(if i < N { tolerance.q[i] } else { tolerance.v[i - N] })
    }));
    let mut p = q;
    let gain =
        |p: &SMatrix<f64, D, D>| a.transpose() * p * b / (weight(tolerance.u) + (b.transpose() * p * b)[0]);
    for _ in 0..20_000 {
        p = q + a.transpose() * p * a - a.transpose() * p * b * gain(&p).transpose();
        p = (p + p.transpose()) * 0.5;
    }
    gain(&p)
}

fn check<const N: usize, const D: usize>(
    exact: Trigonometric<'static, N>,
    damping: [f64; N],
    target: [f32; N],
    input: usize,
    tolerance: &Tolerance<N>,
) {
    let single = System { lagrangian: exact, forces: Viscous { coefficients: damping.map(|c| c as f32) } };
    let double = System { lagrangian: exact, forces: Viscous { coefficients: damping } };
    let regulator = Regulator::design::<_, D>(&single, target, input, tolerance, H as f32).unwrap();
    let at = SVector::from_fn(|i, _| if i < N { f64::from(target[i]) } else { 0.0 });
    let expected = oracle::<N, D>(&double, &at, input, tolerance);
    for i in 0..D {
        let found = f64::from(if i < N { regulator.gain_q[i] } else { regulator.gain_v[i - N] });
        let error = (found - expected[i]).abs() / expected.amax();
        // The acrobot's gains are hundreds of N m: f32 Riccati iterations keep two digits of them.
        assert!(error < 1e-2, "gain {i}: {found}, expected {}", expected[i]);
    }
}

#[test]
fn gains_are_those_of_the_flow() {
    let pendulum = Tolerance { q: [0.2], v: [0.6], u: 0.5 };
    check::<1, 2>(PENDULUM, [0.0], [0.0], 0, &pendulum);
    check::<1, 2>(PENDULUM, [0.4], [0.0], 0, &pendulum);
    let cartpole = Tolerance { q: [0.3, 0.2], v: [0.6, 0.6], u: 1.2 };
    check::<2, 4>(CARTPOLE, [0.0; 2], [0.0; 2], 0, &cartpole);
    check::<2, 4>(CARTPOLE, [0.5, 0.01], [0.0; 2], 0, &cartpole);
    let acrobot = Tolerance { q: [0.1, 0.3], v: [0.5, 0.5], u: 5.0 };
    check::<2, 4>(ACROBOT, [0.0; 2], [core::f32::consts::PI, 0.0], 1, &acrobot);
}

#[test]
fn the_bias_holds_the_target() {
    let system = System::conservative(PENDULUM);
    let tolerance = Tolerance { q: [0.2], v: [0.6], u: 0.5 };
    let regulator = Regulator::design::<_, 2>(&system, [0.4], 0, &tolerance, 0.01).unwrap();
    let force = regulator.force(&ContinuousState { q: [0.4], v: [0.0] }, &[true]);
    assert!((force + 4.905 * 0.4_f32.sin()).abs() < 1e-5, "{force}");
}

#[test]
fn what_cannot_be_stabilised_is_refused() {
    let unstable =
        Linear { a: SMatrix::<f32, 2, 2>::new(1.1, 0.0, 0.0, 0.5), b: SVector::<f32, 2>::new(0.0, 1.0) };
    assert_eq!(riccati(&unstable, &SMatrix::identity(), 1.0), Err(SetupError::NotStabilisable));
}

#[test]
fn a_massless_model_is_refused() {
    let massless = System::conservative(Trigonometric { inertia: &[], ..PENDULUM });
    let tolerance = Tolerance { q: [0.2], v: [0.6], u: 0.5 };
    let refused = Regulator::design::<_, 2>(&massless, [0.0], 0, &tolerance, 0.01);
    assert_eq!(refused, Err(SetupError::SingularInertia));
}

#[test]
fn sampling_is_the_matrix_exponential() {
    // ẍ = 4x + u: x = cosh 2h x₀ + ½ sinh 2h ẋ₀ + ¼(cosh 2h − 1)u.
    let system =
        Linear { a: SMatrix::<f32, 2, 2>::new(0.0, 1.0, 4.0, 0.0), b: SVector::<f32, 2>::new(0.0, 1.0) };
    let (h, sampled) = (0.2_f32, system.sampled(0.2));
    let (c, s) = ((2.0 * h).cosh(), (2.0 * h).sinh());
    let expected = Linear {
        a: SMatrix::<f32, 2, 2>::new(c, 0.5 * s, 2.0 * s, c),
        b: SVector::<f32, 2>::new(0.25 * (c - 1.0), 0.5 * s),
    };
    assert!((sampled.a - expected.a).amax() < 1e-6 && (sampled.b - expected.b).amax() < 1e-6);
}
