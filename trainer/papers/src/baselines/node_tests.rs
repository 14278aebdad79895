use super::*;
use crate::baselines::oracle::check_normal_equations;
use leastaction_core::linear::add_scaled;
use leastaction_ground_truth::{Mechanism, Settings, generate};
use leastaction_learning::runge_kutta::step;
use leastaction_learning::training::Levenberg;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const H: f64 = 0.1;
/// Number of steps, not divisible by the number of lanes.
const STEPS: usize = 11;

fn node() -> NeuralOde {
    let coordinates = [Coordinate::Cyclic, Coordinate::Translation, Coordinate::Angle];
    NeuralOde::new(&coordinates, &[5, 4], 1).unwrap().scaled_to(&samples())
}

/// Samples of a cyclic coordinate, a length and an angle.
fn samples() -> Samples {
    let mut stream = Pcg64::seed_from_u64(3);
    let mut numbers =
        |range: f64| (0..3 * STEPS).map(|_| stream.random_range(-range..range)).collect::<Vec<f64>>();
    Samples {
        n: 3,
        h: H,
        states: [3.0, 2.0, 3.0].map(&mut numbers),
        next_velocities: numbers(2.5),
        controls: [1.0, 4.0, 2.0].map(&mut numbers),
        ..Samples::default()
    }
}

/// Errors of all samples, by the accelerations of one sample at a time.
fn errors(node: &NeuralOde, weights: &[f64], samples: &Samples, method: RungeKutta) -> Vec<f64> {
    let row = |x: &[f64], k: usize| [x[3 * k], x[3 * k + 1], x[3 * k + 2]];
    let (mut errors, motion) = (Vec::new(), node.motion(weights).unwrap());
    for k in 0..STEPS {
        let ([q, v, q_after], u) =
            (samples.states.each_ref().map(|x| row(x, k)), row(&samples.controls[0], k));
        let end = step(method, H, &[q, v], |q, v| {
            let mut out = [0.0; 3];
            motion(q, v, &u, &mut out).map(|()| out).ok_or(())
        });
        let end = end.unwrap();
        errors.extend(add_scaled(&end[0], -1.0, &q_after));
        errors.extend(add_scaled(&end[1], -1.0, &row(&samples.next_velocities, k)));
    }
    errors
}

#[test]
fn accelerations_are_those_of_plain_loops() {
    let node = NeuralOde {
        acceleration: 3.0,
        velocity: 2.0,
        control: 0.5,
        ..NeuralOde::new(&[Coordinate::Angle], &[2], 0).unwrap()
    };
    let weights: Vec<f64> = (0..node.parameters()).map(|k| 0.1 + 0.2 * k as f64).collect();
    assert_eq!(weights.len(), 4 * 2 + 2 + 2 + 1);
    let (x, mut expected) = ([0.6_f64.cos(), 0.6_f64.sin(), 1.4 / 2.0, 0.3 / 0.5], weights[12]);
    for i in 0..2 {
        let weight = |j: usize| weights[leastaction_core::network::Dense::<f64>::position(4, 2, i, j)];
        let z = (0..4).map(|j| weight(j) * x[j]).sum::<f64>() + weights[8 + i];
        expected += weights[10 + i] * z.tanh();
    }
    let mut out = [0.0];
    node.motion(&weights).unwrap()(&[0.6], &[1.4], &[0.3], &mut out).unwrap();
    assert!((out[0] - 3.0 * expected).abs() < 1e-13, "{} {}", out[0], 3.0 * expected);
}

#[test]
fn loss_and_normal_equations_are_those_of_differences() {
    let (node, samples) = (node(), samples());
    let weights = node.initial_weights(1);
    for method in [RungeKutta::Midpoint, RungeKutta::ThreeEighths] {
        let objective = node.objective(samples.clone(), method).unwrap();
        check_normal_equations(&*objective, (&weights, 1e-7), |weights| {
            errors(&node, weights, &samples, method)
        });
    }
}

#[test]
fn a_pendulum_is_learned() {
    let data = generate(&Settings::symo(Mechanism::Pendulum, 8, 1)).unwrap();
    let samples = Samples::next_states(&data).unwrap();
    let node = NeuralOde::new(&[Coordinate::Angle], &[12], 0).unwrap().scaled_to(&samples);
    for method in [RungeKutta::Midpoint, RungeKutta::ThreeEighths] {
        let objective = node.objective(samples.clone(), method).unwrap();
        let start = node.initial_weights(1);
        let before = objective.loss(&start);
        let levenberg = Levenberg::new(&*objective, start).run(&*objective, 30, |_, _| ());
        assert!(levenberg.loss < 1e-3 * before, "{method:?}: {before:e} to {:e}", levenberg.loss);
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let shape = |error| matches!(error, Err(ModelError::Shape { .. }));
    assert!(shape(NeuralOde::new(&[Coordinate::Angle], &[3], 1)));
    assert!(node().objective(Samples { n: 1, ..samples() }, RungeKutta::Midpoint).is_err());
    let (node, weights) = (node(), node().initial_weights(1));
    assert!(node.motion(&weights[1..]).is_err());
    let motion = node.motion(&weights).unwrap();
    let free = |n| motion(&[0.1; 3], &[0.2; 3], &[0.0; 3][..n], &mut [0.0; 3]);
    assert!(free(0).is_some() && free(3).is_some() && free(2).is_none());
}
