//! Forces Q(q, v, τ) and the actuator before them: derivatives, inverse dynamics, steps of both orders.

mod common;

use common::dual::{Dual, unit};
use common::{Random, assert_close, assert_matrices_close, assert_vectors_close, log_log_slope, shapes};
use leastaction_core::continuous::{acceleration, inverse_dynamics, momentum};
use leastaction_core::discrete::{Control, Del, Galerkin, Midpoint, Path, State, StepError};
use leastaction_core::energy::trigonometric::{ACROBOT, CARTPOLE, PENDULUM};
use leastaction_core::forces::{Actuator, Forces, System, Viscous};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::linear::{Matrix, dot};
use leastaction_core::scalar::Scalar;

// ---- Laws ----

/// Friction that grows with the load and changes with the neighbour's position:
/// Q_i = −c_i (√(τ_i² + s²) − s) tanh(v_i/ε) (1 + k sin q_j), j the next coordinate.
#[derive(Clone, Copy, Debug)]
struct LoadFriction<const N: usize> {
    c: [f64; N],
}

const SMOOTHING: f64 = 0.3;
const WIDTH: f64 = 0.6;
const RIPPLE: f64 = 0.4;

impl<const N: usize> LoadFriction<N> {
    fn some() -> Self {
        Self { c: core::array::from_fn(|i| 0.2 + 0.15 * i as f64) }
    }

    /// c_i, √(τ_i² + s²), tanh(v_i/ε), and the factor of q_j with its derivative.
    fn terms<S: Scalar>(&self, i: usize, q: &[S; N], v: &[S; N], tau: &[S; N]) -> [S; 5] {
        let (sin, cos) = q[(i + 1) % N].sin_cos();
        let (s, k) = (S::constant(SMOOTHING), S::constant(RIPPLE));
        let root = (tau[i] * tau[i] + s * s).sqrt();
        [S::constant(self.c[i]), root, (v[i] / S::constant(WIDTH)).tanh(), S::one() + k * sin, k * cos]
    }
}

