//! Regulators of any size: against core's, against a simulation, and with drives that act late.

use leastaction_core::control::Transition;
use leastaction_core::control::riccati::{Weights, stationary};
use leastaction_core::forces::Rise;
use leastaction_planning::{DMatrix, LinearSystem, LqrError};

/// Cart-pole about its upper rest, exactly sampled: state (x, φ, ẋ, φ̇) with masses, rod and gravity of about 1, 0.1, 1 and 10.
fn continuous() -> (DMatrix<f64>, DMatrix<f64>) {
    let a = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, -0.1, 0.0, 0.0, 11.0, 0.1, -0.05];
    (DMatrix::from_row_slice(4, 4, &a), DMatrix::from_row_slice(4, 1, &[0.0, 0.0, 1.0, -1.0]))
}

/// Transition over a time, s, under a held control.
fn sampled((a, b): &(DMatrix<f64>, DMatrix<f64>), seconds: f64) -> LinearSystem {
    let (n, m) = b.shape();
    let mut flow = DMatrix::zeros(n + m, n + m);
    flow.view_mut((0, 0), (n, n)).copy_from(&(seconds * a));
    flow.view_mut((0, n), (n, m)).copy_from(&(seconds * b));
    let flow = flow.exp();
    LinearSystem::new(flow.view((0, 0), (n, n)).into(), flow.view((0, n), (n, m)).into()).unwrap()
}

const STEP: f64 = 0.05;

fn weights(states: usize) -> (DMatrix<f64>, DMatrix<f64>) {
    let mut q = DMatrix::zeros(states, states);
    for (i, weight) in [1.0, 4.0, 0.25, 0.5].into_iter().enumerate() {
        q[(i, i)] = weight;
    }
    (q, DMatrix::from_element(1, 1, 0.3))
}

fn assert_near(found: &DMatrix<f64>, expected: &DMatrix<f64>, error: f64) {
    assert!((found - expected).amax() <= error * expected.amax(), "{found} is not {expected}");
}

#[test]
fn a_regulator_is_that_of_core() {
    let system = sampled(&continuous(), STEP);
    let (q, r) = weights(4);
    let found = system.regulator(&q, &r).unwrap();
    let transition = Transition {
        a: std::array::from_fn(|i| std::array::from_fn(|j| system.a()[(i, j)])),
        b: std::array::from_fn(|i| [system.b()[(i, 0)]]),
    };
    let weights = Weights { x: std::array::from_fn(|i| q[(i, i)]), u: [r[(0, 0)]] };
    let core = stationary::<f64, 4, 1>(&transition, &weights).unwrap();
    assert_near(&found.gain, &DMatrix::from_fn(1, 4, |_, j| core.gain[0][j]), 1e-10);
    assert_near(&found.cost, &DMatrix::from_fn(4, 4, |i, j| core.cost[i][j]), 1e-10);
}

#[test]
fn weights_may_couple_states_and_controls() {
    // The cost is that of other coordinates x = Tz, u = Sw: gains and costs change with them.
    let random = |rows: usize, columns: usize, seed: usize| {
        DMatrix::from_fn(rows, columns, |i, j| ((seed + 7 * i + 3 * j * j + 11 * i * j) as f64).sin())
    };
    let system = LinearSystem::new(random(5, 5, 1), random(5, 2, 2)).unwrap();
    let mixing =
        |size: usize, seed: usize| random(size, size, seed) + 2.0 * DMatrix::<f64>::identity(size, size);
    let (t, s) = (mixing(5, 3), mixing(2, 4));
    let inverse = t.clone().try_inverse().unwrap();
    let moved = LinearSystem::new(&inverse * system.a() * &t, &inverse * system.b() * &s).unwrap();
    let plain = system.regulator(&DMatrix::identity(5, 5), &DMatrix::identity(2, 2)).unwrap();
    let coupled = moved.regulator(&(t.transpose() * &t), &(s.transpose() * &s)).unwrap();
    assert_near(&(&s * coupled.gain), &(plain.gain * &t), 1e-9);
    assert_near(&coupled.cost, &(t.transpose() * plain.cost * &t), 1e-9);
}

