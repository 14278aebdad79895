//! What baselines are checked against: networks in plain loops with exact derivatives (num-dual), and the normal equations of
//! any residuals by differences.

use crate::training::Objective;
use leastaction_core::network::Dense;
use num_dual::{DualNum, HyperHyperDual64};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// A number that moves along three directions.
pub type Dual = HyperHyperDual64;

pub fn moving(x: f64, [e1, e2, e3]: [f64; 3]) -> Dual {
    Dual::new(x, e1, e2, e3, 0.0, 0.0, 0.0, 0.0)
}

/// Uniform numbers in ±range.
pub fn random(count: usize, range: f64, seed: u64) -> Vec<f64> {
    let mut stream = Pcg64::seed_from_u64(seed);
    (0..count).map(|_| stream.random_range(-range..range)).collect()
}

/// Cosine and sine of angles (`a`), other coordinates as they are, then the rest of the state.
pub fn features<D: DualNum + Copy>(coordinates: &str, state: &[D]) -> Vec<D> {
    let mut x = Vec::new();
    for (kind, q) in coordinates.chars().zip(state) {
        match kind {
            'a' => x.extend([q.cos(), q.sin()]),
            _ => x.push(*q),
        }
    }
    x.extend(&state[coordinates.len()..]);
    x
}

/// Two hidden layers of one width and a linear output.
pub fn network<D: DualNum + Copy>(
    weights: &[D],
    mut x: Vec<D>,
    [width, outputs]: [usize; 2],
    activation: fn(D) -> D,
) -> Vec<D> {
    let mut at = 0;
    for (layer, outputs) in [width, width, outputs].into_iter().enumerate() {
        let bias = at + x.len() * outputs;
        let sum = |i: usize| {
            let weight = |j| weights[at + Dense::<f64>::position(x.len(), outputs, i, j)];
            (0..x.len()).fold(weights[bias + i], |sum, j| sum + weight(j) * x[j])
        };
        let y: Vec<D> = (0..outputs).map(sum).collect();
        at = bias + outputs;
        x = if layer < 2 { y.into_iter().map(activation).collect() } else { y };
    }
    assert_eq!(at, weights.len());
    x
}

pub fn assert_close(what: &str, found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() < tolerance * (1.0 + expected.abs()), "{what}: {found} {expected}");
}

/// Loss, gradient and normal equations are those of these residuals and their central differences.
pub fn check_normal_equations(
    objective: &dyn Objective,
    weights: &[f64],
    residuals: impl Fn(&[f64]) -> Vec<f64>,
) {
    let r = residuals(weights);
    let column = |j: usize| -> Vec<f64> {
        let moved = |h: f64| {
            let mut moved = weights.to_vec();
            moved[j] += h;
            residuals(&moved)
        };
        moved(1e-5).iter().zip(moved(-1e-5)).map(|(a, b)| (a - b) / 2e-5).collect()
    };
    let columns: Vec<_> = (0..weights.len()).map(column).collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    // Entries are sums of terms that cancel: an error counts against their size.
    let size = |a: &[f64], b: &[f64]| (dot(a, a) * dot(b, b)).sqrt();
    let close = |what: String, found: f64, [a, b]: [&[f64]; 2]| {
        let expected = dot(a, b);
        assert!((found - expected).abs() < 1e-6 * (1.0 + size(a, b)), "{what}: {found} {expected}");
    };
    assert_close("loss", objective.loss(weights), dot(&r, &r) / r.len() as f64, 1e-9);
    let equations = objective.normal_equations(weights).unwrap();
    assert_eq!(equations.rows, r.len());
    assert_close("mean square", equations.mean_square(), objective.loss(weights), 1e-9);
    let gradient = objective.gradient(weights, 0..objective.samples()).unwrap();
    assert_close("squares", gradient.squares, equations.squares, 1e-9);
    for (i, column) in columns.iter().enumerate() {
        close(format!("gradient {i}"), equations.gradient[i], [column, &r]);
        close(format!("gradient alone {i}"), gradient.gradient[i], [column, &r]);
        for (j, other) in columns.iter().enumerate().take(i + 1) {
            close(format!("gram {i} {j}"), equations.gram[(i, j)], [column, other]);
        }
    }
}
