//! The regulator's gains against a Riccati iteration in f64 over steps, and over the exact flow, that are linearised by differences.

use leastaction_core::continuous::{ContinuousState, rk4_step};
use leastaction_core::discrete::{Control, Newton, State};
use leastaction_core::energy::trigonometric::{ACROBOT, CARTPOLE, PENDULUM, Trigonometric, Wave};
use leastaction_core::forces::{System, Viscous};
use leastaction_firmware_sim::SetupError;
use leastaction_firmware_sim::control::{Regulator, Tolerance};
use leastaction_firmware_sim::observer::{Integrator, ObserverConfig, Order};
use nalgebra::{SMatrix, SVector};

const H: f64 = 0.01;

type Damped<S, const N: usize> = System<Trigonometric<'static, N>, Viscous<S, N>>;

/// The state a tick after another, in f64.
type Tick<const N: usize> =
    fn(&Damped<f64, N>, Order, ContinuousState<f64, N>, &[f64; N]) -> ContinuousState<f64, N>;

fn flow<const N: usize>(
    system: &Damped<f64, N>,
    _: Order,
    state: ContinuousState<f64, N>,
    force: &[f64; N],
) -> ContinuousState<f64, N> {
    (0..20).fold(state, |state, _| rk4_step(system, &state, force, H / 20.0).unwrap())
}

fn step<const N: usize>(
    system: &Damped<f64, N>,
    order: Order,
    ContinuousState { q, v }: ContinuousState<f64, N>,
    force: &[f64; N],
) -> ContinuousState<f64, N> {
    let mut state = State::new(&system.lagrangian, q, v).unwrap();
    let newton = Newton { stop: 0.0, max_iterations: 20, accept: 1e-12 };
    Integrator::new(order, H, newton).step(system, &mut state, &Control::held(*force)).unwrap();
    ContinuousState { q: state.q(), v: state.velocity(&system.lagrangian).unwrap() }
}

/// A regulator's design: where, through which coordinate, and how.
struct Design<const N: usize> {
    target: [f32; N],
    input: usize,
    tolerance: Tolerance<N>,
    order: Order,
}

impl<const N: usize> Design<N> {
    /// K by central differences and 20,000 Riccati iterations.
    fn oracle<const D: usize>(&self, system: &Damped<f64, N>, tick: Tick<N>) -> SVector<f64, D> {
        let after = |x: &SVector<f64, D>, u: f64| -> SVector<f64, D> {
            let state =
                ContinuousState { q: core::array::from_fn(|i| x[i]), v: core::array::from_fn(|i| x[i + N]) };
            let force = core::array::from_fn(|i| if i == self.input { u } else { 0.0 });
            let end = tick(system, self.order, state, &force);
            SVector::from_fn(|i, _| if i < N { end.q[i] } else { end.v[i - N] })
        };
        let target = SVector::from_fn(|i, _| if i < N { f64::from(self.target[i]) } else { 0.0 });
        let e = 1e-5;
        let mut a = SMatrix::<f64, D, D>::zeros();
        for j in 0..D {
            let shift = SVector::from_fn(|i, _| if i == j { e } else { 0.0 });
            let difference = after(&(target + shift), 0.0) - after(&(target - shift), 0.0);
            a.set_column(j, &(difference / (2.0 * e)));
        }
        let b = (after(&target, e) - after(&target, -e)) / (2.0 * e);
        let weight = |x: f32| 1.0 / f64::from(x * x);
        let Tolerance { q, v, u } = self.tolerance;
        let q = SMatrix::from_diagonal(&SVector::from_fn(|i, _| weight(if i < N { q[i] } else { v[i - N] })));
        let mut p = q;
        let gain = |p: &SMatrix<f64, D, D>| a.transpose() * p * b / (weight(u) + (b.transpose() * p * b)[0]);
        for _ in 0..20_000 {
            p = q + a.transpose() * p * a - a.transpose() * p * b * gain(&p).transpose();
            p = (p + p.transpose()) * 0.5;
        }
        gain(&p)
    }

    /// Compares the gains, relative to the largest, with those of steps and of the flow.
    fn check<const D: usize>(&self, exact: Trigonometric<'static, N>, damping: [f64; N], errors: [f64; 2]) {
        let single =
            System { lagrangian: exact, forces: Viscous { coefficients: damping.map(|c| c as f32) } };
        let double = System { lagrangian: exact, forces: Viscous { coefficients: damping } };
        let Self { target, input, tolerance, order } = self;
        let integrator = ObserverConfig { order: *order, ..ObserverConfig::new() }.integrator(H as f32);
        let found = Regulator::design::<_, D>(&single, *target, *input, tolerance, &integrator).unwrap();
        let found: SVector<f64, D> =
            SVector::from_fn(|i, _| f64::from(if i < N { found.gain_q[i] } else { found.gain_v[i - N] }));
        for (tick, most) in [step as Tick<N>, flow].into_iter().zip(errors) {
            let expected = self.oracle::<D>(&double, tick);
            let error = (found - expected).amax() / expected.amax();
            assert!(error < most, "{found}, expected {expected}");
        }
    }
}

