//! Comparison with the equations of motion in plain loops.

use super::*;
use crate::baselines::oracle::{
    self, ADAM, assert_close, check_accelerations, check_epochs, constant, gradient, network, on_rods,
    random, squareplus,
};
use leastaction_ground_truth::{LgnnSystem, lgnn_graph};
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

/// States, of which only some are on the rods.
fn samples() -> Samples {
    oracle::samples(N, SAMPLES, [2.0, 1.5, 2.0])
}

/// Values of k that differ, and a V large enough to matter.
fn weights() -> Vec<f64> {
    let mut weights = lnn().initial_weights(5);
    weights[..NODES].copy_from_slice(&[0.7, 0.4]);
    weights
}

/// Vector from the upper to the lower end of rod `i`.
fn along(x: &[f64], i: usize) -> [f64; 2] {
    std::array::from_fn(|c| x[2 * i + c] - if i == 0 { 0.0 } else { x[2 * (i - 1) + c] })
}

/// Acceleration v̇ by the gradient V_q.
fn naive(weights: &[f64], q: &[f64], v: &[f64]) -> Vec<f64> {
    let moved = constant(&weights[NODES..]);
    let slope = gradient(|x| network(&moved, x, [WIDTH, 1], squareplus)[0], q);
    let mass = DVector::from_fn(N, |i, _| 2.0 * weights[i / 2]);
    on_rods((DMatrix::from_diagonal(&mass), -DVector::from_vec(slope)), &[(None, 0), (Some(0), 1)], [q, v])
}

#[test]
fn accelerations_and_their_normal_equations_are_those_of_plain_loops_and_differences() {
    check_accelerations(&lnn(), (&weights(), &samples()), naive);
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
    check_epochs(&CartesianLnn::new(lgnn_graph(system), 9), (system, 2), (ADAM, 60));
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
