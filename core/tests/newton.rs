//! Newton's method of a step: few iterations, no silent failure, exact Jacobian, and the equations it solves.

mod common;

use common::shapes::{self, Model};
use common::{Random, assert_close, assert_matrices_close, dual};
use leastaction_core::discrete::{
    Control, Del, Galerkin, Interval, Midpoint, Newton, Node, Path, State, StepError, Variation,
};
use leastaction_core::energy::trigonometric::{ACROBOT, CARTPOLE, PENDULUM, Trigonometric};
use leastaction_core::forces::{Forces, System, Viscous};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::linear::{Matrix, add_scaled};
use leastaction_core::scalar::Real;

/// Steps that took 0, 1, 2, … updates.
type Histogram = [usize; 9];

/// 4 s from several starts, the last of them at rest, with SyMo's range of controls on coordinate `driven`; every step
/// must end at its floor.
fn iterations<R: Real, P: Path, const N: usize>(
    lagrangian: Trigonometric<'static, N>,
    driven: usize,
    h: f64,
) -> Histogram {
    let system = System::conservative(lagrangian);
    let del = Del::<R, P>::new(R::constant(h));
    let mut random = Random(4);
    let mut histogram = Histogram::default();
    for speed in [3.0, 1.5, 0.5, 0.0] {
        let (q, v) = (random.array::<N>(3.1), random.array::<N>(speed));
        let mut state = State::new(&lagrangian, q.map(R::constant), v.map(R::constant)).unwrap();
        for k in 0..(4.0 / h) as usize {
            let mut u = [R::zero(); N];
            u[driven] = R::constant(2.0 * (3.0 * k as f64 * h).sin());
            let u = Control::held(u);
            let report = del.step(&system, &mut state, &u).unwrap();
            assert!(report.residual <= R::constant(16.0) * R::EPSILON, "{report:?} at {state:?}");
            histogram[usize::from(report.iterations)] += 1;
        }
    }
    histogram
}

fn check_iterations<R: Real, P: Path>(name: &str) {
    for h in [0.001, 0.01, 0.05] {
        let [pendulum, cartpole, acrobot] = [
            iterations::<R, P, 1>(PENDULUM, 0, h),
            iterations::<R, P, 2>(CARTPOLE, 0, h),
            iterations::<R, P, 2>(ACROBOT, 1, h),
        ];
        println!(
            "{name}, order {}, h = {h}: pendulum {pendulum:?} cart-pole {cartpole:?} acrobot {acrobot:?}",
            P::ORDER
        );
        for histogram in [pendulum, cartpole, acrobot] {
            assert_eq!(
                histogram[4..].iter().sum::<usize>(),
                0,
                "more than 3 iterations at h = {h}: {histogram:?}"
            );
            assert_eq!(histogram[0], 0, "a step without an update at h = {h}");
        }
    }
}

#[test]
fn at_most_three_iterations_up_to_50_ms() {
    check_iterations::<f32, Midpoint>("f32");
    check_iterations::<f32, Galerkin>("f32");
    check_iterations::<f64, Midpoint>("f64");
    check_iterations::<f64, Galerkin>("f64");
}

#[test]
fn a_stop_of_zero_takes_a_constant_number_of_iterations() {
    for max_iterations in [1, 2, 5] {
        let newton = Newton { max_iterations, stop: 0.0, ..Newton::<f32>::default() };
        let del = Del::<f32, Galerkin>::with_newton(0.01, newton);
        let mut state = State::new(&CARTPOLE, [0.0, 3.0], [0.0, 0.0]).unwrap();
        for _ in 0..200 {
            let report = del.step(&System::conservative(CARTPOLE), &mut state, &Control::none()).unwrap();
            assert_eq!(report.iterations, max_iterations);
        }
    }
}

#[test]
fn without_iterations_the_guess_is_judged() {
    let newton = Newton { max_iterations: 0, ..Newton::<f64>::default() };
    let del = Del::<f64, Midpoint>::with_newton(0.01, newton);
    let system = System::conservative(CARTPOLE);
    let mut state = State::new(&CARTPOLE, [0.0, 0.5], [0.0, 0.0]).unwrap();
    assert!(matches!(del.step(&system, &mut state, &Control::none()), Err(StepError::NotConverged(_))));
    let mut at_rest = State::new(&CARTPOLE, [0.0, 0.0], [0.0, 0.0]).unwrap();
    assert_eq!(del.step(&system, &mut at_rest, &Control::none()).unwrap().iterations, 0);
}

