//! The observer in double precision, for a mechanism with dry friction.

use leastaction_core::continuous::{ContinuousState, rk4_step};
use leastaction_core::discrete::{Control, Newton, Order};
use leastaction_core::energy::trigonometric::{ACROBOT, CARTPOLE, Trigonometric};
use leastaction_core::forces::{Actuator, Coulomb, DryFriction, System, Viscous};
use leastaction_core::observer::{Commands, Integrator, Observer, Tuning, ZerosPrior};

const H: f64 = 0.01;
/// Number of sub-steps of the true motion in a step.
const FINE: u32 = 10;

type Rubbing = System<Trigonometric<'static, 2>, (Viscous<f64, 2>, Coulomb<f64, 2>)>;

fn rubbing() -> Rubbing {
    let dry = DryFriction { constant: 0.3, width: 0.1, ..DryFriction::none() };
    let forces = (Viscous { coefficients: [0.1, 0.05] }, Coulomb { coordinates: [dry; 2] });
    System { lagrangian: ACROBOT, forces }
}

fn observer(zeros: Option<ZerosPrior<f64>>) -> Observer<f64, 2> {
    let integrator = Integrator::new(Order::Four, H, Newton::default());
    Observer::new(integrator, [true; 2], Tuning { memory: 5, patience: 25, zeros })
}

/// Runs 20 s under sinusoidal commands that take effect 0.6 steps late.
fn run(zeros: [f64; 2], learn: Option<ZerosPrior<f64>>, known: f64) -> (f64, [f64; 2]) {
    run_lagging(0.0, (zeros, learn), [known, 0.0])
}

/// Runs 20 s under sinusoidal commands that take effect 0.6 steps late, then lag by `true_lag` steps, with an observer of this delay and lag.
/// Returns the largest error of the estimated velocity in the last 10 s, and the zeros.
fn run_lagging(
    true_lag: f64,
    (zeros, learn): ([f64; 2], Option<ZerosPrior<f64>>),
    [delay, lag]: [f64; 2],
) -> (f64, [f64; 2]) {
    let system = rubbing();
    let mut observer = observer(learn);
    let mut commands = Commands::new(0, Actuator { delay, ..Actuator::ideal() }).with_lag(lag);
    let mut state = ContinuousState { q: [0.5, -0.3], v: [0.0; 2] };
    let (mut before, mut y, mut worst) = ([0.0; 2], [0.0; 2], 0.0_f64);
    for k in 0..2000 {
        observer.correct(&system, &core::array::from_fn(|i| Some(state.q[i] + zeros[i]))).unwrap();
        let estimate = observer.estimate(&system).unwrap().unwrap();
        if k > 1000 {
            worst = (0..2).map(|i| (estimate.v[i] - state.v[i]).abs()).fold(worst, f64::max);
        }
        let t = f64::from(k) * H;
        let u = [6.0 * (2.3 * t).sin(), 3.0 * (3.7 * t + 1.0).sin()];
        for part in 0..FINE {
            let arrived = if f64::from(part) < 0.6 * f64::from(FINE) { &before } else { &u };
            // Halfway through the part.
            let gone = if true_lag > 0.0 { (-0.5 / (true_lag * f64::from(FINE))).exp() } else { 0.0 };
            let towards = |y: [f64; 2]| core::array::from_fn(|i| arrived[i] + gone * (y[i] - arrived[i]));
            let middle: [f64; 2] = towards(y);
            state = rk4_step(&system, &state, &middle, H / f64::from(FINE)).unwrap();
            y = towards(middle);
        }
        before = u;
        observer.predict(&system, &commands.advance(Some(u))).unwrap();
    }
    (worst, observer.zeros())
}

#[test]
fn with_friction_and_a_part_of_a_step_of_delay_it_follows_closely() {
    let (known, _) = run([0.0; 2], None, 0.6);
    let (unknown, _) = run([0.0; 2], None, 0.0);
    assert!(known < 5e-3, "{known}");
    assert!(unknown > 5.0 * known, "{unknown} {known}");
}

#[test]
fn behind_a_lag_it_follows_closely() {
    for true_lag in [0.4, 3.0] {
        let (known, _) = run_lagging(true_lag, ([0.0; 2], None), [0.6, true_lag]);
        let (unknown, _) = run_lagging(true_lag, ([0.0; 2], None), [0.6, 0.0]);
        assert!(known < 5e-3 && unknown > 5.0 * known, "{true_lag}: {known} {unknown}");
    }
}

