//! Gains of linear regulators.

use crate::common::Random;
use crate::linear_plant::Linear;
use leastaction_core::control::riccati::{RegulatorError, Weights, back, closed_loop, stationary};
use leastaction_core::control::{Plant, Transition};
use leastaction_core::linear::{Matrix, SolveError, dot, identity, multiply};
use leastaction_core::scalar::Real;

const WEIGHTS: Weights<f64, 4, 2> = Weights { x: [1.0, 0.3, 0.0, 2.0], u: [0.5, 1.5] };

fn largest<const D: usize>(a: &Matrix<f64, D>, b: &Matrix<f64, D>) -> f64 {
    let pairs = a.as_flattened().iter().zip(b.as_flattened());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn the_stationary_regulator_is_the_limit_of_steps_backwards() {
    for seed in 0..5 {
        let Linear(transition) = Linear::random(seed);
        let found = stationary(&transition, &WEIGHTS).unwrap();
        let again = back(&transition, &WEIGHTS, &found.cost).unwrap();
        let size = found.cost.as_flattened().iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        assert!(largest(&again.cost, &found.cost) < 1e-11 * size, "P is no fixed point");
        let mut p = identity();
        for _ in 0..3000 {
            p = back(&transition, &WEIGHTS, &p).unwrap().cost;
        }
        assert!(largest(&p, &found.cost) < 1e-9 * size);
    }
}

/// ½xᵀPx is the cost of the motion from x under the gains, and any other control costs more.
#[test]
fn p_is_the_cost_of_the_motion_under_the_gains() {
    let plants: Vec<Linear<4, 2>> = (10..18).map(Linear::random).collect();
    let (mut p, mut gains) = (identity::<f64, 4>(), vec![]);
    for Linear(transition) in plants.iter().rev() {
        let regulator = back(transition, &WEIGHTS, &p).unwrap();
        (p, gains) = (regulator.cost, [vec![regulator.gain], gains].concat());
    }
    let start = [0.7, -0.4, 1.1, 0.2];
    let cost = |change: f64| {
        let mut random = Random(5);
        let (mut x, mut sum) = (start, 0.0);
        for (plant, gain) in plants.iter().zip(&gains) {
            let by: [f64; 2] = random.array(change);
            let u: [f64; 2] = core::array::from_fn(|j| by[j] - dot(&gain[j], &x));
            sum += x.iter().zip(WEIGHTS.x).map(|(x, w)| w * x * x).sum::<f64>();
            sum += u.iter().zip(WEIGHTS.u).map(|(u, w)| w * u * u).sum::<f64>();
            plant.advance(&mut x, (1, &u), &mut [0.0; 4]).unwrap();
        }
        0.5 * (sum + dot(&x, &x))
    };
    let expected = 0.5 * dot(&start, &multiply(&p, &start));
    assert!((cost(0.0) - expected).abs() < 1e-12 * expected);
    assert!(cost(1e-3) > expected);
}

#[test]
fn the_regulator_stabilises_in_single_precision_too() {
    // A double integrator at 1 kHz, and an unstable mode.
    let a = [[1.0_f32, 1e-3, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.01]];
    let b = [[0.0_f32], [1e-3], [2e-3]];
    let transition = Transition { a, b };
    let weights = Weights { x: [10.0_f32, 0.1, 1.0], u: [0.01] };
    let regulator = stationary(&transition, &weights).unwrap();
    let closed = closed_loop(&transition, &regulator.gain);
    let mut x = [1.0_f32, -1.0, 0.5];
    for _ in 0..20_000 {
        x = multiply(&closed, &x);
    }
    assert!(x.iter().all(|x| x.abs() < 1e-4), "{x:?}");
}

#[test]
fn a_motion_out_of_reach_has_no_regulator() {
    let a = [[1.2, 0.0], [0.3, 0.5]];
    let transition = Transition { a, b: [[0.0], [1.0]] };
    let weights = Weights { x: [1.0, 1.0], u: [1.0] };
    assert_eq!(stationary(&transition, &weights), Err(RegulatorError::NotStabilisable));
}

/// A growing motion, and one that stays, that cost nothing are not left alone in silence.
#[test]
fn a_motion_that_costs_nothing_has_no_regulator() {
    fn check<R: Real>() {
        let number = R::constant;
        let blind = Weights { x: [number(0.0), number(1.0)], u: [number(1.0)] };
        let seeing = Weights { x: [number(1.0); 2], ..blind };
        let regulated = |a: [[f64; 2]; 2], b: [f64; 2], weights| {
            let transition = Transition { a: a.map(|row| row.map(number)), b: b.map(|b| [number(b)]) };
            stationary(&transition, weights).map(|_| ())
        };
        for (a, b) in [
            ([[1.2, 0.0], [0.0, 0.5]], [1.0, 1.0]),
            ([[1.2, 0.3], [0.0, 0.5]], [1.0, 1.0]),
            ([[2.0, 0.3], [0.0, 1.5]], [1.0, 1.0]),
            // The position of a double integrator.
            ([[1.0, 0.1], [0.0, 1.0]], [0.0, 0.1]),
        ] {
            assert_eq!(regulated(a, b, &blind), Err(RegulatorError::Unseen), "{a:?}");
            assert_eq!(regulated(a, b, &seeing), Ok(()), "{a:?}");
        }
        // Motions that die out by themselves need not be seen, nor those that move something that is.
        assert_eq!(regulated([[0.99, 0.0], [0.0, 1.5]], [1.0, 1.0], &blind), Ok(()));
        assert_eq!(regulated([[1.2, 0.0], [0.01, 0.5]], [1.0, 1.0], &blind), Ok(()));
        // A motion that the controls do not reach either.
        assert_eq!(regulated([[1.2, 0.0], [0.0, 0.5]], [0.0, 1.0], &blind), Err(RegulatorError::Unseen));
    }
    check::<f32>();
    check::<f64>();
}

#[test]
fn numbers_that_are_not_finite_have_no_regulator() {
    let transition = Transition { a: [[1.2, 0.0], [0.3, 0.5]], b: [[1.0], [1.0]] };
    let weights = Weights { x: [1.0; 2], u: [1.0] };
    let refused = Err(RegulatorError::Solve(SolveError::NotFinite));
    for bad in [f64::NAN, f64::INFINITY] {
        assert_eq!(stationary(&Transition { a: [[bad, 0.0], [0.0; 2]], ..transition }, &weights), refused);
        assert_eq!(stationary(&Transition { b: [[bad], [0.0]], ..transition }, &weights), refused);
        assert_eq!(stationary(&transition, &Weights { x: [bad, 1.0], ..weights }), refused);
    }
    assert_eq!(stationary(&transition, &Weights { u: [0.0], ..weights }), refused);
}
