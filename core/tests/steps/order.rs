//! Orders of accuracy: slopes of the global error at a fixed time against the step size, on nonlinear systems.

use crate::common::{Random, arms, bodies, log_log_slope, trees};
use leastaction_core::continuous::{ContinuousState, acceleration, midpoint_step, momentum, rk4_step};
use leastaction_core::discrete::{Control, Del, Galerkin, Midpoint, Path, State};
use leastaction_core::energy::trigonometric::{ACROBOT, CARTPOLE, Trigonometric};
use leastaction_core::forces::{System, Viscous};
use leastaction_core::lagrangian::Lagrangian;

/// Time at which errors are compared, s; the steps divide it.
const END: f64 = 0.8;
const STEPS: [usize; 4] = [20, 40, 80, 160];

/// A motion: a system, its start, and a control that is linear in time.
#[derive(Clone, Copy)]
struct Motion<L, const N: usize> {
    system: System<L, Viscous<f64, N>>,
    q: [f64; N],
    v: [f64; N],
    u: [f64; N],
    u_rate: [f64; N],
}

type Point<const N: usize> = ([f64; N], [f64; N]);

impl<L, const N: usize> Motion<L, N>
where
    L: Lagrangian<f64, N>,
{
    fn control(&self, t: f64) -> [f64; N] {
        core::array::from_fn(|i| self.u[i] + self.u_rate[i] * t)
    }

    /// Runge–Kutta that follows the control within the step, so finely that the remaining error is rounding; returns
    /// (q, p) at the end.
    fn reference(&self) -> Point<N> {
        const FINE: usize = 4_000;
        let h = END / FINE as f64;
        let (mut q, mut v) = (self.q, self.v);
        let rate =
            |q: &[f64; N], v: &[f64; N], t| acceleration(&self.system, q, v, &self.control(t)).unwrap();
        let shift =
            |x: &[f64; N], c: f64, y: &[f64; N]| -> [f64; N] { core::array::from_fn(|i| x[i] + c * y[i]) };
        for k in 0..FINE {
            let t = k as f64 * h;
            let a1 = rate(&q, &v, t);
            let v2 = shift(&v, h / 2.0, &a1);
            let a2 = rate(&shift(&q, h / 2.0, &v), &v2, t + h / 2.0);
            let v3 = shift(&v, h / 2.0, &a2);
            let a3 = rate(&shift(&q, h / 2.0, &v2), &v3, t + h / 2.0);
            let v4 = shift(&v, h, &a3);
            let a4 = rate(&shift(&q, h, &v3), &v4, t + h);
            q = core::array::from_fn(|i| q[i] + h / 6.0 * (v[i] + 2.0 * v2[i] + 2.0 * v3[i] + v4[i]));
            v = core::array::from_fn(|i| v[i] + h / 6.0 * (a1[i] + 2.0 * a2[i] + 2.0 * a3[i] + a4[i]));
        }
        (q, momentum(&self.system.lagrangian, &q, &v))
    }

    fn discrete<P: Path>(&self, steps: usize) -> Point<N> {
        let h = END / steps as f64;
        let del = Del::<f64, P>::new(h);
        let mut state = State::new(&self.system.lagrangian, self.q, self.v).unwrap();
        for k in 0..steps {
            let (start, end) = (self.control(k as f64 * h), self.control((k + 1) as f64 * h));
            del.step(&self.system, &mut state, &Control { start, end }).unwrap();
        }
        (state.q(), state.p())
    }

    /// The slopes of the errors of position and momentum.
    fn slopes(&self, solve: impl Fn(usize) -> Point<N>) -> (f64, f64) {
        let (q, p) = self.reference();
        let distance =
            |a: &[f64; N], b: &[f64; N]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        let errors = STEPS.map(|steps| {
            let (found_q, found_p) = solve(steps);
            (END / steps as f64, distance(&found_q, &q), distance(&found_p, &p))
        });
        (log_log_slope(&errors.map(|(h, q, _)| (h, q))), log_log_slope(&errors.map(|(h, _, p)| (h, p))))
    }

    #[track_caller]
    fn assert_order(&self, name: &str, order: f64, solve: impl Fn(usize) -> Point<N>) {
        let (q, p) = self.slopes(solve);
        println!("{name}: slope {q:.3} in q, {p:.3} in p");
        assert!(
            (q - order).abs() < 0.2 && (p - order).abs() < 0.2,
            "{name}: slopes {q}, {p} instead of {order}"
        );
    }

    #[track_caller]
    fn assert_discrete_orders(&self, name: &str) {
        self.assert_order(&format!("{name}, midpoint"), 2.0, |steps| self.discrete::<Midpoint>(steps));
        self.assert_order(&format!("{name}, Galerkin"), 4.0, |steps| self.discrete::<Galerkin>(steps));
    }
}

