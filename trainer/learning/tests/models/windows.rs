//! The loss over windows: its derivatives, the learned sensors and actuators, and the effect of noise.

use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_core::forces::ControlKind;
use leastaction_learning::data::{Dataset, Rows, Trajectory};
use leastaction_learning::training::{Levenberg, Objective, Progress};
use leastaction_learning::windows::{
    Calibration, Integrator, Setting, WindowLogs, WindowLoss, WindowModel, WindowSettings, noise_of,
};
use leastaction_models::{Architecture, InertiaNetworkArchitecture};
use leastaction_programs::dynamics::Order;
use leastaction_programs::steps::{ExplicitSteps, RungeKutta, Steps, VariationalSteps};
use leastaction_programs::{Row, System};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::sync::Arc;

const N: usize = 2;
const H: f64 = 0.02;
const SAMPLES: usize = 61;
const LOGS: usize = 3;
const STEPS: usize = 15;
const ALL: Calibration = Calibration {
    zero: true,
    gain: Setting::Learned,
    offset: Setting::Learned,
    delay: Setting::Learned,
    lag: Setting::Known(0.0),
};

/// All numbers, and a lag, which a drive with none has not.
const WITH_LAG: Calibration = Calibration { lag: Setting::Learned, ..ALL };

fn model() -> Architecture {
    let coordinates = [Coordinate::Angle, Coordinate::Angle];
    InertiaNetworkArchitecture {
        damped: true,
        widths: vec![5],
        ..InertiaNetworkArchitecture::new(&coordinates, 0)
    }
    .into()
}

fn weights(model: &Architecture) -> Vec<f64> {
    let wave = |k: usize| (1.7 * k as f64 + 0.4).sin();
    model.initial_weights(3).iter().enumerate().map(|(k, w)| w + 0.1 * wave(k) + 0.15).collect()
}

/// Sensors and actuators of the simulated robot.
#[derive(Clone, Copy)]
struct Robot {
    gain: [f64; N],
    offset: [f64; N],
    /// Delay in whole steps, to avoid errors of resampling.
    delay: usize,
    zero: [f64; N],
    noise: f64,
}

const IDEAL: Robot = Robot { gain: [1.0; N], offset: [0.0; N], delay: 0, zero: [0.0; N], noise: 0.0 };
const REAL: Robot =
    Robot { gain: [0.8, 1.3], offset: [0.1, -0.2], delay: 2, zero: [0.03, -0.05], noise: 0.0 };

fn command(log: usize, k: usize, i: usize) -> f64 {
    let t = k as f64 * H;
    (3.0 * t + log as f64).sin() + 0.7 * (8.0 * t * (1.0 + i as f64) + 2.0 * log as f64).cos()
}

/// Logs of the model itself, by the integration steps of the loss.
fn logs(robot: Robot) -> Dataset {
    let system = System::new(&*model().energies().unwrap());
    logs_by(robot, (&mut ExplicitSteps::new(&system, 0.5 * H, RungeKutta::ThreeEighths), 2))
}

/// Logs of the model by DEL steps from sample to sample.
fn del_logs(robot: Robot, order: Order) -> Dataset {
    let system = System::new(&*model().energies().unwrap());
    logs_by(robot, (&mut VariationalSteps::new(&system, H, order), 1))
}

/// Logs of the model by `count` steps per sample.
fn logs_by(robot: Robot, (steps, count): (&mut dyn Steps, usize)) -> Dataset {
    let (weights, mut stream) = (weights(&model()), Pcg64::seed_from_u64(5));
    let mut trajectory = |log: usize| {
        let mut state: Vec<Row> = (0..2 * N).map(|i| Row::splat(0.3 * (i + log) as f64 - 0.5)).collect();
        steps.begin(&weights, &mut state, None);
        let (mut q, mut u) = (Vec::new(), Vec::new());
        for k in 0..SAMPLES {
            let sensor = |i: usize| state[i].0[0] + robot.zero[i];
            q.extend((0..N).map(|i| sensor(i) + robot.noise * stream.random_range(-1.0..1.0)));
            u.extend((0..N).map(|i| command(log, k, i)));
            let arrived = k.saturating_sub(robot.delay);
            let force = |i: usize| robot.gain[i] * command(log, arrived, i) + robot.offset[i];
            let tau: Vec<Row> = (0..N).map(|i| Row::splat(force(i))).collect();
            for _ in 0..count {
                let _ = steps.step(&weights, &mut state, [&tau, &tau], None);
            }
        }
        let rows = |x| Rows::from_flat(N, x).unwrap();
        Trajectory { id: log as i64, t0: 0.0, q: rows(q), v: None, a: None, u: Some(rows(u)) }
    };
    let trajectories = (0..LOGS).map(&mut trajectory).collect();
    Dataset { n: N, h: H, control: Some(ControlKind::Held), trajectories }
}

