//! Velocities from positions.

use core::f32::consts::PI;
use leastaction_core::continuous::ContinuousState;
use leastaction_core::discrete::Control;
use leastaction_core::energy::trigonometric::{CARTPOLE, PENDULUM, Trigonometric};
use leastaction_core::forces::Actuator;
use leastaction_core::forces::{System, Viscous};
use leastaction_core::observer::Commands;
use leastaction_firmware_sim::observer::{LearnZeros, ObserverConfig, Order};
use leastaction_firmware_sim::plant::Plant;
use leastaction_firmware_sim::wrap;

const H: f32 = 0.01;
type Pendulum = System<Trigonometric<'static, 1>, Viscous<f32, 1>>;

fn pendulum() -> Pendulum {
    System::conservative(PENDULUM)
}

/// Velocity errors of an observer with exact readings of a pendulum that turns over, tick by tick; `seen` tells for
/// each tick whether the encoder delivers its reading.
fn errors(system: &Pendulum, config: &ObserverConfig, ticks: u32, seen: impl Fn(u32) -> bool) -> Vec<f32> {
    let mut plant = Plant::new(system, ContinuousState { q: [0.5], v: [4.0] }, 8);
    let mut observer = config.observer(H, [true]);
    let mut errors = Vec::new();
    for tick in 0..ticks {
        let truth = *plant.state();
        observer.predict(system, &Control::held([0.3])).unwrap();
        observer.correct(system, &[seen(tick).then_some(wrap(truth.q[0]))]).unwrap();
        let estimate = observer.estimate(system).unwrap().unwrap();
        assert!(!observer.trusted() || wrap(estimate.q[0] - truth.q[0]).abs() < 0.1);
        errors.push((estimate.v[0] - truth.v[0]).abs());
        plant.advance(H, |_| [0.3]).unwrap();
    }
    errors
}

#[test]
fn three_samples_give_the_velocity_and_turns_do_not_matter() {
    let config = ObserverConfig { order: Order::Four, ..ObserverConfig::default() };
    let errors = errors(&pendulum(), &config, 600, |_| true);
    assert!(errors[0] > 3.0, "no velocity from one sample");
    assert!(errors[2] < 0.2 && errors[50..].iter().all(|e| *e < 2e-3), "{:?}", &errors[..10]);
}

#[test]
fn it_coasts_through_gaps_on_the_model() {
    let config = ObserverConfig { order: Order::Four, ..ObserverConfig::default() };
    let errors = errors(&pendulum(), &config, 600, |tick| tick < 100 || tick % 40 == 0);
    assert!(errors[100..].iter().all(|e| *e < 0.05), "{:?}", errors.iter().copied().fold(0.0, f32::max));
}

#[test]
fn trust_is_lost_in_silence_and_regained() {
    let system = pendulum();
    let config = ObserverConfig { patience: 10, ..ObserverConfig::default() };
    let mut observer = config.observer(H, [true]);
    let mut trusted = Vec::new();
    for tick in 0..40 {
        observer.predict(&system, &Control::held([0.0])).unwrap();
        observer.correct(&system, &[(!(10..25).contains(&tick)).then_some(PI)]).unwrap();
        trusted.push(observer.trusted());
    }
    let at = |range: core::ops::Range<usize>| trusted[range].iter().all(|t| *t);
    assert!(!trusted[0] && !trusted[1] && at(2..20), "{trusted:?}");
    assert!(!trusted[20..25].contains(&true) && at(28..40), "{trusted:?}");
}

#[test]
fn after_a_long_sleep_it_starts_anew() {
    let system = pendulum();
    let config = ObserverConfig { patience: 10, ..ObserverConfig::default() };
    let mut observer = config.observer(H, [true]);
    (0..5).for_each(|_| observer.correct(&system, &[Some(PI)]).unwrap());
    observer.wake(10);
    assert!(observer.trusted() && observer.state().is_some());
    observer.wake(11);
    assert!(!observer.trusted() && observer.state().is_none());
}

#[test]
fn nothing_is_estimated_before_every_encoder_has_spoken() {
    let system = System::<_, Viscous<f32, 2>>::conservative(CARTPOLE);
    let mut observer = ObserverConfig::default().observer(H, [false, true]);
    observer.correct(&system, &[Some(0.1), None]).unwrap();
    assert!(observer.state().is_none());
    observer.correct(&system, &[None, Some(3.0)]).unwrap();
    assert_eq!(observer.state().map(|s| s.q()), Some([0.1, 3.0]));
}

#[test]
fn a_longer_memory_smooths_more() {
    let system = pendulum();
    let spread = |memory| {
        let config = ObserverConfig { memory, ..ObserverConfig::default() };
        let mut observer = config.observer(H, [true]);
        let mut worst = 0.0_f32;
        for tick in 0..200_u32 {
            let noise = if tick % 2 == 0 { 1e-3 } else { -1e-3 };
            observer.predict(&system, &Control::held([0.0])).unwrap();
            observer.correct(&system, &[Some(wrap(PI + noise))]).unwrap();
            if tick > 50 {
                worst = worst.max(observer.estimate(&system).unwrap().unwrap().v[0].abs());
            }
        }
        worst
    };
    assert!(spread(3) > 2.0 * spread(10));
}

