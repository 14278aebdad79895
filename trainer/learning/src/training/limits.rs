//! Steps of numbers with closed ranges; a number may end at a bound of its range.
//!
//! Source: Nocedal and Wright, "Numerical Optimization", section 16.7 (projected steps over the free numbers).

use super::NormalEquations;
use crate::matrix::cholesky;
use nalgebra::{DMatrix, DVector};

/// Current numbers and their ranges.
#[derive(Clone, Copy)]
pub(super) struct Limited<'a> {
    pub numbers: &'a [f64],
    pub limits: &'a [[f64; 2]],
}

impl Limited<'_> {
    /// A damped step of the numbers that are not held at a bound, clipped to the ranges; `None` if the matrix is not
    /// positive definite in double precision.
    pub fn step(&self, equations: &NormalEquations, damping: &[f64]) -> Option<Vec<f64>> {
        let is_free = |k: &usize| !self.is_held(*k, equations.gradient[*k]);
        let mut free: Vec<usize> = (0..self.numbers.len()).filter(is_free).collect();
        // If the step would carry a number at a bound beyond it, the number is held there, and the step is computed
        // again for the others.
        loop {
            let mut step = vec![0.0; self.numbers.len()];
            let found = solved(equations, damping, &free)?;
            free.iter().zip(&found).for_each(|(k, s)| step[*k] = *s);
            let count = free.len();
            free.retain(|k| self.stays(*k, step[*k]));
            if free.len() == count {
                return Some(step.iter().enumerate().map(|(k, s)| self.cut_off(k, *s)).collect());
            }
        }
    }

    fn is_held(&self, k: usize, gradient: f64) -> bool {
        let (x, [least, most]) = (self.numbers[k], self.limits[k]);
        least == most || x <= least && gradient > 0.0 || x >= most && gradient < 0.0
    }

    /// Whether a number stays free: it is not at a bound beyond which the step would carry it.
    fn stays(&self, k: usize, step: f64) -> bool {
        let (x, [least, most]) = (self.numbers[k], self.limits[k]);
        (least..=most).contains(&(x + step)) || x > least && x < most
    }

    fn cut_off(&self, k: usize, step: f64) -> f64 {
        let (x, [least, most]) = (self.numbers[k], self.limits[k]);
        (x + step).clamp(least, most) - x
    }
}

/// The step −(JᵀJ + D)⁻¹Jᵀr over the free numbers.
fn solved(equations: &NormalEquations, damping: &[f64], free: &[usize]) -> Option<Vec<f64>> {
    let matrix = DMatrix::from_fn(free.len(), free.len(), |i, j| {
        let entry = equations.entry(free[i], free[j]);
        if i == j { entry + damping[free[i]] } else { entry }
    });
    let mut step = DVector::from_iterator(free.len(), free.iter().map(|i| -equations.gradient[*i]));
    cholesky(matrix)?.solve_mut(&mut step);
    Some(step.data.into())
}

/// Decrease of the mean square that the linear model predicts for an arbitrary step: −(2 δᵀJᵀr + δᵀJᵀJδ)/rows.
pub(super) fn fall(equations: &NormalEquations, step: &[f64]) -> f64 {
    let moved = |i: usize| (0..step.len()).map(|j| equations.entry(i, j) * step[j]).sum::<f64>();
    let sum = |i: usize| step[i] * (2.0 * equations.gradient[i] + moved(i));
    let fall = -(0..step.len()).map(sum).sum::<f64>() / equations.rows as f64;
    // For a clipped step the decrease may be a rounding error of 0.
    fall.max(f64::MIN_POSITIVE)
}
