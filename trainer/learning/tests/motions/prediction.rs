//! Long-term prediction: its measures on known errors, and the floor of single precision.

use leastaction_ground_truth::{ExactMotion, Horizon, ManyBody, ModlanetSettings, Start, starts};
use leastaction_learning::evaluate::prediction::{TOLERANCE, Truth};
use std::time::Instant;

fn motion(system: ManyBody) -> Box<dyn ExactMotion> {
    system.motion().unwrap()
}

fn truth(system: ManyBody, trajectories: usize, seconds: f64) -> Truth {
    let settings = ModlanetSettings { trajectories, speed: 8.0, ..ModlanetSettings::published(system, 7) };
    Truth::new(motion(system).as_ref(), starts(&settings), Horizon::of_seconds(seconds)).unwrap()
}

#[test]
fn thirty_seconds_are_601_comparisons() {
    assert_eq!(Horizon::of_seconds(30.0), Horizon { h: 0.05, samples: 601 });
    assert_eq!(Horizon::of_seconds(10.0).samples, 201);
}

#[test]
fn the_exact_model_makes_no_error() {
    for system in [ManyBody::Pendulum(2), ManyBody::Bodies(3)] {
        let exact = motion(system);
        let same = |q: &[f64], v: &[f64], a: &mut [f64]| exact.acceleration(q, v, a);
        let found = truth(system, 3, 2.0).compare(TOLERANCE, exact.as_ref(), same);
        assert_eq!((found.position().mean, found.energy().mean, found.failed()), (0.0, 0.0, 0));
        assert_eq!((found.valid().mean, found.valid_median()), (2.0, 2.0));
    }
}

/// Two bodies so far apart that they hardly attract each other: the effect of an error in the acceleration is known.
fn lonely_bodies() -> Truth {
    let start = Start { q: vec![-1e6, 0.0, 1e6, 0.0], v: vec![0.0; 4] };
    let bodies = motion(ManyBody::Bodies(2));
    Truth::new(bodies.as_ref(), vec![start; 3], Horizon { h: 0.1, samples: 11 }).unwrap()
}

#[test]
fn a_constant_error_of_the_acceleration_is_measured_as_it_should_be() {
    let pushed = |_: &[f64], _: &[f64], a: &mut [f64]| {
        a.copy_from_slice(&[0.0, 0.0, 0.0, 0.4]);
        Some(())
    };
    // Δy₂ = 0.2 t², v = 0.4 t, kinetic energy 0.08 t².
    let bodies = motion(ManyBody::Bodies(2));
    let found = lonely_bodies().compare(TOLERANCE, bodies.as_ref(), pushed);
    let fourths: f64 = (0..11).map(|k| (0.1 * f64::from(k)).powi(4)).sum();
    let near = |found: f64, expected: f64| (found - expected).abs() < 1e-6 * expected;
    assert!(near(found.position().mean, 0.2 * fourths.sqrt() / 11.0), "{:?}", found.position());
    assert!(near(found.energy().mean, 0.08 * fourths.sqrt() / 11.0), "{:?}", found.energy());
    assert!(near(found.mse_q[5], 0.05_f64.powi(2) / 4.0) && near(found.mse_energy[10], 0.0064));
    // 0.2 t² > 0.1 from t = 0.8 on.
    assert!((found.valid_median() - 0.8).abs() < 1e-12 && found.position().deviation < 1e-12);
}

#[test]
fn whole_turns_are_errors_of_position_but_not_of_validity() {
    let start = Start { q: vec![0.3, 0.4], v: vec![0.0, 0.0] };
    let chain = motion(ManyBody::Pendulum(2));
    let horizon = Horizon { h: 0.1, samples: 3 };
    let truth = Truth::new(chain.as_ref(), vec![start], horizon).unwrap();
    // The motion advanced by a whole turn.
    let turned = Truth::new(
        chain.as_ref(),
        vec![Start { q: vec![0.3 + std::f64::consts::TAU, 0.4], v: vec![0.0, 0.0] }],
        horizon,
    )
    .unwrap();
    let exact = |q: &[f64], v: &[f64], a: &mut [f64]| chain.acceleration(q, v, a);
    let same = truth.compare(TOLERANCE, chain.as_ref(), exact);
    let shifted = truth.difference(&turned);
    assert_eq!(same.position().mean, 0.0);
    assert!((shifted.position().mean - (3.0_f64).sqrt() * std::f64::consts::TAU / 3.0).abs() < 1e-9);
    assert!((shifted.valid_median() - 0.2).abs() < 1e-12 && shifted.energy().mean < 1e-9);
}

#[test]
fn a_model_that_breaks_off_is_infinitely_wrong_from_there() {
    let until_nearly_half = |_: &[f64], v: &[f64], a: &mut [f64]| {
        a.copy_from_slice(&[0.0, 0.0, 0.0, 1e-3]);
        (v[3] < 0.45e-3).then_some(())
    };
    let bodies = motion(ManyBody::Bodies(2));
    let found = lonely_bodies().compare(TOLERANCE, bodies.as_ref(), until_nearly_half);
    assert_eq!((found.failed(), found.position().mean, found.valid_median()), (3, f64::INFINITY, 0.5));
    assert!(found.mse_q[4] < 1e-6 && found.mse_q[5] == f64::INFINITY);
}

#[test]
fn single_precision_is_near_at_first() {
    let system = ManyBody::Pendulum(2);
    let found = truth(system, 4, 2.0).single_precision(motion(system).as_ref());
    let (q, energy) = (found.position().mean, found.energy().mean);
    assert!(q > 0.0 && q < 1e-4 && energy > 0.0 && energy < 1e-4 && found.failed() == 0, "{q:e} {energy:e}");
    assert_eq!(found.valid_median(), 2.0);
}

/// Prints the floors of the two systems over 100 starts, and checks them against known values.
#[test]
#[ignore = "takes a minute unoptimised"]
fn floors_of_single_precision() {
    for (system, seconds) in [
        (ManyBody::Pendulum(2), 30.0),
        (ManyBody::Pendulum(3), 10.0),
        (ManyBody::Pendulum(4), 10.0),
        (ManyBody::Bodies(3), 30.0),
        (ManyBody::Bodies(6), 10.0),
    ] {
        let clock = Instant::now();
        let truth = truth(system, 100, seconds);
        let exact = clock.elapsed();
        let found = truth.single_precision(motion(system).as_ref());
        let (q, e, t) = (found.position(), found.energy(), found.valid());
        println!(
            "{system:?} {seconds} s: A_q {:.2e} ± {:.2e}, A_E {:.2e} ± {:.2e}, valid median {:.2} s, mean {:.2} s; \
             truth {exact:.1?}, both {:.1?}",
            q.mean,
            q.deviation,
            e.mean,
            e.deviation,
            found.valid_median(),
            t.mean,
            clock.elapsed()
        );
        assert_eq!(found.failed(), 0);
        match system {
            ManyBody::Pendulum(2) => {
                assert!((0.3..1.2).contains(&q.mean) && e.mean < 1e-5);
                assert!((9.0..16.0).contains(&found.valid_median()));
            }
            ManyBody::Bodies(3) => assert!(q.mean < 2e-6 && e.mean < 3e-7 && t.mean > 29.0),
            _ => assert!(e.mean < 1e-3),
        }
    }
}