/// Cost of the motion from a start under a gain, the drive acting `late` seconds late, by the exact flow between all changes of the
/// command; and the size of the state that is left.
fn simulated(gain: &DMatrix<f64>, late: f64, start: &DMatrix<f64>) -> (f64, f64) {
    let (q, r) = weights(4);
    let whole = (late / STEP) as usize;
    let part = late - whole as f64 * STEP;
    let (first, rest) = (sampled(&continuous(), part), sampled(&continuous(), STEP - part));
    let past = (gain.ncols() - 4) as isize;
    let mut x = start.rows(0, 4).into_owned();
    // The latest command comes last; those before the start are states of it.
    let mut sent: Vec<f64> = (0..past as usize).rev().map(|k| start[4 + k]).collect();
    sent.splice(0..0, [0.0; 8]);
    let mut cost = 0.0;
    for _ in 0..1000 {
        let known = sent.iter().rev().take(past as usize).copied();
        let state = DMatrix::from_iterator(gain.ncols(), 1, x.iter().copied().chain(known));
        let u = -(gain * state)[0];
        cost += (x.transpose() * &q * &x)[0] + r[0] * u * u;
        sent.push(u);
        let acting = |age: usize| sent[sent.len() - 1 - age];
        x = first.a() * x + first.b() * acting(whole + 1);
        x = rest.a() * x + rest.b() * acting(whole);
    }
    (cost, x.amax())
}

#[test]
fn a_late_drive_is_stabilised_at_the_cost_that_is_foretold() {
    for late in [0.0, 0.02, STEP, 0.085, 2.0 * STEP, 0.13] {
        let steps = late / STEP;
        let system = sampled(&continuous(), STEP).delayed(steps).unwrap();
        let size = 4 + steps.ceil() as usize;
        assert_eq!(system.a().shape(), (size, size), "{late} s");
        let (q, r) = (weights(size).0, weights(4).1);
        let regulator = system.regulator(&q, &r).unwrap();
        let start = DMatrix::from_fn(size, 1, |i, _| [0.3, 0.1, -0.2, 0.15, 0.5, -0.4, 0.7][i]);
        let (cost, left) = simulated(&regulator.gain, late, &start);
        let foretold = (start.transpose() * &regulator.cost * &start)[0];
        assert!((cost - foretold).abs() < 1e-8 * foretold, "{late} s: {cost}, foretold {foretold}");
        assert!(left < 1e-6, "{late} s: {left} is left");
    }
}

#[test]
fn a_gain_that_ignores_the_delay_is_worse() {
    let late = 0.13;
    let (q, r) = weights(4);
    let prompt = sampled(&continuous(), STEP).regulator(&q, &r).unwrap();
    let mut ignorant = DMatrix::zeros(1, 7);
    ignorant.view_mut((0, 0), (1, 4)).copy_from(&prompt.gain);
    let start = DMatrix::from_column_slice(7, 1, &[0.3, 0.1, -0.2, 0.15, 0.0, 0.0, 0.0]);
    let system = sampled(&continuous(), STEP).delayed(late / STEP).unwrap();
    let aware = system.regulator(&weights(7).0, &r).unwrap();
    let (worse, _) = simulated(&ignorant, late, &start);
    let (better, _) = simulated(&aware.gain, late, &start);
    assert!(worse.is_nan() || worse > 1.5 * better, "{worse} {better}");
}

#[test]
fn whole_steps_of_delay_feed_back_what_will_be() {
    // With d steps of delay, u = −K x̂ of the prompt gain K, x̂ being the state in d steps under the commands already sent.
    let prompt = sampled(&continuous(), STEP);
    let (q, r) = weights(4);
    let gain = prompt.regulator(&q, &r).unwrap().gain;
    let (a, b) = (prompt.a(), prompt.b());
    let late = prompt.delayed(2.0).unwrap().regulator(&weights(6).0, &r).unwrap();
    let mut expected = DMatrix::zeros(1, 6);
    expected.view_mut((0, 0), (1, 4)).copy_from(&(&gain * a * a));
    expected[4] = (&gain * b)[0];
    expected[5] = (&gain * a * b)[0];
    assert_near(&late.gain, &expected, 1e-8);
}