/// Where terms cancel, a residual relative to their sum would never be small: no momentum, no force, no motion.
#[test]
fn systems_at_rest_step_too() {
    fn check<P: Path>() {
        for q in [[0.0, 0.0], [0.0, 1e-3], [5.0, core::f32::consts::PI], [0.0, 2.0], [-300.0, 100.0]] {
            let mut state = State::<f32, 2>::new(&CARTPOLE, q, [0.0, 0.0]).unwrap();
            for k in 0..2_000 {
                let result = Del::<f32, P>::new(0.005).step(
                    &System::conservative(CARTPOLE),
                    &mut state,
                    &Control::none(),
                );
                assert!(result.is_ok_and(|r| r.iterations <= 3), "step {k} from {q:?}: {result:?}");
            }
        }
        // Gravity held by the control: the force is what rounding leaves.
        let mut held = State::<f32, 1>::new(&PENDULUM, [0.8], [0.0]).unwrap();
        for _ in 0..2_000 {
            let [force] = PENDULUM.gradient(&held.q(), &[0.0]).l_q;
            let control = Control::held([-force]);
            Del::<f32, P>::new(0.001).step(&System::conservative(PENDULUM), &mut held, &control).unwrap();
        }
        assert!((held.q()[0] - 0.8).abs() < 1e-4);
    }
    check::<Midpoint>();
    check::<Galerkin>();
}

#[test]
fn a_learned_system_at_rest_steps_in_f32() {
    for model in shapes::of_two() {
        let weights: Vec<f32> = model.weights.iter().map(|w| *w as f32).collect();
        let rigid = model.over(&weights);
        let system = System { lagrangian: rigid, forces: Viscous { coefficients: [0.4, 0.4] } };
        let mut state = State::new(&rigid, [0.3, -0.2], [0.0, 0.0]).unwrap();
        // Gravity held, at every step: forces and momenta are rounding errors.
        for k in 0..2_000 {
            let l_q = rigid.gradient(&state.q(), &[0.0, 0.0]).l_q;
            let u = Control::held(l_q.map(|x| -x));
            let result = Del::<f32, Galerkin>::new(0.002).step(&system, &mut state, &u);
            assert!(result.is_ok(), "step {k}: {result:?}");
        }
    }
}

const NO_MASS: Trigonometric<'static, 1> = Trigonometric { inertia: &[], potential: &[] };

/// Runs one step that must fail, and checks that it left the state as it was, bit for bit.
#[track_caller]
fn failing<L, P: Path, const N: usize>(
    lagrangian: L,
    h: f32,
    mut state: State<f32, N>,
    u: [f32; N],
) -> StepError<f32>
where
    L: Lagrangian<f32, N>,
{
    let before = state;
    let error = Del::<f32, P>::new(h).step(&System::conservative(lagrangian), &mut state, &Control::held(u));
    assert_eq!(state, before, "the state was touched");
    error.expect_err("the step must fail")
}

#[test]
fn errors_leave_the_state_alone() {
    fn check<P: Path>() {
        let at = |q, v| State::<f32, 2>::new(&CARTPOLE, q, v).unwrap();
        let swinging = at([0.0, 1.0], [0.5, 2.0]);
        let not_a_number = failing::<_, P, 2>(CARTPOLE, 0.01, swinging, [f32::NAN, 0.0]);
        assert_eq!(not_a_number, StepError::NotFinite);
        assert_eq!(failing::<_, P, 2>(CARTPOLE, 0.01, swinging, [0.0, f32::INFINITY]), StepError::NotFinite);
        assert_eq!(failing::<_, P, 2>(CARTPOLE, 0.01, swinging, [f32::MAX, f32::MAX]), StepError::NotFinite);
        assert_eq!(failing::<_, P, 2>(CARTPOLE, f32::NAN, swinging, [0.0, 0.0]), StepError::NotFinite);
        let lost = State::with_momentum([0.0, 7e4], [0.0, 0.0], [0.0, 0.0]).unwrap();
        assert_eq!(failing::<_, P, 2>(CARTPOLE, 0.01, lost, [0.0, 0.0]), StepError::NotFinite);
        let still = State::with_momentum([0.0], [1.0], [0.0]).unwrap();
        assert!(matches!(failing::<_, P, 1>(NO_MASS, 0.01, still, [0.0]), StepError::Singular(_)));
    }
    check::<Midpoint>();
    check::<Galerkin>();
}

