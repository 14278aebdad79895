//! Accelerations at states that are logged with noise.

use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_ground_truth::{Mechanism, Settings, generate, noisy};
use leastaction_learning::training::{Levenberg, Objective, Samples, StateNoise, free_states_objective};
use leastaction_models::{Architecture, InertiaNetworkArchitecture};
use rand::SeedableRng;
use rand_pcg::Pcg64;

const NOISE: f64 = 0.02;

/// A number between −1 and 1, different for every k.
fn wave(k: usize) -> f64 {
    (1.7 * k as f64 + 0.4).sin()
}

/// A damped network of three coordinates.
fn shape() -> Architecture {
    let kinds = [Coordinate::Angle, Coordinate::Translation, Coordinate::Angle];
    InertiaNetworkArchitecture {
        damped: true,
        widths: vec![4, 3],
        ..InertiaNetworkArchitecture::new(&kinds, 0)
    }
    .into()
}

/// Arbitrary states and accelerations; nineteen is not a multiple of the block width.
fn samples(count: usize) -> Samples {
    let numbers =
        |k: usize, range: f64| (0..3 * count).map(|i| range * wave(7 * i + k)).collect::<Vec<f64>>();
    let control = numbers(5, 1.0);
    Samples {
        n: 3,
        states: [numbers(1, 1.0), numbers(2, 1.0), numbers(3, 0.5)],
        controls: [control.clone(), control.clone(), control],
        ..Samples::default()
    }
}

/// The loss at these weights, with the states most likely under them.
fn settled(objective: &dyn Objective, weights: &[f64]) -> f64 {
    let mut all = objective.enter(weights.to_vec());
    (0..6).for_each(|_| assert!(objective.settle(&mut all)));
    objective.loss(&all)
}

/// The gradient computed with the states held at their most likely values equals the derivative of the loss with the
/// states estimated anew for every change of the weights.
#[test]
fn the_gradient_is_that_of_what_is_left_at_likely_states() {
    let architecture = shape();
    let weights = architecture.initial_weights(3);
    let noise = StateNoise { q: 0.05, v: 0.1, a: 0.3 };
    let objective = free_states_objective(&architecture, samples(19), noise).unwrap();
    let mut all = objective.enter(weights.clone());
    (0..6).for_each(|_| assert!(objective.settle(&mut all)));
    let equations = objective.normal_equations(&all).unwrap();
    assert_eq!((equations.gradient.len(), equations.rows), (weights.len(), 57));
    for k in (0..weights.len()).step_by(5) {
        let moved = |step: f64| {
            let mut weights = weights.clone();
            weights[k] += step;
            settled(&*objective, &weights)
        };
        let difference = (moved(1e-5) - moved(-1e-5)) / 2e-5;
        let gradient = 2.0 * equations.gradient[k] / equations.rows as f64;
        assert!(
            (gradient - difference).abs() < 1e-6 * (1.0 + difference.abs()),
            "{k}: {gradient} {difference}"
        );
    }
}

/// States along a pendulum's motion, with or without noise on positions and velocities.
fn pendulum(noise: f64) -> Samples {
    let settings = Settings { samples: 15, ..Settings::symo(Mechanism::Pendulum, 4, 1) };
    let mut samples = Samples::accelerations(&generate(&settings).unwrap()).unwrap();
    let mut stream = Pcg64::seed_from_u64(7);
    let [q, v, _] = &mut samples.states;
    q.iter_mut().chain(v).for_each(|x| *x = noisy([*x], noise, &mut stream)[0]);
    samples
}

#[test]
fn held_back_rows_tell_good_weights_from_bad_ones_whatever_rows_were_learned_from() {
    let architecture: Architecture = InertiaNetworkArchitecture {
        widths: vec![6],
        ..InertiaNetworkArchitecture::new(&[Coordinate::Angle], 0)
    }
    .into();
    let [rows, judges] = pendulum(NOISE).split(9);
    let noise = StateNoise { q: NOISE, v: NOISE, a: 0.0 };
    let objective = |samples| free_states_objective(&architecture, samples, noise).unwrap();
    let (objective, judge) = (objective(rows), objective(judges));
    let start = Levenberg::new(&*objective, architecture.initial_weights(0)).with_decay(0.1);
    let first = start.weights.clone();
    let last = start.run(&*objective, 40, |_, _| ());
    let [before, after] = [&first, &last.weights].map(|weights| judge.held_back_loss(weights));
    assert!(after < 0.5 * before, "{before} {after}");
    // The loss of a model that explains everything but the noise is about 1, whatever the units.
    assert!((0.3..1.5).contains(&last.loss), "{}", last.loss);
}
