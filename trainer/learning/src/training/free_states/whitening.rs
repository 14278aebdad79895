//! Whitening matrices W with WᵀW = C⁻¹ for covariances C = AAᵀ + σ²1, one per lane of the rows.

use leastaction_programs::{Row, WIDTH};

/// Regularisation of C, relative to its largest diagonal entry.
const REGULAR: f64 = 1e-12;

/// Number of entries of a triangle with n rows, diagonal included; also the index of the first entry of row n.
pub(super) fn numbers_below(n: usize) -> usize {
    n * (n + 1) / 2
}

/// W, lower triangular, stored row by row up to the diagonal. `columns` are the columns of A, with n rows each. If C =
/// 0, W = 1.
pub(super) fn whitening(columns: &[Row], n: usize, deviation: f64) -> Vec<Row> {
    let mut all = vec![Row::default(); numbers_below(n)];
    for lane in 0..WIDTH {
        let entry = |i: usize, j: usize| -> f64 {
            let products = columns.chunks_exact(n).map(|column| column[i].0[lane] * column[j].0[lane]);
            products.sum::<f64>() + if i == j { deviation * deviation } else { 0.0 }
        };
        let largest = (0..n).map(|i| entry(i, i)).fold(0.0, f64::max);
        let regular = if largest == 0.0 { 1.0 } else { REGULAR * largest };
        let inverse = inverse_root(n, |i, j| entry(i, j) + if i == j { regular } else { 0.0 });
        all.iter_mut().zip(inverse).for_each(|(row, x)| row.0[lane] = x);
    }
    all
}

/// L⁻¹ for C = LLᵀ, both lower triangular, row by row up to the diagonal.
fn inverse_root(n: usize, entry: impl Fn(usize, usize) -> f64) -> Vec<f64> {
    let at = |i: usize, j: usize| numbers_below(i) + j;
    let (mut root, mut inverse) = (vec![0.0; numbers_below(n)], vec![0.0; numbers_below(n)]);
    for (i, j) in (0..n).flat_map(|i| (0..=i).map(move |j| (i, j))) {
        let left = entry(i, j) - (0..j).map(|k| root[at(i, k)] * root[at(j, k)]).sum::<f64>();
        root[at(i, j)] = if i == j { left.sqrt() } else { left / root[at(j, j)] };
    }
    for (i, j) in (0..n).flat_map(|i| (0..=i).map(move |j| (i, j))) {
        let sum: f64 = (j..i).map(|k| root[at(i, k)] * inverse[at(k, j)]).sum();
        inverse[at(i, j)] = (f64::from(u8::from(i == j)) - sum) / root[at(i, i)];
    }
    inverse
}

/// Replaces x by Wx.
pub(super) fn whiten(w: &[Row], x: &mut [Row]) {
    for i in (0..x.len()).rev() {
        let mut sum = Row::default();
        w[numbers_below(i)..].iter().zip(&x[..=i]).for_each(|(w, x)| sum.add_product(w, x));
        x[i] = sum;
    }
}

/// C⁻¹x = Wᵀ(Wx).
pub(super) fn solve(w: &[Row], x: &[Row]) -> Vec<Row> {
    let mut whitened = x.to_vec();
    whiten(w, &mut whitened);
    let mut solved = vec![Row::default(); x.len()];
    for (i, own) in whitened.iter().enumerate() {
        solved[..=i].iter_mut().zip(&w[numbers_below(i)..]).for_each(|(sum, w)| sum.add_product(w, own));
    }
    solved
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 3 × 5 numbers, different in every lane.
    fn columns() -> Vec<Row> {
        (0..15).map(|k| Row(std::array::from_fn(|lane| (1.3 * k as f64 + lane as f64).sin()))).collect()
    }

    #[test]
    fn what_is_solved_is_the_inverse() {
        let (columns, x) = (columns(), [0.3, -1.2, 0.7].map(Row::splat));
        let solved = solve(&whitening(&columns, 3, 0.4), &x);
        for lane in 0..WIDTH {
            for i in 0..3 {
                let row = |j: usize| -> f64 {
                    (0..5).map(|c| columns[3 * c + i].0[lane] * columns[3 * c + j].0[lane]).sum()
                };
                let product: f64 = (0..3).map(|j| row(j) * solved[j].0[lane]).sum();
                let found = product + 0.16 * solved[i].0[lane];
                assert!((found - x[i].0[lane]).abs() < 1e-9, "{found}");
            }
        }
    }

    #[test]
    fn nothing_uncertain_is_not_whitened() {
        let w = whitening(&vec![Row::default(); 8], 2, 0.0);
        assert_eq!(w, [1.0, 0.0, 1.0].map(Row::splat));
    }
}