#[test]
fn a_step_far_too_long_is_never_taken_for_converged() {
    fn check<P: Path>() {
        let mut random = Random(17);
        let (mut failures, accept) = (0, Newton::<f32>::default().accept);
        for _ in 0..100 {
            let del = Del::<f32, P>::new(random.symmetric(20.0).abs() as f32 + 1.0);
            let [q, v] = [random.array::<2>(3.0), random.array::<2>(40.0)].map(|x| x.map(|x| x as f32));
            let mut state = State::new(&ACROBOT, q, v).unwrap();
            let before = state;
            match del.step(&System::conservative(ACROBOT), &mut state, &Control::none()) {
                Ok(report) => assert!(report.residual <= accept),
                Err(StepError::NotConverged(report)) => {
                    assert!(report.residual > accept && report.iterations == 8, "{report:?}");
                    assert_eq!(state, before, "the state was touched");
                    failures += 1;
                }
                Err(_) => assert_eq!(state, before, "the state was touched"),
            }
        }
        assert!(failures > 10, "only {failures} steps failed: the test does not test");
    }
    check::<Midpoint>();
    check::<Galerkin>();
}

#[test]
fn a_state_is_finite_or_refused() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(State::new(&PENDULUM, [bad], [0.0]), Err(StepError::NotFinite));
        assert_eq!(State::new(&PENDULUM, [0.0], [bad]), Err(StepError::NotFinite));
        assert_eq!(State::with_momentum([0.0_f32], [bad], [0.0]), Err(StepError::NotFinite));
        assert_eq!(State::with_momentum([0.0_f32], [0.0], [bad]), Err(StepError::NotFinite));
        let del = Del::<f32, Galerkin>::new(0.01);
        let start = del.start(&System::conservative(PENDULUM), &[0.0], &[bad], &Control::none());
        assert_eq!(start, Err(StepError::NotFinite));
    }
}

/// SyMo's equation: ∂_q[L_d(q₋, q) + L_d(q, q₊)] + (h/4)(u₋ + 2u + u₊) = 0, L_d(a, b) = h L((a + b)/2, (b − a)/h).
#[test]
fn two_steps_of_order_2_satisfy_symos_three_point_equation() {
    let (h, system) = (0.05, System::conservative(ACROBOT));
    let del = Del::<f64, Midpoint>::new(h);
    let u = [[0.0, 1.0], [0.0, -0.7], [0.0, 2.1]];
    let mut path = vec![[0.4, -0.9], [0.46, -0.84]];
    let mut state = del.start(&system, &path[0], &path[1], &Control { start: u[0], end: u[1] }).unwrap();
    del.step(&system, &mut state, &Control { start: u[1], end: u[2] }).unwrap();
    path.push(state.q());
    let middle = |a: [f64; 2], b: [f64; 2]| -> ([f64; 2], [f64; 2]) {
        (core::array::from_fn(|i| (a[i] + b[i]) / 2.0), core::array::from_fn(|i| (b[i] - a[i]) / h))
    };
    let ((q_before, v_before), (q_after, v_after)) = (middle(path[0], path[1]), middle(path[1], path[2]));
    let (before, after) = (ACROBOT.gradient(&q_before, &v_before), ACROBOT.gradient(&q_after, &v_after));
    let forces = |i: usize| h / 4.0 * (u[0][i] + 2.0 * u[1][i] + u[2][i]);
    for (i, force) in [forces(0), forces(1)].into_iter().enumerate() {
        let second_slot = h / 2.0 * before.l_q[i] + before.l_v[i];
        let first_slot = h / 2.0 * after.l_q[i] - after.l_v[i];
        assert_close("three-point equation", second_slot + first_slot + force, 0.0, 1e-13);
    }
}