fn loss(data: &Dataset, calibration: Calibration, known: bool) -> WindowLoss {
    loss_over(data, STEPS, calibration, known)
}

fn loss_over(data: &Dataset, steps: usize, calibration: Calibration, known: bool) -> WindowLoss {
    loss_by((Integrator::RungeKutta, 4), data, (steps, calibration, known))
}

fn loss_by(
    (integrator, order): (Integrator, u8),
    data: &Dataset,
    (steps, calibration, known): (usize, Calibration, bool),
) -> WindowLoss {
    let architecture = model();
    let mut model = WindowModel::new(&architecture).unwrap();
    if known {
        model.fixed = (0..architecture.parameters().unwrap()).collect();
    }
    let settings =
        WindowSettings { steps, stride: steps, integrator, longest_step: 0.5 * H, order, calibration };
    let logs = Arc::new(WindowLogs::new(data));
    WindowLoss::new(model, &logs, 0..LOGS, settings).unwrap()
}

/// The weights with their best start states.
fn completed(loss: &dyn Objective, weights: &[f64]) -> Vec<f64> {
    let mut weights = weights.to_vec();
    (0..6).for_each(|_| {
        let _ = loss.completed_loss(&mut weights);
    });
    weights
}

/// The gradient at constant start states equals that of the loss with the best start states (variable projection).
#[test]
fn the_gradient_is_that_of_the_loss_over_the_best_starts() {
    let data = logs(Robot { noise: 0.05, ..REAL });
    for by in [(Integrator::RungeKutta, 4), (Integrator::Del, 2), (Integrator::Del, 4)] {
        for calibration in [ALL, WITH_LAG] {
            check_gradient(&loss_by(by, &data, (STEPS, calibration, false)));
        }
    }
    // Samples that are joined to longer steps, and commands that are linear between samples.
    let linear = Dataset { control: Some(ControlKind::Linear), ..data };
    check_gradient(&loss_by((Integrator::RungeKutta, 4), &linear, (STEPS, WITH_LAG, false)));
}

/// Number of directions, each a change of all numbers with random signs: a number with a wrong derivative shows in every direction.
const DIRECTIONS: usize = 8;

fn check_gradient(of: &WindowLoss) {
    let loss: &dyn Objective = of;
    let mut start = weights(&model());
    start.iter_mut().for_each(|w| *w *= 1.1);
    let mut all = loss.enter(start);
    let shared = loss.shared();
    // The delay is a fraction of a step, where its derivative exists.
    all[of.layout().delay()] = 0.3 * H;
    of.layout().lag().iter().for_each(|lag| all[*lag] = 0.4 * H);
    loss.settle(&mut all);
    let all = completed(loss, &all);
    let equations = loss.normal_equations(&all).unwrap();
    assert_eq!(equations.gradient.len(), shared);
    let scale = equations.gradient.iter().map(|g| g.abs()).fold(0.0, f64::max);
    let mut stream = Pcg64::seed_from_u64(11);
    for direction in 0..DIRECTIONS {
        let signs: Vec<f64> = (0..shared).map(|_| if stream.random() { 1.0 } else { -1.0 }).collect();
        let moved = |by: f64| {
            let mut moved = all.clone();
            moved.iter_mut().zip(&signs).for_each(|(weight, sign)| *weight += by * sign);
            loss.loss(&completed(loss, &moved))
        };
        let step = 1e-5;
        let slope = (moved(step) - moved(-step)) / (2.0 * step);
        let along: f64 = equations.gradient.iter().zip(&signs).map(|(g, sign)| g * sign).sum();
        let own = 2.0 * along / equations.rows as f64;
        let most = 1e-4 * 2.0 * scale / equations.rows as f64;
        assert!((own - slope).abs() < most, "direction {direction}: {own} and {slope}");
    }
}

