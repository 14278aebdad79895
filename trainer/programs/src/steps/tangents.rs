use crate::row::Row;

/// How states of n coordinates move with numbers: those of the weight block, then those that the control depends on, then the
/// start states.
#[derive(Clone, Debug)]
pub struct Tangents {
    weights: usize,
    controls: usize,
    /// ∂x_i of every number, i = 0 … 2n − 1.
    rows: Vec<Vec<Row>>,
}

/// How the control of one coordinate moves with one number.
#[derive(Clone, Debug)]
pub struct ControlTangent {
    /// Which of the numbers that the control depends on.
    pub number: usize,
    /// The coordinate whose τ moves.
    pub coordinate: usize,
    /// ∂τ at the start and at the end of a step.
    pub change: [Row; 2],
}

impl Tangents {
    /// Those of a start: 1 for each of its own 2n numbers, 0 for `weights` numbers of the weight block and `controls` of the
    /// control.
    pub fn at_start(n: usize, weights: usize, controls: usize) -> Self {
        let before = weights + controls;
        let row = |i: usize| {
            let mut row = vec![Row::default(); before + 2 * n];
            row[before + i] = Row::splat(1.0);
            row
        };
        Self { weights, controls, rows: (0..2 * n).map(row).collect() }
    }

    /// ∂x_i/∂ of every number, positions first.
    pub fn of(&self, i: usize) -> &[Row] {
        &self.rows[i]
    }

    /// Numbers of the weight block.
    pub fn weights(&self) -> usize {
        self.weights
    }

    /// Numbers that the control depends on.
    pub fn controls(&self) -> usize {
        self.controls
    }

    /// All numbers.
    pub fn columns(&self) -> usize {
        self.rows.first().map_or(0, Vec::len)
    }

    pub(super) fn rows(&self) -> &[Vec<Row>] {
        &self.rows
    }

    /// Adds c times rates.
    pub(super) fn add(&mut self, c: f64, rates: &[Vec<Row>]) {
        for (row, rate) in self.rows.iter_mut().zip(rates) {
            row.iter_mut().zip(rate).for_each(|(x, rate)| x.add_scaled(c, rate));
        }
    }
}

/// y += ax, number by number.
pub(super) fn add_products(y: &mut [Row], a: &Row, x: &[Row]) {
    y.iter_mut().zip(x).for_each(|(y, x)| y.add_product(a, x));
}