/// Starting from two positions of a trajectory continues that trajectory.
#[test]
fn two_positions_determine_the_momentum() {
    fn check<P: Path>() {
        let system = System { lagrangian: CARTPOLE, forces: Viscous { coefficients: [0.3, 0.01] } };
        let (del, u) = (Del::<f64, P>::new(0.02), Control { start: [1.0, 0.0], end: [-0.5, 0.0] });
        let mut state = State::new(&CARTPOLE, [0.1, 2.0], [0.3, -1.0]).unwrap();
        let q0 = state.q();
        del.step(&system, &mut state, &u).unwrap();
        let started = del.start(&system, &q0, &state.q(), &u).unwrap();
        for i in 0..2 {
            assert_close("p", started.p()[i], state.p()[i], 1e-12);
        }
    }
    check::<Midpoint>();
    check::<Galerkin>();
}

/// An angle-dependent damping, so that no derivative of the force vanishes.
#[derive(Clone, Copy)]
struct Drag;

impl<const N: usize> Forces<f64, N> for Drag {
    fn force(&self, q: &[f64; N], v: &[f64; N]) -> [f64; N] {
        core::array::from_fn(|i| -(1.0 + 0.5 * q[i].sin()) * v[i] + 0.3 * v[(i + 1) % N] * q[i])
    }

    fn derivatives(&self, q: &[f64; N], v: &[f64; N]) -> (Matrix<f64, N>, Matrix<f64, N>) {
        let (mut in_q, mut in_v) = ([[0.0; N]; N], [[0.0; N]; N]);
        for i in 0..N {
            in_q[i][i] = -0.5 * q[i].cos() * v[i] + 0.3 * v[(i + 1) % N];
            in_v[i][i] -= 1.0 + 0.5 * q[i].sin();
            in_v[i][(i + 1) % N] += 0.3 * q[i];
        }
        (in_q, in_v)
    }
}

fn check_jacobian<P: Path, const N: usize>(models: &[Model<N>]) {
    const STEP: f64 = 1e-5;
    for model in models {
        let mut random = Random(8);
        let (h, u) = (0.1, Control { start: random.array(1.0), end: random.array(1.0) });
        let system = System { lagrangian: model.in_f64(), forces: Drag };
        let bubble = if P::BUBBLE { random.array(0.5) } else { [0.0; N] };
        let interval =
            Interval::<f64, P, N>::new(random.array(2.0), random.array(2.0), h, u).moved(&[0.0; N], &bubble);
        let found = interval.linearise(&system);
        assert_eq!(
            found.balance,
            interval.balance(&system),
            "the balance does not depend on how it is computed"
        );
        let zero = [0.0; N];
        for j in 0..N {
            let along: [f64; N] = dual::unit(j);
            let difference = |dw: f64, ds: f64| {
                let at = |c: f64| {
                    let (dw, ds) = (add_scaled(&zero, c * dw, &along), add_scaled(&zero, c * ds, &along));
                    interval.moved(&dw, &ds).balance(&system)
                };
                let (forth, back) = (at(STEP), at(-STEP));
                let slope = |a: [f64; N], b: [f64; N]| -> [f64; N] {
                    core::array::from_fn(|i| (a[i] - b[i]) / (2.0 * STEP))
                };
                (
                    slope(forth.d1_ld, back.d1_ld),
                    slope(forth.dm_ld, back.dm_ld),
                    slope(forth.end_momentum(), back.end_momentum()),
                )
            };
            let (momentum_w, bubble_w, _) = difference(1.0, 0.0);
            for i in 0..N {
                assert_close("momentum_w", found.momentum_w[i][j], momentum_w[i], 1e-8);
                assert_close("bubble_w", found.bubble_w[i][j], bubble_w[i], 1e-8);
            }
            if P::BUBBLE {
                let (momentum_s, bubble_s, end_momentum_s) = difference(0.0, 1.0);
                let found_end = interval.end_momentum_s(&system);
                for i in 0..N {
                    assert_close("momentum_s", found.momentum_s[i][j], momentum_s[i], 1e-8);
                    assert_close("bubble_s", found.bubble_s[i][j], bubble_s[i], 1e-8);
                    assert_close("end_momentum_s", found_end[i][j], end_momentum_s[i], 1e-8);
                }
            }
        }
    }
}

