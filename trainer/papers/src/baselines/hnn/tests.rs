//! Comparison with a Hamiltonian in plain loops, differentiated by num-dual.

use super::*;
use crate::baselines::oracle::{
    self, after_adam, check_normal_equations, constant, features, gradient, network,
};
use leastaction_ground_truth::{ExactMotion, Horizon, ManyBody, ModlanetSettings, generate_many, starts};
use leastaction_learning::training::{AdamSettings, Levenberg};
use num_dual::DualNum;

const N: usize = 3;
/// Number of samples, not divisible by the number of lanes.
const SAMPLES: usize = 11;
const WIDTH: usize = 5;

/// A chain of three: 9 inputs.
fn hnn() -> Hnn {
    Hnn::new("aaa", WIDTH, Momenta::Chain).unwrap()
}

fn samples() -> Samples {
    oracle::samples(N, SAMPLES, [3.0, 1.5, 2.0])
}

/// (H_q, H_p) by num-dual.
fn naive_gradient(hnn: &Hnn, weights: &[f64], state: &[f64]) -> Vec<f64> {
    let weights = constant(weights);
    let hamiltonian =
        |x: Vec<_>| network(&weights, features(&hnn.coordinates, &x), [hnn.width, 1], |z| z.tanh())[0];
    gradient(hamiltonian, state)
}

/// Errors of every sample, given by `errors(q, v, a, H_q, H_p)`.
fn each(hnn: &Hnn, weights: &[f64], errors: impl Fn([&[f64]; 3], &[f64], &[f64]) -> Vec<f64>) -> Vec<f64> {
    let samples = samples();
    let one = |k: usize| {
        let [q, v, a] = samples.states.each_ref().map(|x| &x[N * k..N * (k + 1)]);
        let gradient = naive_gradient(hnn, weights, &[q, &hnn.momenta.momenta(q, v)].concat());
        errors([q, v, a], &gradient[..N], &gradient[N..])
    };
    (0..SAMPLES).flat_map(one).collect()
}

#[test]
fn rates_and_their_normal_equations_are_those_of_plain_loops_and_differences() {
    let hnn = hnn();
    let objective = hnn.training(samples()).unwrap();
    check_normal_equations(&*objective, (&hnn.initial_weights(3), 1e-6), |weights| {
        each(&hnn, weights, |[q, v, a], h_q, h_p| {
            let convection = hnn.momenta.convection(q, v);
            let p_rate = hnn.momenta.momenta(q, a).into_iter().zip(convection).map(|(a, b)| a + b);
            let of_q = h_p.iter().zip(v).map(|(h_p, v)| h_p - v);
            of_q.chain(h_q.iter().zip(p_rate).map(|(h_q, rate)| -h_q - rate)).collect()
        })
    });
}

#[test]
fn accelerations_and_their_normal_equations_are_those_of_plain_loops_and_differences() {
    let hnn = hnn();
    let objective = hnn.objective(samples()).unwrap();
    check_normal_equations(&*objective, (&hnn.initial_weights(3), 1e-6), |weights| {
        each(&hnn, weights, |[q, v, a], h_q, _| {
            let force: Vec<f64> =
                h_q.iter().zip(hnn.momenta.convection(q, v)).map(|(h_q, c)| -h_q - c).collect();
            let found = hnn.momenta.velocities(q, &force).unwrap();
            found.iter().zip(a).map(|(found, a)| found - a).collect()
        })
    });
}

#[test]
fn both_optimisers_train_it() {
    let system = ManyBody::Pendulum(2);
    let settings = ModlanetSettings::published(system, 5);
    let data = generate_many(&ModlanetSettings { trajectories: 2, speed: 1.0, ..settings }).unwrap();
    let samples = Samples::accelerations(&data).unwrap();
    let hnn = Hnn::new("aa", 11, Momenta::of(system)).unwrap();
    let objective = hnn.training(samples.clone()).unwrap();
    let start = hnn.initial_weights(2);
    let before = objective.loss(&start);
    let levenberg = Levenberg::new(&*objective, start.clone()).run(&*objective, 60, |_, _| ());
    assert!(levenberg.loss < 0.3 * before, "{} {before}", levenberg.loss);
    let measure = hnn.objective(samples).unwrap();
    assert!(measure.loss(&levenberg.weights) < 0.5 * measure.loss(&start));
    let settings = AdamSettings { learning_rate: 1e-2, ..AdamSettings::symo(1, 0) };
    let after = after_adam(&*objective, start, settings, 40);
    assert!(after < 0.8 * before, "{after} {before}");
}

#[test]
fn predictions_keep_the_learned_hamiltonian() {
    let hnn = Hnn::new("aa", 11, Momenta::Chain).unwrap();
    let weights = hnn.initial_weights(1);
    let system = ManyBody::Pendulum(2);
    let motion: Box<dyn ExactMotion> = system.motion().unwrap();
    let settings = ModlanetSettings { trajectories: 1, ..ModlanetSettings::published(system, 1) };
    let truth = Truth::new(motion.as_ref(), starts(&settings), Horizon::of_seconds(5.0)).unwrap();
    let follow = Follow { motion: motion.as_ref(), tolerance: 1e-12, deadline: None };
    let states = hnn.predict(&weights, &truth, follow).unwrap().first;
    let hamiltonian = |state: &[f64]| {
        let (q, v) = state.split_at(2);
        let x = features("aa", &[q, &hnn.momenta.momenta(q, v)].concat());
        network(&weights, x, [11, 1], f64::tanh)[0]
    };
    let start = hamiltonian(&states[..4]);
    assert!(states.chunks_exact(4).all(|state| (hamiltonian(state) - start).abs() < 1e-9));
    let moved = states.chunks_exact(4).last().map(|state| (state[0] - states[0]).abs());
    assert!(moved.is_some_and(|moved| moved > 0.1), "{moved:?}");
}

#[test]
fn sizes_are_those_of_the_authors_and_others_are_refused() {
    // The authors' network has 41,600 weights: it has two inputs fewer, and a second, unused output in place of our
    // bias.
    let hnn = Hnn::new("aa", 200, Momenta::Chain).unwrap();
    assert_eq!((hnn.parameters(), hnn.initial_weights(0).len()), (41_400 + 400 + 1, 41_801));
    let shape = |what, found, compiled| Some(ModelError::Shape { what, found, compiled });
    assert_eq!(Hnn::new("aa", 257, Momenta::Chain).err(), shape("units in a hidden layer", 257, 256));
    assert_eq!(hnn.training(samples()).err(), shape("coordinates", 3, 2));
}
