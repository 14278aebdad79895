//! The equations of a step: SyMo's equations, those of the discrete Lagrangian, and their exact Jacobian.

use crate::common::shapes::{self, Model};
use crate::common::{Random, assert_close, assert_matrices_close, dual};
use leastaction_core::discrete::{
    Balance, Control, Del, Galerkin, GaussPoint, Interval, Linearised, Midpoint, Path, State, Variation,
};
use leastaction_core::energy::trigonometric::{ACROBOT, CARTPOLE};
use leastaction_core::forces::{Forces, System, Viscous};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::linear::{Matrix, add_scaled};

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

/// A damping that depends on the angle, so that no derivative of the force vanishes.
#[derive(Clone, Copy)]
struct Drag;

impl<const N: usize> Forces<f64, N> for Drag {
    fn force(&self, q: &[f64; N], v: &[f64; N], _: &[f64; N]) -> [f64; N] {
        core::array::from_fn(|i| -(1.0 + 0.5 * q[i].sin()) * v[i] + 0.3 * v[(i + 1) % N] * q[i])
    }

    fn derivatives(&self, q: &[f64; N], v: &[f64; N], _: &[f64; N]) -> (Matrix<f64, N>, Matrix<f64, N>) {
        let (mut in_q, mut in_v) = ([[0.0; N]; N], [[0.0; N]; N]);
        for i in 0..N {
            in_q[i][i] = -0.5 * q[i].cos() * v[i] + 0.3 * v[(i + 1) % N];
            in_v[i][i] -= 1.0 + 0.5 * q[i].sin();
            in_v[i][(i + 1) % N] += 0.3 * q[i];
        }
        (in_q, in_v)
    }

    fn load_derivative(&self, _: &[f64; N], _: &[f64; N], _: &[f64; N]) -> Matrix<f64, N> {
        [[0.0; N]; N]
    }
}

/// Changes of the three momenta of an interval along a direction of its unknowns, by central differences.
struct Slopes<const N: usize> {
    momentum: [f64; N],
    bubble: [f64; N],
    end_momentum: [f64; N],
}

/// Slopes along (dw, ds).
fn slopes<P: Path, F: Forces<f64, N>, L: Lagrangian<f64, N>, const N: usize>(
    interval: &Interval<f64, P, N>,
    system: &System<L, F>,
    [dw, ds]: [[f64; N]; 2],
) -> Slopes<N> {
    const STEP: f64 = 1e-5;
    let zero = [0.0; N];
    let at = |c: f64| -> Balance<f64, N> {
        interval.moved(&add_scaled(&zero, c, &dw), &add_scaled(&zero, c, &ds)).balance(system)
    };
    let (forth, back) = (at(STEP), at(-STEP));
    let slope = |a: [f64; N], b: [f64; N]| core::array::from_fn(|i| (a[i] - b[i]) / (2.0 * STEP));
    Slopes {
        momentum: slope(forth.d1_ld, back.d1_ld),
        bubble: slope(forth.dm_ld, back.dm_ld),
        end_momentum: slope(forth.end_momentum(), back.end_momentum()),
    }
}

fn assert_column<const N: usize>(what: &str, found: &Matrix<f64, N>, j: usize, expected: &[f64; N]) {
    for i in 0..N {
        assert_close(what, found[i][j], expected[i], 1e-8);
    }
}

fn check_jacobian<P: Path, const N: usize>(models: &[Model<N>]) {
    for model in models {
        let mut random = Random(8);
        let (h, u) = (0.1, Control { start: random.array(1.0), end: random.array(1.0) });
        let system = System { lagrangian: model.in_f64(), forces: Drag };
        let bubble = if P::BUBBLE { random.array(0.5) } else { [0.0; N] };
        let interval =
            Interval::<f64, P, N>::new(random.array(2.0), random.array(2.0), h, u).moved(&[0.0; N], &bubble);
        let found = interval.linearise(&system);
        assert_eq!(found.balance, interval.balance(&system), "it does not depend on how it is computed");
        for j in 0..N {
            check_column(&interval, &system, &found, j);
        }
    }
}

/// Checks column j of every block.
fn check_column<P: Path, F: Forces<f64, N>, L: Lagrangian<f64, N>, const N: usize>(
    interval: &Interval<f64, P, N>,
    system: &System<L, F>,
    found: &Linearised<f64, P, N>,
    j: usize,
) {
    let (zero, along) = ([0.0; N], dual::unit(j));
    let in_w = slopes(interval, system, [along, zero]);
    assert_column("momentum_w", &found.momentum_w, j, &in_w.momentum);
    assert_eq!(found.bubble.as_ref().len(), usize::from(P::BUBBLE));
    for blocks in found.bubble.as_ref() {
        let in_s = slopes(interval, system, [zero, along]);
        assert_column("bubble_w", &blocks.bubble_w, j, &in_w.bubble);
        assert_column("momentum_s", &blocks.momentum_s, j, &in_s.momentum);
        assert_column("bubble_s", &blocks.bubble_s, j, &in_s.bubble);
        assert_column("end_momentum_s", &interval.end_momentum_s(system), j, &in_s.end_momentum);
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
        Galerkin::points::<f64>()
            .as_ref()
            .iter()
            .map(|point| {
                let (q, v) = path.point(point);
                let e = ACROBOT.energies(&q, &v);
                h * point.weight * (e.kinetic - e.potential)
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
        // The bubble moves the mid-point by hs; the bubble's equation is the derivative divided by h.
        assert_close("Dm", balance.dm_ld[i], slope(&|c| action(q0, q1, moved(&s, c))) / h, 1e-8);
    }
}

#[test]
fn variations_are_those_of_the_path() {
    let (h, point) = (0.25, GaussPoint { c: 0.3_f64, weight: 1.0 });
    let (start, end, bubble) =
        (Variation::start(&point, h), Variation::end(&point, h), Variation::bubble(&point, h));
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
    let [blocks] = &l.bubble;
    let (slaved, reduced) = blocks.reduced(&l.momentum_w).unwrap();
    let product = |a: &Matrix<f64, 3>, b: &Matrix<f64, 3>| -> Matrix<f64, 3> {
        core::array::from_fn(|i| core::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
    };
    assert_matrices_close(
        "bubble_s X = bubble_w",
        &product(&blocks.bubble_s, &slaved),
        &blocks.bubble_w,
        1e-13,
    );
    let through = product(&blocks.momentum_s, &slaved);
    let expected: Matrix<f64, 3> =
        core::array::from_fn(|i| core::array::from_fn(|j| l.momentum_w[i][j] - through[i][j]));
    assert_matrices_close("reduced", &reduced, &expected, 1e-13);
}