/// The forces to come last for the decided steps, the rest of the delay and the time constant; over them the lagging command goes towards the last one.
#[test]
fn what_is_to_come_lasts_until_the_next_command_has_its_effect() {
    let mut commands = Commands::new(2, Actuator { delay: 0.25, ..Actuator::ideal() }).with_lag(1.5);
    [[1.0], [-2.0], [3.0]].into_iter().for_each(|u: [f64; 1]| {
        commands.advance(Some(u));
    });
    let (mut lasted, mut parts, mut last) = (0.0, 0, 0.0);
    let all = commands.to_come::<()>(|part, force| {
        (lasted, parts, last) = (lasted + part, parts + 1, force.end[0]);
        Ok(())
    });
    // Two steps are decided, then a quarter and two halves of the time constant pass.
    assert_eq!((all, parts), (Ok(()), 5));
    assert!((lasted - (2.0 + 0.25 + 1.5)).abs() < 1e-12 && (1.0..3.0).contains(&last), "{lasted} {last}");
    let mut refused = 0;
    let first = commands.to_come(|_, _| {
        refused += 1;
        Err(refused)
    });
    assert_eq!((first, refused), (Err(1), 1));
}

#[test]
fn both_zeros_are_learned_and_the_velocity_gets_better() {
    let prior = ZerosPrior { deviation: 0.05, innovation: 1e-3 };
    let truth = [0.02, -0.03];
    let (without, none) = run(truth, None, 0.6);
    let (with, learned) = run(truth, Some(prior), 0.6);
    assert_eq!(none, [0.0; 2]);
    assert!((0..2).all(|i| (learned[i] - truth[i]).abs() < 5e-3), "{learned:?}");
    assert!(with < 0.5 * without, "{with} {without}");
}

#[test]
fn nobody_knows_anything_before_the_first_readings() {
    let system = rubbing();
    let mut observer = observer(None);
    let commands = Commands::new(2, Actuator::ideal());
    assert_eq!(
        observer.predict(&system, &Control::none()).unwrap().is_none(),
        observer.estimate(&system).unwrap().is_none()
    );
    assert!(observer.ahead(&system, &commands).unwrap().is_none() && !observer.trusted());
    observer.correct(&system, &[Some(0.1), None]).unwrap();
    assert!(observer.estimate(&system).unwrap().is_none());
}

/// The system is that of the call: after a change of its friction, the same observer steps the new one.
#[test]
fn the_system_may_change_between_calls() {
    let (before, mut after) = (rubbing(), rubbing());
    after.forces.1.coordinates[1].constant = 0.6;
    let mut observer = observer(None);
    for q in [[0.5, -0.3], [0.51, -0.32], [0.52, -0.34]] {
        observer.predict(&before, &Control::none()).unwrap();
        observer.correct(&before, &q.map(Some)).unwrap();
    }
    let integrator = Integrator::new(Order::Four, H, Newton::default());
    let [rubs, rubs_more] = [&before, &after].map(|system| {
        let (mut observer, mut expected) = (observer.clone(), *observer.state().unwrap());
        integrator.step(system, &mut expected, &Control::none()).unwrap();
        observer.predict(system, &Control::none()).unwrap();
        assert_eq!(observer.state(), Some(&expected));
        expected.p()[1]
    });
    // The outer joint turns backwards: more friction takes more of its momentum.
    assert!(rubs_more > rubs, "{rubs} {rubs_more}");
}

/// Settling time of an observer of a cart that rests, then jumps, then moves on by `moves` m a step; the pole, which hangs at rest, does not
/// disturb it.
fn settling(tuning: Tuning<f64>, [jump, moves]: [f64; 2]) -> usize {
    let system = System::conservative(CARTPOLE);
    let mut observer =
        Observer::new(Integrator::new(Order::Two, H, Newton::default()), [false, true], tuning);
    let mut take = |x: f64, moves: f64| {
        observer.predict(&system, &Control::none()).unwrap();
        observer.correct(&system, &[Some(x), Some(core::f64::consts::PI)]).unwrap();
        let estimate = observer.estimate(&system).unwrap().unwrap();
        (estimate.q[0] - x).abs().max((H * estimate.v[0] - moves).abs())
    };
    (0..100).for_each(|_| _ = take(0.0, 0.0));
    let errors: Vec<_> = (0..200).map(|k| take(jump + moves * f64::from(k + 1), moves)).collect();
    errors.iter().rposition(|error| *error > 0.01).map_or(1, |last| last + 2)
}

/// An error of 1 m, or of 1 m in a step, falls to 1% in the settling time, and not before.
#[test]
fn errors_settle_in_the_settling_time() {
    for memory in [1, 2, 5, 20] {
        let tuning = Tuning { memory, patience: 25, zeros: None };
        let slower = settling(tuning, [1.0, 0.0]).max(settling(tuning, [0.0, 1.0]));
        assert_eq!(slower, tuning.settling() as usize, "memory {memory}");
    }
}
