//! RATTLE: orders of accuracy, its limit without constraints, and a constraint of the caller's own.

use crate::common::cases::{Case, Motion, distance};
use crate::common::particles::Exact;
use crate::common::{assert_close, log_log_slope};
use leastaction_core::constraints::{Constrained, Constraints, Positions};
use leastaction_core::continuous::{Drive, constrained_acceleration, constrained_workspace};
use leastaction_core::discrete::Order;
use leastaction_core::discrete::rattle::{ParticleState, Rattle};
use leastaction_core::particles::Particles;

impl Case<f64> {
    /// Classical Runge–Kutta steps of the constrained acceleration.
    fn reference(&self, end: f64, steps: usize) -> Motion<f64> {
        let mechanism = self.mechanism();
        let drive = Drive { force: self.force.as_deref(), ..Drive::none() };
        let mut workspace = vec![0.0; constrained_workspace(&mechanism)];
        let mut lambda = vec![0.0; mechanism.equations()];
        let mut rate = |(q, v): &Motion<f64>| {
            let mut a = vec![[0.0; 2]; q.len()];
            constrained_acceleration(&mechanism, (q, v), &drive, &mut workspace, (&mut a, &mut lambda))
                .unwrap();
            (v.clone(), a)
        };
        let h = end / steps as f64;
        let mut x = self.start.clone();
        for _ in 0..steps {
            let k1 = rate(&x);
            let k2 = rate(&moved(&x, h / 2.0, &k1));
            let k3 = rate(&moved(&x, h / 2.0, &k2));
            let k4 = rate(&moved(&x, h, &k3));
            for (c, k) in [(h / 6.0, &k1), (h / 3.0, &k2), (h / 3.0, &k3), (h / 6.0, &k4)] {
                x = moved(&x, c, k);
            }
        }
        x
    }

    #[track_caller]
    fn assert_orders(&self, name: &str) {
        const END: f64 = 0.8;
        let expected = self.reference(END, 8_000);
        for (order, slope) in [(Order::Two, 2.0), (Order::Four, 4.0)] {
            let errors = [40, 80, 160, 320].map(|steps| {
                let h = END / steps as f64;
                let found = self.run((h, order), steps, |_, _| ());
                (h, distance(&found.0, &expected.0), distance(&found.1, &expected.1))
            });
            let q = log_log_slope(&errors.map(|(h, q, _)| (h, q)));
            let v = log_log_slope(&errors.map(|(h, _, v)| (h, v)));
            println!("{name}, {order:?}: slope {q:.3} in q, {v:.3} in v, {errors:?}");
            assert!((q - slope).abs() < 0.2 && (v - slope).abs() < 0.2, "{name}, {order:?}: {q}, {v}");
        }
    }
}

fn moved((q, v): &Motion<f64>, c: f64, (dq, dv): &Motion<f64>) -> Motion<f64> {
    let add = |x: &[[f64; 2]], y: &[[f64; 2]]| {
        x.iter().zip(y).map(|(x, y)| [x[0] + c * y[0], x[1] + c * y[1]]).collect()
    };
    (add(q, dq), add(v, dv))
}

#[test]
fn orders_of_accuracy() {
    Case::pendulum(&[0.9, -0.4, 1.7]).assert_orders("chain");
    Case::hybrid().assert_orders("hybrid");
    Case::hybrid().forced().assert_orders("forced hybrid");
}

/// Without constraints: p½ = p + ½hF, q₁ = q + hp½/m, p₁ = p½ + ½hF₁.
#[test]
fn without_constraints_it_is_stoermer_verlet() {
    let mut case = Case::<f64>::hybrid();
    case.constraints.clear();
    case.force = Some(vec![[0.5, -0.3], [1.0, 0.2], [0.0, 0.0], [-2.0, 0.1]]);
    let (h, steps) = (0.01, 300);
    let (mut q, mut v) = case.start.clone();
    let force = |q: &[[f64; 2]]| {
        let mut f = vec![[0.0; 2]; 4];
        case.system.l_q(q, &mut [], &mut f);
        let push = case.force.as_ref().unwrap();
        (0..4).map(|i| [f[i][0] + push[i][0], f[i][1] + push[i][1]]).collect::<Vec<_>>()
    };
    for _ in 0..steps {
        for half in 0..2 {
            let f = force(&q);
            for i in 0..4 {
                for x in 0..2 {
                    v[i][x] += 0.5 * h * f[i][x] / case.system.masses[i];
                    q[i][x] += if half == 0 { h * v[i][x] } else { 0.0 };
                }
            }
        }
    }
    let found = case.run((h, Order::Two), steps, |_, _| ());
    assert!(distance(&found.0, &q) < 1e-11 && distance(&found.1, &v) < 1e-11);
}