fn acrobot(damping: [f64; 2], u: [f64; 2], u_rate: [f64; 2]) -> Motion<Trigonometric<'static, 2>, 2> {
    let system = System { lagrangian: ACROBOT, forces: Viscous { coefficients: damping } };
    Motion { system, q: [1.8, -1.1], v: [0.9, -2.3], u, u_rate }
}

fn cartpole(damping: [f64; 2], u: [f64; 2], u_rate: [f64; 2]) -> Motion<Trigonometric<'static, 2>, 2> {
    let system = System { lagrangian: CARTPOLE, forces: Viscous { coefficients: damping } };
    Motion { system, q: [0.2, 1.3], v: [-0.4, 2.1], u, u_rate }
}

#[test]
fn conservative_acrobot() {
    acrobot([0.0; 2], [0.0; 2], [0.0; 2]).assert_discrete_orders("acrobot");
}

#[test]
fn conservative_cartpole() {
    cartpole([0.0; 2], [0.0; 2], [0.0; 2]).assert_discrete_orders("cart-pole");
}

#[test]
fn damped_and_controlled_acrobot() {
    acrobot([0.4, 0.9], [0.0, 3.0], [0.0, -5.0]).assert_discrete_orders("forced acrobot");
}

#[test]
fn damped_and_controlled_cartpole() {
    cartpole([0.7, 0.02], [4.0, 0.0], [-9.0, 0.0]).assert_discrete_orders("forced cart-pole");
}

#[test]
fn cart_with_a_learned_link_and_a_rod() {
    let tree = &trees::of_three()[0];
    let motion = Motion {
        system: System::conservative(tree.in_f64()),
        q: [0.2, 1.3, -0.8],
        v: [-0.4, 2.1, 2.9],
        u: [0.0; 3],
        u_rate: [0.0; 3],
    };
    motion.assert_discrete_orders("cart, link, rod");
    let forced = Motion {
        system: tree.damped::<f64>(&tree.weights),
        u: [1.0, -0.5, 2.0],
        u_rate: [-4.0, 1.5, -3.0],
        ..motion
    };
    forced.assert_discrete_orders("forced cart, link, rod");
}

#[test]
fn a_tree_of_bodies_that_turn_and_slide() {
    let tree = &bodies::of_five()[0];
    let mut random = Random(32);
    let motion = Motion {
        system: System::conservative(tree.in_f64()),
        q: random.array(1.0),
        v: random.array(1.5),
        u: [0.0; 5],
        u_rate: [0.0; 5],
    };
    motion.assert_discrete_orders("five bodies");
    Motion { u: random.array(1.0), u_rate: random.array(3.0), ..motion }
        .assert_discrete_orders("five forced bodies");
}

#[test]
fn an_arm_that_turns_and_slides_askew() {
    let arm = &arms::of_three()[4];
    let system = System { lagrangian: arm.in_f64(), forces: Viscous { coefficients: [0.0; 3] } };
    let still = Motion { system, q: [0.4, -0.8, 0.3], v: [0.3, -0.5, 0.7], u: [0.0; 3], u_rate: [0.0; 3] };
    still.assert_discrete_orders("arm");
    let forces = Viscous { coefficients: [0.9, 0.3, 1.7] };
    let system = System { lagrangian: arm.in_f64(), forces };
    Motion { system, u: [1.0, -2.0, 0.5], u_rate: [-3.0, 1.0, 2.0], ..still }
        .assert_discrete_orders("forced arm");
}

#[test]
fn three_bodies_that_see_their_distance() {
    let tree = &trees::of_six()[0];
    let mut random = Random(31);
    Motion {
        system: System::conservative(tree.in_f64()),
        q: random.array(1.5),
        v: random.array(3.0),
        u: [0.0; 6],
        u_rate: [0.0; 6],
    }
    .assert_discrete_orders("three bodies");
}

#[test]
fn explicit_integrators() {
    let motion = acrobot([0.4, 0.9], [0.5, 3.0], [0.0, 0.0]);
    let run = |steps: usize, rk4: bool| {
        let h = END / steps as f64;
        let mut state = ContinuousState { q: motion.q, v: motion.v };
        for _ in 0..steps {
            let step = if rk4 { rk4_step } else { midpoint_step };
            state = step(&motion.system, &state, &motion.u, h).unwrap();
        }
        (state.q, momentum(&motion.system.lagrangian, &state.q, &state.v))
    };
    motion.assert_order("RK4", 4.0, |steps| run(steps, true));
    motion.assert_order("explicit midpoint", 2.0, |steps| run(steps, false));
}