#[test]
fn a_prediction_ahead_is_that_many_steps() {
    let system = pendulum();
    let mut observer = ObserverConfig::default().observer(H, [true]);
    observer.correct(&system, &[Some(1.0)]).unwrap();
    let mut commands = Commands::new(2, Actuator::ideal());
    let forces = [[0.5], [-1.0]];
    forces.iter().for_each(|u| assert_eq!(commands.advance(Some(*u)), Control::held([0.0])));
    let ahead = observer.ahead(&system, &commands).unwrap().unwrap();
    for u in &forces {
        observer.predict(&system, &Control::held(*u)).unwrap();
    }
    assert_eq!(Some(ahead), observer.estimate(&system).unwrap());
}

/// Runs a pendulum on which a known force swings to and fro, read by an encoder that is off by `zero`: returns the learned zero, and the
/// largest error of velocity in the last half.
fn learned_zero(zero: f32, config: &ObserverConfig) -> (f32, f32) {
    let system = pendulum();
    let mut plant = Plant::new(&system, ContinuousState { q: [2.0], v: [0.0] }, 8);
    let mut observer = config.observer(H, [true]);
    let mut worst = 0.0_f32;
    for tick in 0..2000 {
        let noise = if tick % 2 == 0 { 5e-4 } else { -5e-4 };
        observer.correct(&system, &[Some(wrap(plant.state().q[0] + zero + noise))]).unwrap();
        if tick > 1000 {
            worst = worst.max((observer.estimate(&system).unwrap().unwrap().v[0] - plant.state().v[0]).abs());
        }
        let u = [1.5 * (0.02 * tick as f32).sin()];
        plant.advance(H, |_| u).unwrap();
        observer.predict(&system, &Control::held(u)).unwrap();
    }
    (observer.zeros()[0], worst)
}

#[test]
fn the_zero_of_an_encoder_is_learned_where_gravity_shows_it() {
    let zeros = Some(LearnZeros { deviation: 0.05, innovation: 2e-3 });
    let learning = ObserverConfig { order: Order::Four, zeros, ..ObserverConfig::default() };
    for zero in [-0.03, 0.0, 0.02] {
        let (learned, with) = learned_zero(zero, &learning);
        let (none, without) = learned_zero(zero, &ObserverConfig { zeros: None, ..learning });
        assert!((learned - zero).abs() < 2e-3 && none == 0.0, "{zero}: {learned}");
        assert!(zero == 0.0 || with < without, "{zero}: {with} {without}");
    }
}

#[test]
fn a_zero_that_nothing_depends_on_stays_unlearned() {
    let system = System::<_, Viscous<f32, 2>>::conservative(CARTPOLE);
    let zeros = Some(LearnZeros { deviation: 0.05, innovation: 1e-3 });
    let mut observer = ObserverConfig { zeros, ..ObserverConfig::default() }.observer(H, [false, true]);
    let mut plant = Plant::new(&system, ContinuousState { q: [0.0, 2.0], v: [0.3, 0.0] }, 8);
    for _ in 0..1000 {
        let [x, theta] = plant.state().q;
        observer.correct(&system, &[Some(x + 0.03), Some(wrap(theta + 0.03))]).unwrap();
        plant.advance(H, |_| [0.0; 2]).unwrap();
        observer.predict(&system, &Control::held([0.0; 2])).unwrap();
    }
    let ([x, theta], [x_deviation, theta_deviation]) = (observer.zeros(), observer.zeros_deviation());
    assert!(x.abs() < 2e-3 && x_deviation > 0.04, "{x} {x_deviation}");
    assert!((theta - 0.03).abs() < 2e-3 && theta_deviation < 0.01, "{theta} {theta_deviation}");
}

#[test]
fn an_error_leaves_the_estimate_as_it_was() {
    let system = pendulum();
    let zeros = Some(LearnZeros { deviation: 0.05, innovation: 1e-3 });
    let mut observer = ObserverConfig { zeros, ..ObserverConfig::default() }.observer(H, [true]);
    (0..5).for_each(|_| observer.correct(&system, &[Some(1.0)]).unwrap());
    let before = (observer.estimate(&system).unwrap(), observer.zeros());
    observer.correct(&system, &[Some(f32::NAN)]).unwrap_err();
    observer.predict(&system, &Control::held([f32::INFINITY])).unwrap_err();
    assert_eq!((observer.estimate(&system).unwrap(), observer.zeros()), before);
}

#[test]
fn a_delay_of_part_of_a_tick_is_looked_ahead_over() {
    let system = pendulum();
    let observe = |actuator: Actuator<f32, 1>| {
        let mut observer = ObserverConfig::default().observer(H, [true]);
        observer.correct(&system, &[Some(1.0)]).unwrap();
        let mut commands = Commands::new(0, actuator);
        commands.advance(Some([20.0]));
        observer.ahead(&system, &commands).unwrap().unwrap().v[0]
    };
    let (none, most) = (observe(Actuator::ideal()), observe(Actuator { delay: 0.75, ..Actuator::ideal() }));
    // θ̈ = 1.5 g sin θ + 3u over 7.5 ms.
    let expected = 0.0075 * (1.5 * 9.81 * 1.0_f32.sin() + 60.0);
    assert!(none == 0.0 && (most / expected - 1.0).abs() < 1e-2, "{none} {most} {expected}");
}