/// All sensor and actuator numbers of a known model are found, and on exact data no residual is left.
#[test]
fn sensors_and_actuators_are_found() {
    let loss = loss(&logs(REAL), ALL, true);
    let layout = loss.layout();
    let fit = Levenberg::new(&loss, weights(&model())).run(&loss, 60, |_, _| ());
    let found = layout.read(&fit.weights);
    let near = |own: &[f64], other: &[f64]| own.iter().zip(other).all(|(a, b)| (a - b).abs() < 2e-3);
    assert!(
        near(&found.actuator.gain, &REAL.gain) && near(&found.actuator.offset, &REAL.offset),
        "{found:?}"
    );
    assert!((found.actuator.delay - 2.0 * H).abs() < 2e-4, "{found:?}");
    assert!(found.zeros.iter().all(|zero| near(zero, &REAL.zero)), "{found:?}");
}

/// Time constant and delay of a drive that lags, s.
const LAGS: [f64; 2] = [0.008, 0.003];

/// Logs of a robot whose commands arrive late and behind a lag, T ẏ = u(t − d) − y, integrated in steps of 0.5 ms.
fn lagging_logs(noise: f64) -> Dataset {
    const PARTS: usize = 40;
    let ([lag, delay], h) = (LAGS, H / PARTS as f64);
    let system = System::new(&*model().energies().unwrap());
    let mut steps = ExplicitSteps::new(&system, h, RungeKutta::ThreeEighths);
    let (weights, mut stream) = (weights(&model()), Pcg64::seed_from_u64(6));
    let mut trajectory = |log: usize| {
        let mut state: Vec<Row> = (0..2 * N).map(|i| Row::splat(0.3 * (i + log) as f64 - 0.5)).collect();
        steps.begin(&weights, &mut state, None);
        let (mut q, mut u) = (Vec::new(), Vec::new());
        let mut y: [f64; N] = std::array::from_fn(|i| command(log, 0, i));
        for k in 0..SAMPLES {
            q.extend((0..N).map(|i| state[i].0[0] + noise * stream.random_range(-1.0..1.0)));
            u.extend((0..N).map(|i| command(log, k, i)));
            for part in 0..PARTS {
                let late = (part as f64 + 0.5) * h < delay;
                let arrived = k.saturating_sub(usize::from(late));
                let after = |y: f64, i: usize| {
                    let u = command(log, arrived, i);
                    u + (y - u) * (-h / lag).exp()
                };
                let next: [f64; N] = std::array::from_fn(|i| after(y[i], i));
                let tau = [y, next].map(|y| y.map(Row::splat).to_vec());
                let _ = steps.step(&weights, &mut state, [&tau[0], &tau[1]], None);
                y = next;
            }
        }
        let rows = |x| Rows::from_flat(N, x).unwrap();
        Trajectory { id: log as i64, t0: 0.0, q: rows(q), v: None, a: None, u: Some(rows(u)) }
    };
    let trajectories = (0..LOGS).map(&mut trajectory).collect();
    Dataset { n: N, h: H, control: Some(ControlKind::Held), trajectories }
}

/// A lag is told from the delay before it, where a delay alone leaves a residual. Noise that hides the difference leaves their sum.
#[test]
fn a_lag_is_found_beside_a_delay() {
    let fitted = |noise: f64, lag| {
        let calibration = Calibration { delay: Setting::Learned, lag, ..Calibration::default() };
        let loss = loss(&lagging_logs(noise), calibration, true);
        let fit = Levenberg::new(&loss, weights(&model())).run(&loss, 60, |_, _| ());
        (loss.layout().read(&fit.weights).actuator, fit.loss.sqrt())
    };
    let [lag, delay] = LAGS;
    let (found, residual) = fitted(0.0, Setting::Learned);
    println!("lag {}, delay {}, residual {residual:.1e}", found.lag, found.delay);
    assert!((found.lag / lag - 1.0).abs() < 0.002 && (found.delay / delay - 1.0).abs() < 0.005, "{found:?}");
    let (without, worse) = fitted(0.0, Setting::Known(0.0));
    assert!((without.delay - lag - delay).abs() < 2e-4 && worse > 100.0 * residual, "{without:?}: {worse}");
    assert_eq!(without.lag, 0.0);
    let (known, _) = fitted(0.0, Setting::Known(lag));
    assert!(known.lag == lag && (known.delay / delay - 1.0).abs() < 0.005, "{known:?}");
    let (noisy, _) = fitted(1e-4, Setting::Learned);
    assert!((noisy.lag + noisy.delay - lag - delay).abs() < 2e-4, "{noisy:?}");
}

