//! Damped Gauss–Newton within bounds.
//!
//! Source: Nocedal and Wright, "Numerical Optimization", sections 10.3 and 16.7 (projected steps over the numbers that are free); the
//! damping follows Nielsen 1999.

use super::problem::{Equations, LeastSquares, dot};
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};

/// Iterations at most.
const ITERATIONS: usize = 60;
/// Relative fall of the sum of squares that is not worth another iteration.
const WORTH: f64 = 1e-7;
/// Damping beyond which no step is tried.
const MOST_DAMPING: f64 = 1e10;

/// From x to a minimum of the problem with every number in its range.
pub(super) fn minimise(problem: &impl LeastSquares, mut x: Vec<f64>, bounds: &[[f64; 2]]) -> Vec<f64> {
    let mut damping = (1e-3, 2.0);
    let mut squares = problem.squares(&x);
    for _ in 0..ITERATIONS {
        let equations = problem.equations(&x);
        let before = squares;
        while damping.0 < MOST_DAMPING {
            let Some(step) = step(&equations, &x, bounds, damping.0) else { break };
            let trial: Vec<f64> = x.iter().zip(&step).map(|(x, s)| x + s).collect();
            let found = problem.squares(&trial);
            if found < squares {
                let gain = (squares - found) / expected(&equations, &step).max(f64::MIN_POSITIVE);
                damping = ((damping.0 * (1.0 - (2.0 * gain - 1.0).powi(3)).clamp(0.1, 2.0)).max(1e-12), 2.0);
                (x, squares) = (trial, found);
                break;
            }
            damping = (damping.0 * damping.1, 2.0 * damping.1);
        }
        if before - squares <= WORTH * before {
            break;
        }
    }
    x
}

/// How much the quadratic model falls.
fn expected(equations: &Equations, step: &[f64]) -> f64 {
    let product: f64 = (0..step.len()).map(|j| step[j] * dot(equations.gram.col_as_slice(j), step)).sum();
    -2.0 * dot(&equations.gradient, step) - product
}

/// A damped step of the numbers that are not held at a bound, cut off at the bounds.
fn step(equations: &Equations, x: &[f64], bounds: &[[f64; 2]], damping: f64) -> Option<Vec<f64>> {
    let mut free: Vec<usize> =
        (0..x.len()).filter(|k| !is_held(x[*k], bounds[*k], equations.gradient[*k])).collect();
    // What a step carries beyond its bound is held there, and the others step again.
    loop {
        let found = solve(equations, &free, damping)?;
        let mut step = vec![0.0; x.len()];
        free.iter().zip(&found).for_each(|(k, s)| step[*k] = *s);
        let stays = |k: &usize| {
            let [least, most] = bounds[*k];
            x[*k] + step[*k] >= least && x[*k] + step[*k] <= most || x[*k] > least && x[*k] < most
        };
        let count = free.len();
        free.retain(stays);
        if free.len() == count {
            let within = |(k, s): (usize, &f64)| (x[k] + s).clamp(bounds[k][0], bounds[k][1]) - x[k];
            return Some(step.iter().enumerate().map(within).collect());
        }
    }
}

fn is_held(x: f64, [least, most]: [f64; 2], gradient: f64) -> bool {
    least == most || x <= least && gradient > 0.0 || x >= most && gradient < 0.0
}

fn solve(equations: &Equations, free: &[usize], damping: f64) -> Option<Vec<f64>> {
    let largest = free.iter().map(|k| equations.gram[(*k, *k)]).fold(f64::MIN_POSITIVE, f64::max);
    let matrix = Mat::from_fn(free.len(), free.len(), |i, j| {
        let entry = equations.gram[(free[i], free[j])];
        if i == j { entry + damping * entry.max(1e-12 * largest) } else { entry }
    });
    let right = Mat::from_fn(free.len(), 1, |i, _| -equations.gradient[free[i]]);
    Some(matrix.llt(Side::Lower).ok()?.solve(&right).col_as_slice(0).to_vec())
}
