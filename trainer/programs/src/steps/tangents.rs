use crate::row::Row;

/// Derivatives of states of n coordinates in numbers: the learned ones of the weight block, then those that the control depends on, then
/// those of the start states.
#[derive(Clone, Debug)]
pub struct Tangents {
    weights: usize,
    controls: usize,
    /// Number of rows of a state, 2n.
    width: usize,
    /// Derivatives ∂x, one number after the other.
    rows: Vec<Row>,
}

/// Derivative of the control of one coordinate in one number.
#[derive(Clone, Debug)]
pub struct ControlTangent {
    /// Position among the numbers that the control depends on.
    pub number: usize,
    /// Coordinate whose τ changes.
    pub coordinate: usize,
    /// Derivatives ∂τ at the start and at the end of a step.
    pub change: [Row; 2],
}

impl Tangents {
    /// Creates the derivatives of a start state: 1 for each of its own 2n numbers, 0 for `weights` numbers of the weight block and
    /// `controls` numbers of the control.
    pub fn at_start(n: usize, weights: usize, controls: usize) -> Self {
        let (before, width) = (weights + controls, 2 * n);
        let mut rows = vec![Row::default(); width * (before + width)];
        (0..width).for_each(|i| rows[width * (before + i) + i] = Row::splat(1.0));
        Self { weights, controls, width, rows }
    }

    /// Derivatives ∂x in a number: positions first.
    pub fn of(&self, number: usize) -> &[Row] {
        &self.rows[number * self.width..][..self.width]
    }

    pub(super) fn of_mut(&mut self, number: usize) -> &mut [Row] {
        &mut self.rows[number * self.width..][..self.width]
    }

    /// Count of the learned numbers of the weight block.
    pub fn weights(&self) -> usize {
        self.weights
    }

    /// Count of the numbers that the control depends on.
    pub fn controls(&self) -> usize {
        self.controls
    }

    /// Count of all numbers.
    pub fn columns(&self) -> usize {
        self.rows.len().checked_div(self.width).unwrap_or(0)
    }

    /// Derivatives ∂x in every number.
    pub fn each(&self) -> impl Iterator<Item = &[Row]> {
        self.rows.chunks_exact(self.width)
    }

    pub(super) fn each_mut(&mut self) -> impl Iterator<Item = &mut [Row]> {
        self.rows.chunks_exact_mut(self.width)
    }

    /// Sets ∂q in every number to shares of ∂q and ∂v in two others, which have the same numbers.
    pub fn combine_positions(&mut self, others: [(&Self, [f64; 2]); 2]) {
        let (width, n) = (self.width, self.width / 2);
        for (number, moved) in self.rows.chunks_exact_mut(width).enumerate() {
            combine_positions(&mut moved[..n], others.map(|(other, shares)| (other.of(number), shares)));
        }
    }
}

/// Sets positions to shares of the positions and velocities of two states.
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