/// A penalty on weights does not act on sensors and actuators: a gain is expected near 1, not near 0.
#[test]
fn weight_decay_leaves_sensors_and_actuators_alone() {
    let loss = loss(&logs(REAL), ALL, true);
    let gains = [0.0, 3e-2].map(|decay| {
        let mut fit = Levenberg::new(&loss, weights(&model())).with_decay(decay);
        (0..6).for_each(|_| {
            let _ = fit.iterate(&loss);
        });
        loss.layout().read(&fit.weights).actuator.gain
    });
    assert!(gains[0].iter().zip(&gains[1]).all(|(own, with)| (own - with).abs() < 1e-6), "{gains:?}");
}

/// Numbers that are not learned keep their known values.
#[test]
fn what_is_known_stays() {
    let known =
        Calibration { gain: Setting::Known(0.5), delay: Setting::Known(0.01), ..Calibration::default() };
    let loss = loss(&logs(IDEAL), known, false);
    let fit = Levenberg::new(&loss, weights(&model())).run(&loss, 3, |_, _| ());
    let found = loss.layout().read(&fit.weights);
    assert_eq!(
        (found.actuator.gain, found.actuator.offset, found.actuator.delay),
        (vec![0.5; N], vec![0.0; N], 0.01)
    );
    assert!(found.zeros.iter().flatten().all(|zero| *zero == 0.0));
}

/// Noise hardly affects a model learned over windows: from wrong weights it finds forces that predict the noise-free motion.
#[test]
fn a_model_is_learned_through_noise() {
    let noise = 0.02;
    let noisy = logs(Robot { noise, ..IDEAL });
    assert!(noise_of(&noisy).is_some() && noise_of(&logs(IDEAL)).is_none());
    let start = model().initial_weights(9);
    let long = |data: &Dataset| loss_over(data, 3 * STEPS, Calibration::default(), false);
    let (training, truth) = (long(&noisy), long(&logs(IDEAL)));
    let before = Objective::held_back_loss(&truth, &start).sqrt();
    let fit = Levenberg::new(&training, start).run(&training, 40, |_, _| ());
    let after = Objective::held_back_loss(&truth, &fit.weights[..Objective::shared(&truth)]).sqrt();
    assert!(after < 0.3 * noise && after < 0.25 * before, "from {before} to {after}");
}

/// Logs by DEL steps are explained only by the same steps: steps of the other order, and motion in continuous time, are off by the step's
/// discretisation error.
#[test]
fn windows_by_del_steps_are_their_own() {
    for (order, own, others) in [
        (Order::Two, (Integrator::Del, 2), [(Integrator::Del, 4), (Integrator::RungeKutta, 4)]),
        (Order::Four, (Integrator::Del, 4), [(Integrator::Del, 2), (Integrator::RungeKutta, 2)]),
    ] {
        let data = del_logs(IDEAL, order);
        let off = |by| {
            let loss = loss_by(by, &data, (STEPS, Calibration::default(), true));
            Objective::loss(&loss, &completed(&loss, &Objective::enter(&loss, weights(&model())))).sqrt()
        };
        assert!(off(own) < 1e-12, "{order:?}: {}", off(own));
        let others = others.map(off);
        assert!(others.iter().all(|other| *other > 1e-8), "{order:?}: {others:?}");
    }
}

#[test]
fn a_fit_is_the_same_bits_on_any_number_of_threads() {
    for by in [(Integrator::RungeKutta, 4), (Integrator::Del, 4)] {
        check_threads(by);
    }
}

fn check_threads(by: (Integrator, u8)) {
    let fit = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let loss = loss_by(by, &logs(Robot { noise: 0.01, ..REAL }), (STEPS, ALL, false));
            let mut fit = Levenberg::new(&loss, weights(&model()));
            (0..3).for_each(|_| assert_eq!(fit.iterate(&loss), Progress::Lower));
            (fit.weights, fit.loss)
        })
    };
    assert_eq!(fit(1), fit(3));
}

/// Windows in which a model's motion cannot be computed are counted; they do not fail the loss.
#[test]
fn windows_that_cannot_be_computed_are_counted() {
    let loss = loss(&logs(IDEAL), Calibration::default(), false);
    let mut all = Objective::enter(&loss, weights(&model()));
    assert_eq!(Objective::solved(&loss, &all).unsolved, 0);
    all[..loss.layout().start].fill(f64::NAN);
    let solved = Objective::solved(&loss, &all);
    assert_eq!(solved.unsolved, Objective::samples(&loss));
    assert!(Objective::loss(&loss, &all).is_finite());
}
