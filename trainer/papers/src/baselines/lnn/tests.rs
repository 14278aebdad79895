//! Tests of training with the model.

use super::*;
use crate::baselines::oracle::{
    self, ADAM, after_adam, assert_close, check_normal_equations, constant, equation, features, network,
    on_rods, random,
};
use leastaction_ground_truth::{Horizon, ManyBody, ModlanetSettings, generate_many, starts};
use leastaction_learning::training::{AdamSettings, Levenberg};
use num_dual::DualNum;
use std::array::from_fn;

const N: usize = 3;
const COORDINATES: &str = "ata";
/// Number of samples, not divisible by the number of lanes.
const SAMPLES: usize = 11;

fn lnn() -> Lnn {
    Lnn::new(COORDINATES, 7)
}

fn samples() -> Samples {
    oracle::samples(N, SAMPLES, [3.0, 1.5, 2.0])
}

/// Weights of a mass matrix that is far from singular at the samples.
fn weights() -> Vec<f64> {
    lnn().initial_weights(2)
}

/// v̇ − a of all samples, from second derivatives by num-dual.
fn errors(weights: &[f64], samples: &Samples) -> Vec<f64> {
    let weights = constant(weights);
    let lagrangian =
        |state: &[_]| network(&weights, features(COORDINATES, state), [7, 1], |z| z.exp().ln_1p())[0];
    oracle::errors(samples, |q, v| on_rods(equation(lagrangian, [q, v]), &[], [q, v]))
}

#[test]
fn loss_and_normal_equations_are_those_of_plain_loops_and_differences() {
    let samples = samples();
    let objective = lnn().objective(samples.clone()).unwrap();
    check_normal_equations(&*objective, (&weights(), 1e-6), |weights| errors(weights, &samples));
}

#[test]
fn accelerations_that_are_followed_are_the_same() {
    let (weights, samples) = (weights(), samples());
    let motion = motion::<2>(&lnn(), Vec::new(), &weights).unwrap();
    let [q, v, a] = samples.states.each_ref().map(|x| x.chunks_exact(N));
    let expected = errors(&weights, &samples);
    for (((q, v), a), expected) in q.zip(v).zip(a).zip(expected.chunks_exact(N)) {
        let mut found = [0.0; N];
        motion(q, v, &mut found).unwrap();
        (0..N).for_each(|i| assert_close("acceleration", found[i], expected[i] + a[i], 1e-9));
    }
    assert!(motion(&[0.0; 2], &[0.0; N], &mut [0.0; N]).is_none());
}

#[test]
fn a_mass_matrix_without_inverse_has_no_loss() {
    let objective = lnn().objective(samples()).unwrap();
    let none = vec![0.0; lnn().parameters()];
    assert_eq!(objective.loss(&none), f64::INFINITY);
    assert!(objective.normal_equations(&none).is_none() && objective.gradient(&none, 0..3).is_none());
    let motion = motion::<2>(&lnn(), Vec::new(), &none).unwrap();
    assert!(motion(&[0.1; N], &[0.2; N], &mut [0.0; N]).is_none());
}

#[test]
fn sizes_are_those_of_the_authors_and_their_weights_have_the_variances_said() {
    // The authors' network has 364,200 weights: it has two inputs fewer, since angles are not replaced by cosine and
    // sine, and no bias at the output.
    let lnn = Lnn::new("aa", 600);
    assert_eq!(lnn.parameters(), 364_200 + 2 * 600 + 1);
    let weights = lnn.initial_weights(0);
    let deviation = |x: &[f64]| (x.iter().map(|x| x * x).sum::<f64>() / x.len() as f64).sqrt();
    let (first, rest) = weights.split_at(6 * 600 + 600);
    let (second, last) = rest.split_at(600 * 600 + 600);
    assert!((deviation(&first[..3600]) - 2.2 / 6.0_f64.sqrt()).abs() < 0.03);
    assert!((deviation(&second[..360_000]) - 1.16 / 600.0_f64.sqrt()).abs() < 1e-3);
    assert!((deviation(&last[..600]) - 1.0).abs() < 0.1);
    assert_eq!((last.len(), first[3600], last[600]), (601, 0.0, 0.0));
}

#[test]
fn both_optimisers_train_it() {
    let settings = ModlanetSettings::published(ManyBody::Pendulum(2), 5);
    let data = generate_many(&ModlanetSettings { trajectories: 1, speed: 1.0, ..settings }).unwrap();
    let lnn = Lnn::new("aa", 9);
    let objective = lnn.objective(Samples::accelerations(&data).unwrap()).unwrap();
    let start = lnn.initial_weights(2);
    let before = objective.loss(&start);
    let levenberg = Levenberg::new(&*objective, start.clone()).run(&*objective, 40, |_, _| ());
    assert!(levenberg.loss < 1e-2 * before, "{} {before}", levenberg.loss);
    let settings = AdamSettings { learning_rate: 1e-3, batch: 0, decay: 1e-4, ..ADAM };
    let after = after_adam(&*objective, start, settings, 100);
    assert!(after < 0.9 * before, "{after} {before}");
}

/// The values that the passes through the widest network of the largest size hand to each other fit on a thread's
/// stack.
#[test]
fn the_largest_has_a_gradient() {
    let lnn = Lnn::new("tttttt", 600);
    let state = |seed| random(6 * 9, 2.0, seed);
    let samples = Samples {
        n: 6,
        h: 0.0,
        states: [1, 2, 3].map(state),
        controls: [4, 5, 6].map(state),
        ..Samples::default()
    };
    let objective = lnn.objective(samples).unwrap();
    assert!(objective.gradient(&lnn.initial_weights(0), 0..9).is_some());
}

#[test]
fn it_predicts_and_gives_up_when_it_is_late() {
    let system = ManyBody::Pendulum(2);
    let motion = system.motion().unwrap();
    let settings = ModlanetSettings { trajectories: 2, speed: 1.0, ..ModlanetSettings::published(system, 1) };
    let horizon = Horizon { h: 0.01, samples: 3 };
    let truth = Truth::new(motion.as_ref(), starts(&settings), horizon).unwrap();
    let lnn = Lnn::new("aa", 9);
    let follow = Follow { motion: motion.as_ref(), tolerance: 1e-6, deadline: None };
    let weights = lnn.initial_weights(2);
    let found = lnn.predict(&weights, &truth, follow).unwrap();
    assert!(found.failed() == 0 && found.position().mean > 0.0, "{found:?}");
    let late = Follow { deadline: Some(std::time::Instant::now()), ..follow };
    assert_eq!(lnn.predict(&weights, &truth, late).unwrap().failed(), 2);
}

#[test]
fn any_number_of_coordinates_is_learned_and_what_does_not_fit_is_refused() {
    let shape = |what, found, compiled| Some(ModelError::Shape { what, found, compiled });
    let other = Samples { n: 2, ..samples() };
    assert_eq!(lnn().objective(other).err(), shape("coordinates", 2, 3));
    let five = Lnn::new("atata", 8);
    let states = from_fn(|k| random(5, 2.0, 20 + k as u64));
    let samples = Samples { n: 5, states, controls: from_fn(|_| vec![0.0; 5]), ..Samples::default() };
    assert!(five.objective(samples).unwrap().loss(&five.initial_weights(1)).is_finite());
}