#[test]
fn parts_of_a_long_step_are_exact() {
    // A step so long that its logarithm needs square roots, of an oscillation of 2.2 rad a step.
    let (a, b) = (
        DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -4.0, -0.3]),
        DMatrix::from_row_slice(2, 1, &[0.0, 900.0]),
    );
    let long = 1.1;
    let late = sampled(&(a.clone(), b.clone()), long).delayed(0.3).unwrap();
    let now = sampled(&(a, b), 0.7 * long);
    assert_near(&late.b().view((0, 0), (2, 1)).into(), now.b(), 1e-9);
}

#[test]
fn late_by_rounding_is_not_late() {
    let system = sampled(&continuous(), STEP);
    assert_eq!(system.delayed(0.3 / 0.1).unwrap(), system.delayed(3.0).unwrap());
    assert_eq!(system.delayed(0.0).unwrap(), system);
}

fn of(rows: usize, a: &[f64], b: &[f64]) -> LinearSystem {
    LinearSystem::new(
        DMatrix::from_row_slice(rows, rows, a),
        DMatrix::from_row_slice(rows, b.len() / rows, b),
    )
    .unwrap()
}

#[test]
fn what_has_no_regulator_is_refused() {
    let one = DMatrix::identity(1, 1);
    let both = DMatrix::identity(2, 2);
    let growing = of(2, &[1.2, 0.0, 0.0, 0.5], &[0.0, 1.0]);
    assert_eq!(growing.regulator(&both, &one), Err(LqrError::NotStabilisable));
    let standing = of(2, &[1.0, 0.0, 0.0, 0.5], &[0.0, 1.0]);
    assert_eq!(standing.regulator(&both, &one), Err(LqrError::NotStabilisable));
    let reached = of(2, &[1.2, 0.0, 0.0, 0.5], &[1.0, 1.0]);
    let blind = DMatrix::from_row_slice(2, 2, &[0.0, 0.0, 0.0, 1.0]);
    assert_eq!(reached.regulator(&blind, &one), Err(LqrError::Unseen));
    assert!(reached.regulator(&both, &one).is_ok());
}

#[test]
fn matrices_that_do_not_fit_are_refused() {
    let system = of(2, &[1.0, 0.1, 0.0, 1.0], &[0.0, 0.1]);
    let (one, both) = (DMatrix::identity(1, 1), DMatrix::identity(2, 2));
    let shape = |name, found, needed| Err(LqrError::Shape { name, found, needed });
    assert_eq!(system.regulator(&one, &one), shape("Q", (1, 1), (2, 2)));
    assert_eq!(system.regulator(&both, &both), shape("R", (2, 2), (1, 1)));
    let tall = LinearSystem::new(DMatrix::zeros(3, 2), DMatrix::zeros(3, 1));
    assert_eq!(tall.unwrap_err().to_string(), "A is a matrix of 3 × 2 numbers; it must have 3 × 3");
    let weights = |q: &[f64], r: f64| {
        system.regulator(&DMatrix::from_row_slice(2, 2, q), &DMatrix::from_element(1, 1, r))
    };
    let refused = |name, needed| Err(LqrError::Weights { name, needed });
    assert_eq!(weights(&[1.0, 0.5, 0.0, 1.0], 1.0), refused("Q", "positive semidefinite"));
    assert_eq!(weights(&[1.0, 0.0, 0.0, -1.0], 1.0), refused("Q", "positive semidefinite"));
    assert_eq!(weights(&[1.0, 0.0, 0.0, 1.0], 0.0), refused("R", "positive definite"));
    let missing = weights(&[1.0, 0.0, f64::NAN, 1.0], 1.0);
    assert_eq!(missing, Err(LqrError::NotFinite { name: "Q", row: 1, column: 0 }));
}

#[test]
fn delays_without_a_meaning_are_refused() {
    let system = sampled(&continuous(), STEP);
    for steps in [-1.0, 1e6, f64::INFINITY] {
        assert_eq!(system.delayed(steps), Err(LqrError::Delay { steps }));
    }
    assert!(system.delayed(f64::NAN).is_err());
    // A sign that alternates every step has no half step, nor has a state that is forgotten in one.
    for factor in [-0.5, 0.0] {
        assert_eq!(of(1, &[factor], &[1.0]).delayed(0.5), Err(LqrError::NoFraction));
        assert!(of(1, &[factor], &[1.0]).delayed(1.0).is_ok());
    }
}