#[test]
fn gains_are_those_of_the_steps() {
    for (order, flow) in [(Order::Two, 1e-3), (Order::Four, 1e-4)] {
        let pendulum = Design { target: [0.0], input: 0, tolerance: TOLERANCE, order };
        pendulum.check::<2>(PENDULUM, [0.0], [1e-5, flow]);
        pendulum.check::<2>(PENDULUM, [0.4], [1e-5, flow]);
        let tolerance = Tolerance { q: [0.3, 0.2], v: [0.6, 0.6], u: 1.2 };
        let cartpole = Design { target: [0.0; 2], input: 0, tolerance, order };
        cartpole.check::<4>(CARTPOLE, [0.0; 2], [1e-5, flow]);
        cartpole.check::<4>(CARTPOLE, [0.5, 0.01], [1e-5, flow]);
        // The acrobot's gains are hundreds of N m: single precision keeps three digits of them.
        let tolerance = Tolerance { q: [0.1, 0.3], v: [0.5, 0.5], u: 5.0 };
        let acrobot = Design { target: [core::f32::consts::PI, 0.0], input: 1, tolerance, order };
        acrobot.check::<4>(ACROBOT, [0.0; 2], [1e-3, 1e-3]);
    }
}

const TOLERANCE: Tolerance<1> = Tolerance { q: [0.2], v: [0.6], u: 0.5 };

#[test]
fn the_bias_holds_the_target() {
    let system = System::conservative(PENDULUM);
    let step = ObserverConfig::new().integrator(0.01);
    let regulator = Regulator::design::<_, 2>(&system, [0.4], 0, &TOLERANCE, &step).unwrap();
    let force = regulator.force(&ContinuousState { q: [0.4], v: [0.0] }, &[true]);
    assert!((force + 4.905 * 0.4_f32.sin()).abs() < 1e-5, "{force}");
}

/// Two rods on pivots of their own, of which one is driven.
const APART: Trigonometric<'static, 2> = Trigonometric {
    inertia: &[
        (0, 0, Wave { amplitude: 1.0, wave: [0.0; 2] }),
        (1, 1, Wave { amplitude: 1.0, wave: [0.0; 2] }),
    ],
    potential: &[Wave { amplitude: 5.0, wave: [1.0, 0.0] }, Wave { amplitude: 5.0, wave: [0.0, 1.0] }],
};

fn refused<const N: usize, const D: usize>(
    exact: Trigonometric<'static, N>,
    damping: f32,
    tolerance: &Tolerance<N>,
) -> SetupError {
    let system = System { lagrangian: exact, forces: Viscous { coefficients: [damping; N] } };
    let step = ObserverConfig::new().integrator(0.01);
    Regulator::design::<_, D>(&system, [0.0; N], 0, tolerance, &step).unwrap_err()
}

#[test]
fn what_no_gain_holds_is_refused() {
    let both = Tolerance { q: [0.2; 2], v: [0.6; 2], u: 0.5 };
    assert_eq!(refused::<2, 4>(APART, 0.0, &both), SetupError::NotStabilisable);
    // Without gravity the other rod neither falls nor comes to rest.
    let floating = Trigonometric { potential: &[], ..APART };
    assert_eq!(refused::<2, 4>(floating, 0.0, &both), SetupError::NotStabilisable);
    assert_eq!(refused::<1, 2>(PENDULUM, f32::NAN, &TOLERANCE), SetupError::NotStabilisable);
}

#[test]
fn a_massless_model_is_refused() {
    let massless = Trigonometric { inertia: &[], ..PENDULUM };
    assert_eq!(refused::<1, 2>(massless, 0.0, &TOLERANCE), SetupError::SingularInertia);
    let of_one = Trigonometric { inertia: &[(0, 0, Wave { amplitude: 1.0, wave: [0.0; 2] })], ..APART };
    let both = Tolerance { q: [0.2; 2], v: [0.6; 2], u: 0.5 };
    assert_eq!(refused::<2, 4>(of_one, 0.0, &both), SetupError::SingularInertia);
}

#[test]
fn tolerances_that_are_not_positive_are_refused() {
    for tolerance in [
        Tolerance { q: [0.0], ..TOLERANCE },
        Tolerance { v: [-1.0], ..TOLERANCE },
        Tolerance { u: f32::INFINITY, ..TOLERANCE },
        Tolerance { u: f32::NAN, ..TOLERANCE },
    ] {
        let error = refused::<1, 2>(PENDULUM, 0.0, &tolerance);
        assert!(matches!(error, SetupError::OutOfRange { what: "regulator tolerance", .. }), "{error}");
    }
}
