//! Velocities from positions.

use core::f32::consts::PI;
use leastaction_core::continuous::ContinuousState;
use leastaction_core::energy::trigonometric::{CARTPOLE, PENDULUM, Trigonometric};
use leastaction_core::forces::{System, Viscous};
use leastaction_firmware_sim::observer::{Observer, ObserverConfig, Order};
use leastaction_firmware_sim::plant::Plant;
use leastaction_firmware_sim::wrap;

const H: f32 = 0.01;
type Pendulum = System<Trigonometric<'static, 1>, Viscous<f32, 1>>;

fn pendulum() -> Pendulum {
    System::conservative(PENDULUM)
}

/// Velocity errors of an observer with exact readings of a pendulum that turns over, tick by tick; `seen` says when the
/// encoder delivers.
fn errors(system: &Pendulum, config: &ObserverConfig, ticks: u32, seen: impl Fn(u32) -> bool) -> Vec<f32> {
    let mut plant = Plant::new(system, ContinuousState { q: [0.5], v: [4.0] }, 8);
    let mut observer = Observer::new(system, H, [true], config);
    let mut errors = Vec::new();
    for tick in 0..ticks {
        let truth = *plant.state();
        observer.predict(&[0.3]).unwrap();
        observer.correct(&[seen(tick).then_some(wrap(truth.q[0]))]).unwrap();
        let estimate = observer.ahead(core::iter::empty()).unwrap().unwrap();
        assert!(!observer.trusted() || wrap(estimate.q[0] - truth.q[0]).abs() < 0.1);
        errors.push((estimate.v[0] - truth.v[0]).abs());
        plant.advance(H, &[0.3]).unwrap();
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
    let mut observer = Observer::new(&system, H, [true], &config);
    let mut trusted = Vec::new();
    for tick in 0..40 {
        observer.predict(&[0.0]).unwrap();
        observer.correct(&[(!(10..25).contains(&tick)).then_some(PI)]).unwrap();
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
    let mut observer = Observer::new(&system, H, [true], &config);
    (0..5).for_each(|_| observer.correct(&[Some(PI)]).unwrap());
    observer.wake(10);
    assert!(observer.trusted() && observer.state().is_some());
    observer.wake(11);
    assert!(!observer.trusted() && observer.state().is_none());
}

#[test]
fn nothing_is_estimated_before_every_encoder_has_spoken() {
    let system = System::conservative(CARTPOLE);
    let mut observer = Observer::new(&system, H, [false, true], &ObserverConfig::default());
    observer.correct(&[Some(0.1), None]).unwrap();
    assert!(observer.state().is_none());
    observer.correct(&[None, Some(3.0)]).unwrap();
    assert_eq!(observer.state().map(|s| s.q()), Some([0.1, 3.0]));
}

#[test]
fn a_longer_memory_smooths_more() {
    let system = pendulum();
    let spread = |memory| {
        let config = ObserverConfig { memory, ..ObserverConfig::default() };
        let mut observer = Observer::new(&system, H, [true], &config);
        let mut worst = 0.0_f32;
        for tick in 0..200_u32 {
            let noise = if tick % 2 == 0 { 1e-3 } else { -1e-3 };
            observer.predict(&[0.0]).unwrap();
            observer.correct(&[Some(wrap(PI + noise))]).unwrap();
            if tick > 50 {
                worst = worst.max(observer.ahead(core::iter::empty()).unwrap().unwrap().v[0].abs());
            }
        }
        worst
    };
    assert!(spread(3) > 2.0 * spread(10));
}

#[test]
fn a_prediction_ahead_is_that_many_steps() {
    let system = pendulum();
    let mut observer = Observer::new(&system, H, [true], &ObserverConfig::default());
    observer.correct(&[Some(1.0)]).unwrap();
    let forces = [[0.5], [-1.0]];
    let ahead = observer.ahead(forces.iter()).unwrap().unwrap();
    for u in &forces {
        observer.predict(u).unwrap();
    }
    assert_eq!(Some(ahead), observer.ahead(core::iter::empty()).unwrap());
}
