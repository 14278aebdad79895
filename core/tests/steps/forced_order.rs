//! Orders of accuracy under forces that depend on the load, and behind an actuator with a delay.

use crate::common::forces::{actuator, all, dry};
use crate::common::log_log_slope;
use crate::common::network_laws::NetworkLaws;
use leastaction_core::continuous::{acceleration, momentum};
use leastaction_core::discrete::{Control, Del, Galerkin, Midpoint, Path, State};
use leastaction_core::energy::trigonometric::{ACROBOT, CARTPOLE};
use leastaction_core::forces::{Actuator, Forces, Lag, System, Viscous};
use leastaction_core::lagrangian::Lagrangian;

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

/// Combined error of position and momentum, by step size.
fn errors<const N: usize>(
    reference: impl Fn(usize) -> Point<N>,
    solve: impl Fn(usize) -> Point<N>,
) -> [(f64, f64); 4] {
    STEPS.map(|steps| {
        let ((q, p), (found_q, found_p)) = (reference(steps), solve(steps));
        let pairs = q.iter().zip(&found_q).chain(p.iter().zip(&found_p));
        (END / steps as f64, pairs.map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt())
    })
}

/// Slope of the combined error of position and momentum against the step size.
fn slope<const N: usize>(reference: impl Fn(usize) -> Point<N>, solve: impl Fn(usize) -> Point<N>) -> f64 {
    log_log_slope(&errors(reference, solve))
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

/// Steps of equal length, each under its own control.
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

/// Damping, and friction that depends on the load, under a control that is linear in time.
fn check_forced_orders<L: Lagrangian<f64, 2>, F: Forces<f64, 2>>(name: &str, lagrangian: L, forces: F) {
    let system = System { lagrangian, forces };
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
    check_forced_orders("cart-pole", CARTPOLE, all());
    check_forced_orders("acrobot", ACROBOT, all());
    // Friction whose change of sign is so wide that these steps resolve it.
    let (viscous, mut friction) = dry::<f64, 2>();
    friction.coordinates.iter_mut().for_each(|friction| friction.width *= 4.0);
    check_forced_orders("cart-pole, dry", CARTPOLE, (viscous, friction));
    check_forced_orders("acrobot, dry", ACROBOT, (viscous, friction));
}

/// A step treats the network of a potential like L, and the network of a dissipation like damping.
#[test]
fn laws_with_networks_keep_the_orders() {
    let laws = NetworkLaws::of(2, 4).scaled(0.25);
    let (dissipation, potential) = laws.in_f64::<2>();
    check_forced_orders("cart-pole, networks", CARTPOLE, (dissipation, potential));
    check_forced_orders("acrobot, networks", ACROBOT, (all::<f64, 2>(), (dissipation, potential)));
}

/// The motion under the true signal of an actuator: every step is taken in two pieces, before and after the jump or
/// bend.
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

/// Slopes of the error against the motion under the true delayed signal, for steps of orders 2 and 4.
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

/// Time constant of a lag, s, and the part of a step by which it is also late.
const LAG: (f64, f64) = (0.05, 0.3);

/// y at the part s of a step, and at its end, by the solution of T ẏ = r − y for a command r that is linear in time on each side of the jump
/// or bend.
fn lagging_at(lag: f64, y: [f64; 2], s: f64, r: impl Fn(f64, bool) -> [f64; 2]) -> [f64; 2] {
    let (_, delay) = LAG;
    let solved = |y: f64, i: usize, (from, to): (f64, f64), late: bool| {
        let slope = r(1.0, late)[i] - r(0.0, late)[i];
        let follows = |s: f64| r(s, late)[i] - lag * slope;
        follows(to) + (y - follows(from)) * (-(to - from) / lag).exp()
    };
    core::array::from_fn(|i| {
        let early = solved(y[i], i, (0.0, s.min(delay)), false);
        if s > delay { solved(early, i, (delay, s), true) } else { early }
    })
}

/// Slopes of the error against the motion under the true lagging signal, for steps of orders 2 and 4, between the two shortest steps.
fn lagging_slopes<F: Forces<f64, 2> + Copy>(forces: F, held: bool) -> [f64; 2] {
    let (system, (time, delay)) = (System { lagrangian: CARTPOLE, forces }, LAG);
    let actuator = actuator(delay);
    let commands = |k: i32, h: f64| [k - 1, k, k + 1].map(|k| command(f64::from(k) * h));
    let arrived = |[before, now, next]: [[f64; 2]; 3]| {
        move |s: f64, late: bool| -> [f64; 2] {
            core::array::from_fn(|i| match (held, late) {
                (true, late) => {
                    if late {
                        now[i]
                    } else {
                        before[i]
                    }
                }
                (false, true) => now[i] + (s - delay) * (next[i] - now[i]),
                (false, false) => now[i] + (s - delay) * (now[i] - before[i]),
            })
        }
    };
    let reference = |steps: usize| {
        let h = END / steps as f64;
        let (mut point, mut y, pieces) = (START, command(-h), 6_400 / steps);
        for k in 0..steps as i32 {
            let r = arrived(commands(k, h));
            let at = |s: f64| lagging_at(time / h, y, s, r);
            for (from, to) in [(0.0, delay), (delay, 1.0)] {
                let piece = (to - from) / pieces as f64;
                for j in 0..pieces {
                    let first = from + j as f64 * piece;
                    point = runge_kutta(&system, point, piece * h, |t| actuator.output(&at(first + t / h)));
                }
            }
            y = at(1.0);
        }
        (point.0, momentum(&system.lagrangian, &point.0, &point.1))
    };
    let solved = |steps: usize, of_four: bool| {
        let h = END / steps as f64;
        let lag = Lag::new(time / h, delay);
        let y = core::cell::Cell::new(command(-h));
        let control = |k: i32, h: f64| {
            let own = commands(k, h);
            let (force, end) = actuator.lagging(|i| {
                let [before, now, next] = own.map(|u| u[i]);
                let y = y.get()[i];
                if held { lag.held(y, before, now) } else { lag.linear(y, [before, now, next]) }
            });
            y.set(end);
            force
        };
        if of_four {
            stepped::<Galerkin, _, _>(&system, steps, control)
        } else {
            stepped::<Midpoint, _, _>(&system, steps, control)
        }
    };
    // The longer steps are as long as the lag's answer.
    [false, true].map(|of_four| log_log_slope(&errors(reference, |steps| solved(steps, of_four))[2..]))
}

/// The line in place of a lagging command keeps orders 2 and 4, also for held commands and under laws that are nonlinear in τ: y has no jumps.
#[test]
fn orders_under_a_lagging_actuator() {
    let viscous = Viscous { coefficients: [0.4, 0.9] };
    for held in [true, false] {
        for (name, [of_two, of_four]) in
            [("viscous", lagging_slopes(viscous, held)), ("all", lagging_slopes(all::<f64, 2>(), held))]
        {
            assert_order(&format!("lag, held {held}, {name}, midpoint"), 2.0, of_two);
            assert_order(&format!("lag, held {held}, {name}, Galerkin"), 4.0, of_four);
        }
    }
}

/// The linear force with the same impulse and moment keeps order 2, and order 4 if the command is linear between
/// samples. For a held command, the step of order 4 keeps order 3, order 4 if the jump is in the middle, and order 2
/// under a law that is nonlinear in τ.
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
