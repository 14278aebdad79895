//! Elimination of the start states' columns from the others.

use leastaction_programs::Row;

/// Residuals of windows side by side, and their derivatives: a row of `columns` numbers per residual.
#[derive(Clone, Debug, Default)]
pub(super) struct Rows {
    pub columns: usize,
    pub residual: Vec<Row>,
    pub jacobian: Vec<Row>,
}

impl Rows {
    /// An empty set.
    pub fn new(columns: usize) -> Self {
        Self { columns, ..Self::default() }
    }

    /// Reserves room for this number of residuals.
    pub fn reserve(&mut self, residuals: usize) {
        self.residual.reserve(residuals);
        self.jacobian.reserve(residuals * self.columns);
    }

    /// The derivatives of a residual.
    pub fn row(&self, k: usize) -> &[Row] {
        &self.jacobian[k * self.columns..(k + 1) * self.columns]
    }

    /// Replaces J by PJ and r by Pr, where P = I − X(XᵀX)⁻¹Xᵀ and X is the last `count` columns of J, by Gram–Schmidt.
    /// Returns the δ of these columns that minimises |r + Xδ|. A column that depends on earlier ones, or is NaN, is
    /// skipped.
    pub fn eliminate(&mut self, count: usize) -> Vec<Row> {
        let first = self.columns - count;
        let mut shares = vec![vec![Row::default(); count]; count];
        let mut of_residual = vec![Row::default(); count];
        for c in 0..count {
            let (along, residual) = self.project_out(first, c);
            shares[c].copy_from_slice(&along[first..]);
            of_residual[c] = residual;
        }
        // X is a matrix with orthogonal columns times a unit upper triangular matrix with the entries `shares`.
        let mut step = vec![Row::default(); count];
        for c in (0..count).rev() {
            let mut sum = of_residual[c];
            (c + 1..count).for_each(|later| sum.add_product(&shares[c][later], &step[later]));
            step[c] = Row(sum.0.map(|x| -x));
        }
        step
    }

    /// Projects column c of X out of all columns that have not been processed; returns the coefficients of the columns
    /// and of the residual.
    fn project_out(&mut self, first: usize, c: usize) -> (Vec<Row>, Row) {
        let columns = self.columns;
        let (mut along, mut of_residual) = (vec![Row::default(); columns], Row::default());
        for (row, residual) in self.jacobian.chunks_exact(columns).zip(&self.residual) {
            let own = row[first + c];
            along.iter_mut().zip(row).for_each(|(along, x)| along.add_product(&own, x));
            of_residual.add_product(&own, residual);
        }
        let inverse = Row(along[first + c].0.map(|square| if square > 1e-30 { 1.0 / square } else { 0.0 }));
        let scaled = |x: &Row| x.product(&inverse);
        along.iter_mut().for_each(|x| *x = scaled(x));
        // Earlier columns of X are already orthogonal to column c; column c itself is kept.
        along[first..=first + c].fill(Row::default());
        of_residual = scaled(&of_residual);
        let [minus, of] = [Row(of_residual.0.map(|x| -x)), of_residual];
        let negative: Vec<Row> = along.iter().map(|x| Row(x.0.map(|x| -x))).collect();
        for (row, residual) in self.jacobian.chunks_exact_mut(columns).zip(&mut self.residual) {
            let own = row[first + c];
            row.iter_mut().zip(&negative).for_each(|(x, share)| x.add_product(&own, share));
            residual.add_product(&own, &minus);
        }
        (along, of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use leastaction_programs::WIDTH;

    fn number(k: usize, sample: usize) -> f64 {
        (1.7 * k as f64 + 0.3 * (k * k % 7) as f64 + sample as f64).sin()
    }

    /// Five columns and seven rows; the last two columns are to be eliminated.
    fn rows() -> Rows {
        let row = |k: usize| Row(std::array::from_fn(|sample| number(k, sample)));
        Rows { columns: 5, residual: (50..57).map(row).collect(), jacobian: (0..35).map(row).collect() }
    }

    #[test]
    fn what_is_left_is_orthogonal_and_the_step_takes_the_rest() {
        let (before, mut after) = (rows(), rows());
        let step = after.eliminate(2);
        for sample in 0..WIDTH {
            for x in 3..5 {
                let dot = |of: &dyn Fn(usize) -> f64| -> f64 {
                    (0..7).map(|k| before.row(k)[x].0[sample] * of(k)).sum()
                };
                assert!((0..3).all(|c| dot(&|k| after.row(k)[c].0[sample]).abs() < 1e-12));
                assert!(dot(&|k| after.residual[k].0[sample]).abs() < 1e-12);
            }
            for k in 0..7 {
                let moved: f64 = (0..2).map(|c| before.row(k)[3 + c].0[sample] * step[c].0[sample]).sum();
                let left = before.residual[k].0[sample] + moved;
                assert!((left - after.residual[k].0[sample]).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_column_twice_is_taken_out_once() {
        let mut rows = rows();
        (0..7).for_each(|k| rows.jacobian[5 * k + 4] = rows.jacobian[5 * k + 3]);
        let step = rows.eliminate(2);
        assert!(step.iter().chain(&rows.residual).all(|row| row.0.iter().all(|x| x.is_finite())));
    }
}