#[test]
fn jacobian_blocks_are_the_finite_differences() {
    check_jacobian::<Midpoint, 1>(&shapes::of_one());
    check_jacobian::<Midpoint, 2>(&shapes::of_two());
    check_jacobian::<Midpoint, 3>(&shapes::of_three());
    check_jacobian::<Galerkin, 1>(&shapes::of_one());
    check_jacobian::<Galerkin, 2>(&shapes::of_two());
    check_jacobian::<Galerkin, 3>(&shapes::of_three());
}

#[test]
fn the_balance_is_the_derivative_of_the_discrete_lagrangian() {
    const STEP: f64 = 1e-6;
    let (h, q0, w, s) = (0.1, [0.4, -0.9], [1.2, 0.7], [0.3, -0.2]);
    let system = System::conservative(ACROBOT);
    // L_d as a function of the three points of the path.
    let action = |q0: [f64; 2], q1: [f64; 2], s: [f64; 2]| -> f64 {
        let w = core::array::from_fn(|i| (q1[i] - q0[i]) / h);
        let path = Interval::<f64, Galerkin, 2>::new(q0, w, h, Control::none()).moved(&[0.0; 2], &s);
        Galerkin::nodes::<f64>()
            .as_ref()
            .iter()
            .map(|node| {
                let (q, v) = path.point(node);
                let e = ACROBOT.energies(&q, &v);
                h * node.weight * (e.kinetic - e.potential)
            })
            .sum()
    };
    let q1 = add_scaled(&q0, h, &w);
    let balance =
        Interval::<f64, Galerkin, 2>::new(q0, w, h, Control::none()).moved(&[0.0; 2], &s).balance(&system);
    for i in 0..2 {
        let along: [f64; 2] = dual::unit(i);
        let slope = |f: &dyn Fn(f64) -> f64| (f(STEP) - f(-STEP)) / (2.0 * STEP);
        let moved = |x: &[f64; 2], c: f64| add_scaled(x, c, &along);
        assert_close("D1", balance.d1_ld[i], slope(&|c| action(moved(&q0, c), q1, s)), 1e-8);
        assert_close("D2", balance.end_momentum()[i], slope(&|c| action(q0, moved(&q1, c), s)), 1e-8);
        // The bubble moves the mid-point by hs; its equation is the derivative over h.
        assert_close("Dm", balance.dm_ld[i], slope(&|c| action(q0, q1, moved(&s, c))) / h, 1e-8);
    }
}

#[test]
fn variations_are_those_of_the_path() {
    let (h, node) = (0.25, Node { tau: 0.3_f64, weight: 1.0 });
    let (start, end, bubble) =
        (Variation::start(&node, h), Variation::end(&node, h), Variation::bubble(&node, h));
    assert_close("start", start.force, h * 0.7, 1e-15);
    assert_close("end", end.force, h * 0.3, 1e-15);
    assert_close("bubble", bubble.force, h * 4.0 * 0.3 * 0.7, 1e-15);
    assert_eq!((start.momentum, end.momentum), (-1.0, 1.0));
    assert_close("bubble rate", bubble.momentum, 4.0 * (1.0 - 0.6), 1e-15);
}

#[test]
fn reduced_matrix_eliminates_the_bubble() {
    let model = &shapes::of_three()[0];
    let system = System { lagrangian: model.in_f64(), forces: Drag };
    let interval = Interval::<f64, Galerkin, 3>::new([0.1, 0.2, 0.3], [1.0, -0.4, 0.6], 0.1, Control::none());
    let l = interval.linearise(&system);
    let (slaved, reduced) = l.reduced().unwrap();
    let product = |a: &Matrix<f64, 3>, b: &Matrix<f64, 3>| -> Matrix<f64, 3> {
        core::array::from_fn(|i| core::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
    };
    assert_matrices_close("bubble_s X = bubble_w", &product(&l.bubble_s, &slaved), &l.bubble_w, 1e-13);
    let through = product(&l.momentum_s, &slaved);
    let expected: Matrix<f64, 3> =
        core::array::from_fn(|i| core::array::from_fn(|j| l.momentum_w[i][j] - through[i][j]));
    assert_matrices_close("reduced", &reduced, &expected, 1e-13);
}
