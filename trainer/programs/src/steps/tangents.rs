use crate::row::Row;

/// Derivatives of states of n coordinates with respect to parameters: first the learned ones of the weight block, then
/// those on which the control depends, then those of the start states.
#[derive(Clone, Debug)]
pub struct Tangents {
    weights: usize,
    controls: usize,
    /// Number of rows of a state, 2n.
    width: usize,
    /// Derivatives ∂x, one parameter after the other.
    rows: Vec<Row>,
}

/// Derivative of the control of one coordinate with respect to one parameter.
#[derive(Clone, Debug)]
pub struct ControlTangent {
    /// Position among the parameters on which the control depends.
    pub number: usize,
    /// Coordinate whose τ changes.
    pub coordinate: usize,
    /// Derivatives ∂τ at the start and at the end of a step.
    pub change: [Row; 2],
}

impl Tangents {
    /// Creates the derivatives of a start state: 1 for each of its own 2n numbers, 0 for `weights` parameters of the
    /// weight block and `controls` parameters of the control.
    pub fn at_start(n: usize, weights: usize, controls: usize) -> Self {
        let (before, width) = (weights + controls, 2 * n);
        let mut rows = vec![Row::default(); width * (before + width)];
        (0..width).for_each(|i| rows[width * (before + i) + i] = Row::splat(1.0));
        Self { weights, controls, width, rows }
    }

    /// Derivatives ∂x with respect to a parameter: positions first.
    pub fn of(&self, number: usize) -> &[Row] {
        &self.rows[number * self.width..][..self.width]
    }

    pub(super) fn of_mut(&mut self, number: usize) -> &mut [Row] {
        &mut self.rows[number * self.width..][..self.width]
    }

    /// Number of learned parameters of the weight block.
    pub fn weights(&self) -> usize {
        self.weights
    }

    /// Number of parameters on which the control depends.
    pub fn controls(&self) -> usize {
        self.controls
    }

    /// Number of all parameters.
    pub fn columns(&self) -> usize {
        self.rows.len().checked_div(self.width).unwrap_or(0)
    }

    /// Derivatives ∂x with respect to every parameter.
    pub fn each(&self) -> impl Iterator<Item = &[Row]> {
        self.rows.chunks_exact(self.width)
    }

    pub(super) fn each_mut(&mut self) -> impl Iterator<Item = &mut [Row]> {
        self.rows.chunks_exact_mut(self.width)
    }

    /// Sets ∂q for every parameter to the weighted sum of ∂q and ∂v of two others, which have the same parameters.
    pub fn combine_positions(&mut self, others: [(&Self, [f64; 2]); 2]) {
        let (width, n) = (self.width, self.width / 2);
        for (number, moved) in self.rows.chunks_exact_mut(width).enumerate() {
            combine_positions(&mut moved[..n], others.map(|(other, shares)| (other.of(number), shares)));
        }
    }
}

/// Sets positions to the weighted sum of the positions and velocities of two states.
pub fn combine_positions(q: &mut [Row], states: [(&[Row], [f64; 2]); 2]) {
    let n = q.len();
    for (i, q) in q.iter_mut().enumerate() {
        *q = Row::default();
        for (state, shares) in states {
            q.add_scaled(shares[0], &state[i]);
            q.add_scaled(shares[1], &state[n + i]);
        }
    }
}
