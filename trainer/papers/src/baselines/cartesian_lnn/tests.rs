//! Comparison with the equations of motion in plain loops.

use super::*;
use crate::baselines::oracle::{
    Dual, assert_close, check_normal_equations, moving, network, random, squareplus,
};
use leastaction_ground_truth::lgnn_graph;
use leastaction_ground_truth::{LgnnSettings, LgnnSystem, lgnn_set};
use leastaction_learning::training::{Adam, AdamSettings, Schedule};
use nalgebra::{DMatrix, DVector};

/// Two bobs: 4 coordinates, 2 rods.
const NODES: usize = 2;
const N: usize = 2 * NODES;
const WIDTH: usize = 5;
/// Number of samples, not divisible by the number of lanes.
const SAMPLES: usize = 11;

fn lnn() -> CartesianLnn {
    CartesianLnn::new(lgnn_graph(LgnnSystem::Pendulum(NODES)), WIDTH)
}

/// States on the rods or off them.
fn samples() -> Samples {
    let states = [(1, 2.0), (2, 1.5), (3, 2.0)].map(|(seed, range)| random(N * SAMPLES, range, seed));
    Samples {
        n: N,
        h: 0.0,
        controls: std::array::from_fn(|_| vec![0.0; N * SAMPLES]),
        states,
        ..Samples::default()
    }
}

/// k that differ, and V of a scale that shows.
fn weights() -> Vec<f64> {
    let mut weights = lnn().initial_weights(5);
    weights[..NODES].copy_from_slice(&[0.7, 0.4]);
    weights
}

/// Vector from the upper to the lower end of rod `i`.
fn along(x: &[f64], i: usize) -> [f64; 2] {
    std::array::from_fn(|c| x[2 * i + c] - if i == 0 { 0.0 } else { x[2 * (i - 1) + c] })
}

/// Gradient V_q by num-dual.
fn slope(weights: &[f64], q: &[f64]) -> Vec<f64> {
    let weights: Vec<Dual> = weights[NODES..].iter().map(|w| moving(*w, [0.0; 3])).collect();
    let along = |k: usize| {
        let x = q.iter().enumerate().map(|(i, x)| moving(*x, [f64::from(u8::from(i == k)), 0.0, 0.0]));
        network(&weights, x.collect(), [WIDTH, 1], squareplus)[0].eps1
    };
    (0..q.len()).map(along).collect()
}

/// Acceleration v̇, solved together with the multipliers.
fn naive(weights: &[f64], q: &[f64], v: &[f64]) -> Vec<f64> {
    let mut matrix = DMatrix::zeros(N + NODES, N + NODES);
    let mut right = DVector::zeros(N + NODES);
    let slope = slope(weights, q);
    for i in 0..N {
        matrix[(i, i)] = 2.0 * weights[i / 2];
        right[i] = -slope[i];
    }
    for rod in 0..NODES {
        let (d, rate) = (along(q, rod), along(v, rod));
        for c in 0..2 {
            for (node, sign) in [(Some(rod), 1.0), (rod.checked_sub(1), -1.0)] {
                let Some(node) = node else { continue };
                matrix[(N + rod, 2 * node + c)] = sign * d[c];
                matrix[(2 * node + c, N + rod)] = -sign * d[c];
            }
            right[N + rod] -= rate[c] * rate[c];
        }
    }
    matrix.lu().solve(&right).unwrap().as_slice()[..N].to_vec()
}

#[test]
fn accelerations_and_their_normal_equations_are_those_of_plain_loops_and_differences() {
    let samples = samples();
    let objective = lnn().objective(samples.clone()).unwrap();
    check_normal_equations(&*objective, &weights(), |weights| {
        let one = |k: usize| {
            let [q, v, a] = samples.states.each_ref().map(|x| &x[N * k..N * (k + 1)]);
            naive(weights, q, v).into_iter().zip(a).map(|(found, a)| found - a).collect::<Vec<_>>()
        };
        (0..SAMPLES).flat_map(one).collect()
    });
}

#[test]
fn accelerations_that_are_followed_are_the_same_and_keep_the_rods() {
    let (q, v, weights) = (random(N, 2.0, 7), random(N, 1.5, 8), weights());
    let mut a = [0.0; N];
    lnn().motion(&weights).unwrap()(&q, &v, &mut a).unwrap();
    for (found, expected) in a.iter().zip(naive(&weights, &q, &v)) {
        assert_close("acceleration", *found, expected, 1e-10);
    }
    for rod in 0..NODES {
        let (d, rate, bend) = (along(&q, rod), along(&v, rod), along(&a, rod));
        let second: f64 = (0..2).map(|c| d[c] * bend[c] + rate[c] * rate[c]).sum();
        assert!(second.abs() < 1e-10, "{second}");
    }
    assert!(a.iter().any(|a| a.abs() > 0.1));
}

#[test]
fn a_few_epochs_lower_the_loss() {
    let system = LgnnSystem::Pendulum(3);
    let settings = LgnnSettings { trajectories: 2, ..LgnnSettings::published(system, 3) };
    let samples = Samples::accelerations(&lgnn_set(&settings).unwrap()).unwrap();
    let lnn = CartesianLnn::new(lgnn_graph(system), 9);
    let objective = lnn.objective(samples).unwrap();
    let start = lnn.initial_weights(2);
    let before = objective.loss(&start);
    let settings =
        AdamSettings { learning_rate: 1e-2, batch: 50, schedule: Schedule::Constant, decay: 0.0, seed: 0 };
    let mut adam = Adam::new(&*objective, start, settings);
    (0..60).for_each(|_| {
        adam.iterate(&*objective);
    });
    let after = objective.loss(&adam.weights);
    assert!(after < 0.5 * before, "{after} {before}");
}

#[test]
fn what_does_not_fit_is_refused() {
    let shape = |what, found, compiled| Some(ModelError::Shape { what, found, compiled });
    assert_eq!(lnn().objective(Samples { n: 6, ..samples() }).err(), shape("coordinates", 6, 4));
    let (weights, lnn) = (weights(), lnn());
    let needed = lnn.parameters();
    assert_eq!(lnn.motion(&weights[1..]).err(), shape("weights", needed - 1, needed));
    assert!(lnn.motion(&weights).unwrap()(&[0.1; N], &[0.0; N - 1], &mut [0.0; N]).is_none());
    let authors = CartesianLnn::new(lgnn_graph(LgnnSystem::Pendulum(3)), 256);
    assert_eq!((authors.parameters(), authors.initial_weights(0).len()), (67_844, 67_844));
}

#[test]
fn masses_that_are_negative_along_the_rods_have_no_loss() {
    let mut weights = weights();
    weights[..NODES].copy_from_slice(&[-0.7, -0.4]);
    assert_eq!(lnn().objective(samples()).unwrap().loss(&weights), f64::INFINITY);
}