/// A bead on the curve y = x⁴/4: a constraint that is none of [`Holonomic`].
struct Curve;

impl Constraints<f64, 2> for Curve {
    fn equations(&self) -> usize {
        1
    }

    fn nodes(&self, _: usize) -> &[usize] {
        &[0]
    }

    fn size(&self, _: usize) -> f64 {
        1.0
    }

    fn value(&self, _: usize, x: Positions<f64, 2>) -> f64 {
        let ([x, y], [x_carry, y_carry]) = x.node(0);
        (y - x.powi(4) / 4.0) + (y_carry - x.powi(3) * x_carry)
    }

    fn gradient(&self, _: usize, _: usize, x: Positions<f64, 2>) -> [f64; 2] {
        [-x.node(0).0[0].powi(3), 1.0]
    }

    fn curvature(&self, _: usize, x: Positions<f64, 2>, v: &[[f64; 2]]) -> f64 {
        -3.0 * (x.node(0).0[0] * v[0][0]).powi(2)
    }
}

/// (1 + x⁶) ẍ = −3x⁵ ẋ² − g x³, by Runge–Kutta.
fn bead(mut x: [f64; 2], end: f64, steps: usize) -> [f64; 2] {
    let h = end / steps as f64;
    let rate = |[x, v]: [f64; 2]| [v, -(3.0 * x.powi(5) * v * v + 10.0 * x.powi(3)) / (1.0 + x.powi(6))];
    let shift = |x: [f64; 2], c: f64, k: [f64; 2]| [x[0] + c * k[0], x[1] + c * k[1]];
    for _ in 0..steps {
        let k1 = rate(x);
        let k2 = rate(shift(x, h / 2.0, k1));
        let k3 = rate(shift(x, h / 2.0, k2));
        let k4 = rate(shift(x, h, k3));
        for (c, k) in [(h / 6.0, k1), (h / 3.0, k2), (h / 3.0, k3), (h / 6.0, k4)] {
            x = shift(x, c, k);
        }
    }
    x
}

#[test]
fn a_bead_follows_a_curve_of_the_callers_own() {
    let system = Exact::<f64, 2>::under_gravity(&[1.7], 10.0);
    let mechanism = Constrained::new(&system, &Curve).unwrap();
    let mut workspace = vec![0.0; ParticleState::<f64, 2>::workspace(1, 1)];
    let mut work = vec![0.0; Rattle::workspace(&mechanism)];
    let (x, v) = (0.9_f64, 1.1);
    let (q, velocity) = ([[x, x.powi(4) / 4.0]], [[v, x.powi(3) * v]]);

    let (mut a, mut lambda) = ([[0.0; 2]], [0.0]);
    let drive = Drive::none();
    constrained_acceleration(&mechanism, (&q, &velocity), &drive, &mut work, (&mut a, &mut lambda)).unwrap();
    let expected = -(3.0 * x.powi(5) * v * v + 10.0 * x.powi(3)) / (1.0 + x.powi(6));
    assert_close("acceleration", a[0][0], expected, 1e-14);

    let mut state = ParticleState::new(&mechanism, &q, &velocity, &mut workspace, &mut work).unwrap();
    let rattle = Rattle::new(1e-3, Order::Four);
    for _ in 0..1_000 {
        rattle.step(&mechanism, &mut state, None, &mut work).unwrap();
    }
    let [x, v] = bead([x, v], 1.0, 20_000);
    assert_close("x", state.q()[0][0], x, 1e-10);
    assert_close("v", state.v()[0][0], v, 1e-9);
    let [x, y] = state.q()[0];
    assert!((y - x.powi(4) / 4.0).abs() < 1e-15);
}