impl<S: Scalar, const N: usize> Forces<S, N> for LoadFriction<N> {
    fn force(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> [S; N] {
        core::array::from_fn(|i| {
            let [c, root, direction, ripple, _] = self.terms(i, q, v, tau);
            -(c * (root - S::constant(SMOOTHING)) * direction * ripple)
        })
    }

    fn derivatives(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> (Matrix<S, N>, Matrix<S, N>) {
        let (mut in_q, mut in_v) = ([[S::zero(); N]; N], [[S::zero(); N]; N]);
        for i in 0..N {
            let [c, root, direction, ripple, ripple_rate] = self.terms(i, q, v, tau);
            let load = c * (root - S::constant(SMOOTHING));
            in_q[i][(i + 1) % N] -= load * direction * ripple_rate;
            in_v[i][i] -= load * (S::one() - direction * direction) / S::constant(WIDTH) * ripple;
        }
        (in_q, in_v)
    }

    fn load_derivative(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> Matrix<S, N> {
        let mut in_tau = [[S::zero(); N]; N];
        for i in 0..N {
            let [c, root, direction, ripple, _] = self.terms(i, q, v, tau);
            in_tau[i][i] = -(c * tau[i] / root * direction * ripple);
        }
        in_tau
    }
}

/// A coupling that is no friction: Q_i = a q_i v_j² sin τ_j, j the next coordinate.
#[derive(Clone, Copy, Debug)]
struct Coupling(f64);

impl<S: Scalar, const N: usize> Forces<S, N> for Coupling {
    fn force(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> [S; N] {
        core::array::from_fn(|i| {
            let j = (i + 1) % N;
            S::constant(self.0) * q[i] * v[j] * v[j] * tau[j].sin_cos().0
        })
    }

    fn derivatives(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> (Matrix<S, N>, Matrix<S, N>) {
        let (mut in_q, mut in_v) = ([[S::zero(); N]; N], [[S::zero(); N]; N]);
        for i in 0..N {
            let j = (i + 1) % N;
            let factor = S::constant(self.0) * tau[j].sin_cos().0;
            in_q[i][i] += factor * v[j] * v[j];
            in_v[i][j] += factor * q[i] * (v[j] + v[j]);
        }
        (in_q, in_v)
    }

    fn load_derivative(&self, q: &[S; N], v: &[S; N], tau: &[S; N]) -> Matrix<S, N> {
        let mut in_tau = [[S::zero(); N]; N];
        for i in 0..N {
            let j = (i + 1) % N;
            in_tau[i][j] += S::constant(self.0) * q[i] * v[j] * v[j] * tau[j].sin_cos().1;
        }
        in_tau
    }
}

type All<S, const N: usize> = (Viscous<S, N>, (LoadFriction<N>, Coupling));

/// Damping, friction and a coupling together.
fn all<S: Scalar, const N: usize>() -> All<S, N> {
    let coefficients = core::array::from_fn(|i| S::constant(0.1 + 0.25 * i as f64));
    (Viscous { coefficients }, (LoadFriction::some(), Coupling(0.03)))
}

/// ∂Q/∂q, ∂Q/∂v, ∂Q/∂τ by dual numbers.
fn derivatives<F: Forces<Dual, N>, const N: usize>(
    law: &F,
    [q, v, tau]: [[f64; N]; 3],
) -> [Matrix<f64, N>; 3] {
    let moving = |x: [f64; N], along: [f64; N]| {
        core::array::from_fn::<_, N, _>(|i| Dual::moving(x[i], [along[i], 0.0, 0.0]))
    };
    let still = [0.0; N];
    [0, 1, 2].map(|of| {
        let columns: [[f64; N]; N] = core::array::from_fn(|j| {
            let along = |which| if which == of { unit(j) } else { still };
            let (q, v, tau) = (moving(q, along(0)), moving(v, along(1)), moving(tau, along(2)));
            law.force(&q, &v, &tau).map(|force| force.0.eps1)
        });
        core::array::from_fn(|i| core::array::from_fn(|j| columns[j][i]))
    })
}

fn check_derivatives<F, G, const N: usize>(name: &str, law: F, dual: &G, seed: u64)
where
    F: Forces<f64, N>,
    G: Forces<Dual, N>,
{
    let mut random = Random(seed);
    for _ in 0..20 {
        let point = [random.array(2.0), random.array(2.0), random.array(4.0)];
        let [q, v, tau] = point;
        let [in_q, in_v, in_tau] = derivatives(dual, point);
        let (found_q, found_v) = law.derivatives(&q, &v, &tau);
        assert_matrices_close(&format!("{name}, q"), &found_q, &in_q, 1e-14);
        assert_matrices_close(&format!("{name}, v"), &found_v, &in_v, 1e-14);
        assert_matrices_close(&format!("{name}, τ"), &law.load_derivative(&q, &v, &tau), &in_tau, 1e-14);
        let numbers = [in_q, in_v, in_tau].map(|matrix| matrix.concat()).concat();
        assert!(numbers.iter().any(|x| *x != 0.0), "{name} has derivatives");
    }
}

#[test]
fn derivatives_are_those_of_dual_numbers() {
    fn check<const N: usize>(seed: u64) {
        let (law, dual) = (all::<f64, N>(), all::<Dual, N>());
        check_derivatives("viscous", law.0, &dual.0, seed);
        check_derivatives("friction", law.1.0, &dual.1.0, seed);
        check_derivatives::<_, _, N>("coupling", law.1.1, &dual.1.1, seed);
        check_derivatives("all", law, &dual, seed);
        let reference = &law;
        check_derivatives("a reference", reference, &dual, seed);
    }
    check::<1>(1);
    check::<2>(2);
    check::<3>(3);
}

/// All entries of ∂Q/∂x of the laws together differ from each other, so that no index can be another one.
#[test]
fn no_derivative_is_that_of_another_place() {
    let [q, v, tau] = [[0.3, 0.8, -1.1], [1.4, -0.6, 0.9], [2.0, -1.3, 0.7]];
    let mut entries: Vec<f64> = derivatives(&all::<Dual, 3>(), [q, v, tau])
        .into_iter()
        .flat_map(|matrix| matrix.concat())
        .filter(|x| *x != 0.0)
        .collect();
    entries.sort_by(f64::total_cmp);
    assert!(entries.len() >= 15 && entries.windows(2).all(|pair| pair[1] - pair[0] > 1e-6), "{entries:?}");
}

/// Two laws together are the sum of both, in either order and nested either way.
#[test]
fn a_pair_is_the_sum_of_its_laws() {
    let (viscous, (friction, coupling)) = all::<f64, 3>();
    let mut random = Random(5);
    let [q, v, tau] = [random.array(2.0), random.array(2.0), random.array(4.0)];
    let sum = |laws: [[f64; 3]; 3]| core::array::from_fn(|i| laws.iter().map(|law| law[i]).sum::<f64>());
    let expected =
        sum([viscous.force(&q, &v, &tau), friction.force(&q, &v, &tau), coupling.force(&q, &v, &tau)]);
    let nested = ((viscous, friction), coupling);
    let turned = (coupling, (friction, viscous));
    let found = [all().force(&q, &v, &tau), nested.force(&q, &v, &tau), turned.force(&q, &v, &tau)];
    for found in found {
        assert_vectors_close("Q", &found, &expected, 1e-15);
    }
    let (_, [in_q, in_v, in_tau]) = ((), derivatives(&all::<Dual, 3>(), [q, v, tau]));
    let (found_q, found_v) = turned.derivatives(&q, &v, &tau);
    assert_matrices_close("q", &found_q, &in_q, 1e-14);
    assert_matrices_close("v", &found_v, &in_v, 1e-14);
    assert_matrices_close("τ", &nested.load_derivative(&q, &v, &tau), &in_tau, 1e-14);
}

#[test]
fn damping_and_friction_only_dissipate() {
    let mut random = Random(6);
    for _ in 0..10_000 {
        let (q, v, tau) = (random.array::<3>(10.0), random.array::<3>(10.0), random.array::<3>(20.0));
        let coefficients = random.array(3.0).map(f64::abs);
        let laws = (Viscous { coefficients }, LoadFriction { c: random.array(1.0).map(f64::abs) });
        for power in [laws.0.force(&q, &v, &tau), laws.1.force(&q, &v, &tau), laws.force(&q, &v, &tau)] {
            assert!(dot(&power, &v) <= 0.0, "{power:?} · {v:?}");
        }
        assert!(v.iter().all(|v| *v != 0.0) && dot(&laws.0.force(&q, &v, &tau), &v) < 0.0);
    }
}

// ---- Acceleration and inverse dynamics ----

/// M a − L_q + L_vq v = τ + Q(q, v, τ).
fn check_inverse<L: Lagrangian<f64, N>, const N: usize>(lagrangian: L) {
    let mut random = Random(12);
    let system = System { lagrangian, forces: all() };
    for _ in 0..20 {
        let (q, v, tau) = (random.array(2.0), random.array(2.0), random.array(5.0));
        let a = acceleration(&system, &q, &v, &tau).unwrap();
        let d = system.lagrangian.dynamics(&q, &v);
        let force = system.forces.force(&q, &v, &tau);
        let left: [f64; N] = core::array::from_fn(|i| dot(&d.mass[i], &a) - d.l_q[i] + d.l_vq_v[i]);
        assert_vectors_close("the equation", &left, &core::array::from_fn(|i| tau[i] + force[i]), 1e-12);
        assert_vectors_close("τ", &inverse_dynamics(&system, &q, &v, &a).unwrap(), &tau, 1e-12);
    }
}

#[test]
fn inverse_dynamics_inverts_acceleration_also_where_friction_sees_the_load() {
    check_inverse(PENDULUM);
    check_inverse(CARTPOLE);
    check_inverse(ACROBOT);
    shapes::of_one().iter().for_each(|model| check_inverse(model.in_f64()));
    shapes::of_two().iter().for_each(|model| check_inverse(model.in_f64()));
    shapes::of_three().iter().for_each(|model| check_inverse(model.in_f64()));
}

/// A law that cancels the control: no force has any effect.
#[derive(Clone, Copy)]
struct Cancelled;

impl<const N: usize> Forces<f64, N> for Cancelled {
    fn force(&self, _: &[f64; N], _: &[f64; N], tau: &[f64; N]) -> [f64; N] {
        tau.map(|tau| -tau)
    }

    fn derivatives(&self, _: &[f64; N], _: &[f64; N], _: &[f64; N]) -> (Matrix<f64, N>, Matrix<f64, N>) {
        ([[0.0; N]; N], [[0.0; N]; N])
    }

    fn load_derivative(&self, _: &[f64; N], _: &[f64; N], _: &[f64; N]) -> Matrix<f64, N> {
        core::array::from_fn(|i| unit::<N>(i).map(|x| -x))
    }
}

#[test]
fn a_control_without_effect_cannot_be_found() {
    let system = System { lagrangian: CARTPOLE, forces: Cancelled };
    let found = inverse_dynamics(&system, &[0.1, 0.2], &[0.3, 0.4], &[1.0, 2.0]);
    assert_eq!(found, Err(StepError::Singular { column: 0 }));
}

// ---- Steps ----

/// Time at which errors are compared, s; the steps divide it.
const END: f64 = 0.8;
const STEPS: [usize; 4] = [40, 80, 160, 320];

type Point<const N: usize> = ([f64; N], [f64; N]);

/// One Runge–Kutta step of length h under τ(s), s from 0 to h.
fn runge_kutta<L: Lagrangian<f64, N>, F: Forces<f64, N>, const N: usize>(
    system: &System<L, F>,
    (q, v): Point<N>,
    h: f64,
    tau: impl Fn(f64) -> [f64; N],
) -> Point<N> {
    let shift =
        |x: &[f64; N], c: f64, y: &[f64; N]| -> [f64; N] { core::array::from_fn(|i| x[i] + c * y[i]) };
    let rate = |q: &[f64; N], v: &[f64; N], s| acceleration(system, q, v, &tau(s)).unwrap();
    let a1 = rate(&q, &v, 0.0);
    let v2 = shift(&v, h / 2.0, &a1);
    let a2 = rate(&shift(&q, h / 2.0, &v), &v2, h / 2.0);
    let v3 = shift(&v, h / 2.0, &a2);
    let a3 = rate(&shift(&q, h / 2.0, &v2), &v3, h / 2.0);
    let v4 = shift(&v, h, &a3);
    let a4 = rate(&shift(&q, h, &v3), &v4, h);
    (
        core::array::from_fn(|i| q[i] + h / 6.0 * (v[i] + 2.0 * v2[i] + 2.0 * v3[i] + v4[i])),
        core::array::from_fn(|i| v[i] + h / 6.0 * (a1[i] + 2.0 * a2[i] + 2.0 * a3[i] + a4[i])),
    )
}

/// The slope of the error of position and momentum together over the step.
fn slope<const N: usize>(reference: impl Fn(usize) -> Point<N>, solve: impl Fn(usize) -> Point<N>) -> f64 {
    log_log_slope(&STEPS.map(|steps| {
        let ((q, p), (found_q, found_p)) = (reference(steps), solve(steps));
        let pairs = q.iter().zip(&found_q).chain(p.iter().zip(&found_p));
        (END / steps as f64, pairs.map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt())
    }))
}

#[track_caller]
fn assert_order(name: &str, order: f64, slope: f64) {
    println!("{name}: slope {slope:.3}");
    assert!((slope - order).abs() <= 0.2, "{name}: {slope} instead of {order}");
}

const START: Point<2> = ([0.2, 1.3], [-0.4, 2.1]);

/// The commands at time t, smooth.
fn command(t: f64) -> [f64; 2] {
    [3.0 * (4.0 * t).sin(), 1.0 - 2.0 * (3.0 * t).cos()]
}

/// Steps of equal length, each under the control of its number.
fn stepped<P: Path, L: Lagrangian<f64, 2>, F: Forces<f64, 2>>(
    system: &System<L, F>,
    steps: usize,
    control: impl Fn(i32, f64) -> Control<f64, 2>,
) -> Point<2> {
    let h = END / steps as f64;
    let del = Del::<f64, P>::new(h);
    let mut state = State::new(&system.lagrangian, START.0, START.1).unwrap();
    for k in 0..steps as i32 {
        let report = del.step(system, &mut state, &control(k, h)).unwrap();
        assert!(report.iterations <= 12, "{report:?}");
    }
    (state.q(), state.p())
}

/// Damping and friction that sees the load, under a control that is linear in time.
fn check_forced_orders<L: Lagrangian<f64, 2>>(name: &str, lagrangian: L) {
    let system = System { lagrangian, forces: all() };
    let tau = |t: f64| [4.0 - 9.0 * t, -1.0 + 5.0 * t];
    const FINE: usize = 8_000;
    let fine = (0..FINE).fold(START, |point, k| {
        let h = END / FINE as f64;
        runge_kutta(&system, point, h, |s| tau(k as f64 * h + s))
    });
    let reference = (fine.0, momentum(&system.lagrangian, &fine.0, &fine.1));
    let control = |k: i32, h: f64| Control { start: tau(f64::from(k) * h), end: tau(f64::from(k + 1) * h) };
    let of_two = slope(|_| reference, |steps| stepped::<Midpoint, _, _>(&system, steps, control));
    let of_four = slope(|_| reference, |steps| stepped::<Galerkin, _, _>(&system, steps, control));
    assert_order(&format!("{name}, midpoint"), 2.0, of_two);
    assert_order(&format!("{name}, Galerkin"), 4.0, of_four);
}

#[test]
fn friction_that_sees_the_load_keeps_the_orders() {
    check_forced_orders("cart-pole", CARTPOLE);
    check_forced_orders("acrobot", ACROBOT);
}

// ---- The actuator ----

fn actuator(delay: f64) -> Actuator<f64, 2> {
    Actuator { gain: [1.5, -0.4], offset: [0.3, -0.7], delay }
}

#[test]
fn an_actuator_scales_shifts_and_inverts() {
    let mut random = Random(9);
    for _ in 0..100 {
        let actuator = Actuator { gain: random.array::<3>(2.0), offset: random.array(2.0), delay: 0.0 };
        let (u, before) = (random.array(5.0), random.array(5.0));
        let tau = actuator.output(&u);
        for i in 0..3 {
            assert_close("τ", tau[i], actuator.gain[i] * u[i] + actuator.offset[i], 0.0);
        }
        assert_vectors_close("u", &actuator.command(&tau), &u, 1e-10);
        let at_once = actuator.held(&before, &u);
        assert_eq!((at_once.start, at_once.end), (tau, tau), "without a delay the older command is over");
        let whole = Actuator { delay: 1.0, ..actuator }.held(&before, &u);
        assert_eq!(whole, Control::held(actuator.output(&before)), "a whole step late is the older command");
        let linear = actuator.linear(&before, &u, &random.array(5.0));
        assert_vectors_close("at the start", &linear.start, &tau, 1e-14);
    }
    let ideal = Actuator::<f64, 2>::ideal();
    assert_eq!((ideal.output(&[1.0, -2.0]), ideal.command(&[1.0, -2.0])), ([1.0, -2.0], [1.0, -2.0]));
    assert_eq!(ideal.held(&[9.0; 2], &[1.0, -2.0]), Control::held([1.0, -2.0]));
    let samples = ideal.linear(&[9.0; 2], &[1.0, -2.0], &[3.0, 0.5]);
    assert_eq!(samples, Control { start: [1.0, -2.0], end: [3.0, 0.5] });
}

/// ∫τ ds and ∫sτ ds over the step, s from 0 to 1, by Simpson's rule on both sides of the jump or bend: exact for what is linear
/// there.
fn moments(delay: f64, tau: impl Fn(f64, bool) -> f64) -> [f64; 2] {
    let piece = |from: f64, to: f64, late: bool| {
        let middle = f64::midpoint(from, to);
        let points = [(from, 1.0), (middle, 4.0), (to, 1.0)].map(|(s, weight)| (s, weight * tau(s, late)));
        let sum = |f: fn(f64) -> f64| points.iter().map(|(s, tau)| f(*s) * tau).sum::<f64>();
        [sum(|_| 1.0), sum(|s| s)].map(|sum| sum * (to - from) / 6.0)
    };
    let (early, late) = (piece(0.0, delay, false), piece(delay, 1.0, true));
    [early[0] + late[0], early[1] + late[1]]
}

fn assert_same_moments(
    name: &str,
    control: &Control<f64, 2>,
    delay: f64,
    signal: impl Fn(usize, f64, bool) -> f64,
) {
    for i in 0..2 {
        let expected = moments(delay, |s, late| signal(i, s, late));
        let found = moments(0.5, |s, _| control.at(s)[i]);
        assert_vectors_close(name, &found, &expected, 1e-13);
    }
}

#[test]
fn a_delayed_command_keeps_impulse_and_moment() {
    let mut random = Random(10);
    for delay in [0.0, 0.1, 0.25, 0.5, 0.77, 0.9, 1.0] {
        let actuator = actuator(delay);
        for _ in 0..20 {
            let [before, start, end] = core::array::from_fn(|_| random.array::<2>(5.0));
            let held = actuator.held(&before, &start);
            assert_same_moments("held", &held, delay, |i, _, late| {
                actuator.output(if late { &start } else { &before })[i]
            });
            let linear = actuator.linear(&before, &start, &end);
            assert_same_moments("linear", &linear, delay, |i, s, late| {
                // u(s − d), linear between the samples at −1, 0 and 1.
                let at = s - delay;
                let u: [f64; 2] = core::array::from_fn(|i| {
                    let rate = if late { end[i] - start[i] } else { start[i] - before[i] };
                    start[i] + at * rate
                });
                actuator.output(&u)[i]
            });
        }
    }
}

/// The motion under the true signal of an actuator: a step in pieces, before and after the jump or bend.
fn delayed<L: Lagrangian<f64, 2>, F: Forces<f64, 2>>(
    system: &System<L, F>,
    actuator: &Actuator<f64, 2>,
    steps: usize,
    held: bool,
) -> Point<2> {
    let h = END / steps as f64;
    let sample = |k: i32| command(f64::from(k) * h);
    let mut point = START;
    let pieces = 6_400 / steps;
    for k in 0..steps as i32 {
        let [before, now, next] = [sample(k - 1), sample(k), sample(k + 1)];
        for (from, to, late) in [(0.0, actuator.delay, false), (actuator.delay, 1.0, true)] {
            let [a, b] = if late { [now, next] } else { [before, now] };
            let tau = |s: f64| {
                let part = s - actuator.delay + f64::from(!late);
                let linear = core::array::from_fn(|i| a[i] + part * (b[i] - a[i]));
                actuator.output(&if held { a } else { linear })
            };
            let piece = (to - from) / pieces as f64;
            if piece > 0.0 {
                for j in 0..pieces {
                    let first = from + j as f64 * piece;
                    point = runge_kutta(system, point, piece * h, |t| tau(first + t / h));
                }
            }
        }
    }
    (point.0, momentum(&system.lagrangian, &point.0, &point.1))
}

/// Slopes of the error against the motion under the true delayed signal, of steps of orders 2 and 4.
fn delayed_slopes<F: Forces<f64, 2> + Copy>(forces: F, delay: f64, held: bool) -> [f64; 2] {
    let (system, actuator) = (System { lagrangian: CARTPOLE, forces }, actuator(delay));
    let sample = |k: i32, h: f64| command(f64::from(k) * h);
    let control = |k: i32, h: f64| {
        let [before, now, next] = [sample(k - 1, h), sample(k, h), sample(k + 1, h)];
        if held { actuator.held(&before, &now) } else { actuator.linear(&before, &now, &next) }
    };
    let reference = |steps| delayed(&system, &actuator, steps, held);
    [
        slope(reference, |steps| stepped::<Midpoint, _, _>(&system, steps, control)),
        slope(reference, |steps| stepped::<Galerkin, _, _>(&system, steps, control)),
    ]
}

/// The linear force of the same impulse and moment keeps order 2, and order 4 where the command is linear between samples. Of
/// a command that is held, the step of order 4 keeps order 3, 4 where the jump is in the middle, and 2 under a law that is
/// nonlinear in τ.
#[test]
fn orders_under_a_delayed_actuator() {
    let viscous = Viscous { coefficients: [0.4, 0.9] };
    for (delay, of_viscous, of_all) in
        [(0.0, 4.0, 4.0), (0.3, 3.0, 2.0), (0.5, 4.0, 2.0), (0.8, 3.0, 2.0), (1.0, 4.0, 4.0)]
    {
        let [of_two, of_four] = delayed_slopes(viscous, delay, true);
        assert_order(&format!("held, viscous, midpoint, delay {delay}"), 2.0, of_two);
        assert_order(&format!("held, viscous, Galerkin, delay {delay}"), of_viscous, of_four);
        let [of_two, of_four] = delayed_slopes(all::<f64, 2>(), delay, true);
        assert_order(&format!("held, all, midpoint, delay {delay}"), 2.0, of_two);
        assert_order(&format!("held, all, Galerkin, delay {delay}"), of_all, of_four);
        let [of_two, of_four] = delayed_slopes(viscous, delay, false);
        assert_order(&format!("linear, viscous, midpoint, delay {delay}"), 2.0, of_two);
        assert_order(&format!("linear, viscous, Galerkin, delay {delay}"), 4.0, of_four);
        let [of_two, of_four] = delayed_slopes(all::<f64, 2>(), delay, false);
        assert_order(&format!("linear, all, midpoint, delay {delay}"), 2.0, of_two);
        assert!(of_four > 3.8, "linear, all, Galerkin, delay {delay}: {of_four} instead of 4");
    }
}