/// A mass under a lag, ẍ = y: y, ∫y and ∫∫y over a step have the closed form that steps of a model use.
#[test]
fn a_lag_is_a_state() {
    let mass = LinearSystem::new(
        DMatrix::from_row_slice(2, 2, &[1.0, STEP, 0.0, 1.0]),
        DMatrix::from_row_slice(2, 1, &[0.5 * STEP * STEP, STEP]),
    )
    .unwrap();
    for steps in [0.02, 0.4, 1.7, 25.0] {
        let [value, first, second, _] = Rise::new(steps, 1.0).integrals;
        let lagged = mass.lagged(steps).unwrap();
        let (h, square) = (STEP, STEP * STEP);
        let a = [1.0, h, square * (0.5 - second), 0.0, 1.0, h * (1.0 - first), 0.0, 0.0, 1.0 - value];
        assert_near(lagged.a(), &DMatrix::from_row_slice(3, 3, &a), 1e-11);
        assert_near(lagged.b(), &DMatrix::from_row_slice(3, 1, &[square * second, h * first, value]), 1e-11);
    }
    assert_eq!(mass.lagged(0.0).unwrap(), mass);
    assert_eq!(mass.lagged(-0.5), Err(LqrError::Lag { steps: -0.5 }));
    assert!(mass.lagged(f64::NAN).is_err() && mass.lagged(f64::INFINITY).is_err());
    let turned =
        LinearSystem::new(DMatrix::from_element(1, 1, -0.5), DMatrix::from_element(1, 1, 1.0)).unwrap();
    assert_eq!(turned.lagged(0.5), Err(LqrError::NoMotion));
}

/// A regulator that knows the lag leaves the cost that it says, along the continuous motion behind lag and delay.
#[test]
fn a_lag_behind_a_delay_is_regulated() {
    let (lag, late) = (0.04, 0.3);
    let system = sampled(&continuous(), STEP).lagged(lag / STEP).unwrap().delayed(late).unwrap();
    let (q, r) = weights(6);
    let found = system.regulator(&q, &r).unwrap();
    // x, y and u as states of the continuous motion.
    let (a, b) = continuous();
    let (mut flow, mut state) =
        (DMatrix::zeros(6, 6), DMatrix::from_column_slice(6, 1, &[0.1, 0.05, 0.0, -0.1, 0.2, -0.3]));
    flow.view_mut((0, 0), (4, 4)).copy_from(&a);
    flow.view_mut((0, 4), (4, 1)).copy_from(&b);
    (flow[(4, 4)], flow[(4, 5)]) = (-1.0 / lag, 1.0 / lag);
    let [before, after] = [late, 1.0 - late].map(|part| (part * STEP * &flow).exp());
    let promised = (state.transpose() * &found.cost * &state)[(0, 0)];
    let mut cost = 0.0;
    for _ in 0..600 {
        let u = -(&found.gain * &state)[(0, 0)];
        cost += (state.transpose() * &q * &state)[(0, 0)] + r[(0, 0)] * u * u;
        let mut moved = &before * &state;
        moved[(5, 0)] = u;
        state = &after * moved;
    }
    assert!((cost / promised - 1.0).abs() < 1e-8, "{cost} and {promised}");
    let blind = sampled(&continuous(), STEP).delayed(late).unwrap().regulator(&weights(5).0, &r).unwrap();
    let gain = DMatrix::from_fn(1, 6, |_, j| match j {
        4 => 0.0,
        5 => blind.gain[(0, 4)],
        j => blind.gain[(0, j)],
    });
    let without =
        system.closed_loop(&gain).complex_eigenvalues().iter().map(|e| e.norm()).fold(0.0, f64::max);
    let with =
        system.closed_loop(&found.gain).complex_eigenvalues().iter().map(|e| e.norm()).fold(0.0, f64::max);
    assert!(with < 1.0 && with < without, "{with} and {without}");
}
