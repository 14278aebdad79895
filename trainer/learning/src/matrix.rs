//! Dense matrices in double precision: AᵀA and the Cholesky factor in blocks, and singular values.
//!
//! The matrix type is nalgebra's, in column-major order. Its Cholesky factorisation is not blocked, and its singular
//! values (version 0.35) are wrong for rank-deficient matrices (dimforge/nalgebra, issue 1172).

use leastaction_programs::Part;
use nalgebra::{Cholesky, DMatrix, Dyn};
use std::ops::Range;

/// Numbers in a register.
const PART: usize = size_of::<Part>() / size_of::<f64>();

/// Columns per block.
const BLOCK: usize = 96;
/// Largest number of sweeps of Jacobi's method; usually about eight suffice.
const SWEEPS: usize = 60;

/// Cosine below which two columns count as orthogonal.
const ORTHOGONAL: f64 = 4.0 * f64::EPSILON;

/// Column j.
pub fn column(a: &DMatrix<f64>, j: usize) -> &[f64] {
    &a.as_slice()[j * a.nrows()..][..a.nrows()]
}

/// Column j, to be written to.
pub fn column_mut(a: &mut DMatrix<f64>, j: usize) -> &mut [f64] {
    let rows = a.nrows();
    &mut a.as_mut_slice()[j * rows..][..rows]
}

/// Adds AᵀA to the lower triangle of `sum`; the entries above the diagonal are meaningless. Column j of A belongs to position `at[j]` of the
/// sum; positions are ascending.
///
/// Every entry is a dot product of two columns, which are contiguous: nothing is rearranged. Tiles of entries are kept in registers, and
/// the columns of a block in the second-level cache.
pub fn add_gram(sum: &mut DMatrix<f64>, a: &DMatrix<f64>, at: &[usize]) {
    let p = a.ncols();
    for first in (0..a.nrows()).step_by(GRAM_ROWS) {
        let rows = first..a.nrows().min(first + GRAM_ROWS);
        for start in (0..p).step_by(GRAM_BLOCK) {
            let end = p.min(start + GRAM_BLOCK);
            for k in (0..end).step_by(GRAM_TILE[1]) {
                for j in (start.max(k)..end).step_by(GRAM_TILE[0]) {
                    add_gram_tile((sum, at), a, [j..end, k..p], &rows);
                }
            }
        }
    }
}

/// Numbers of rows and columns of a tile, whose sums fill three quarters of the registers.
const GRAM_TILE: [usize; 2] = if cfg!(target_feature = "avx512f") { [4, 6] } else { [3, 4] };
/// Number of rows of which products are added up at once: the columns of a tile fit into a first-level cache of 32 KiB.
const GRAM_ROWS: usize = 512;
/// Number of columns that fit into half of a second-level cache of 512 KiB.
const GRAM_BLOCK: usize = 60;

/// Adds some rows' part of those entries of the tile at the beginning of these ranges that are in the ranges and in the lower triangle.
fn add_gram_tile(
    (sum, at): (&mut DMatrix<f64>, &[usize]),
    a: &DMatrix<f64>,
    [j, k]: [Range<usize>; 2],
    rows: &Range<usize>,
) {
    const J: usize = GRAM_TILE[0];
    const K: usize = GRAM_TILE[1];
    // Columns beyond the last one are read again; their products are not used.
    let of = |i: usize| &column(a, i.min(a.ncols() - 1))[rows.clone()];
    let (x, y) = (std::array::from_fn(|i| of(j.start + i)), std::array::from_fn(|i| of(k.start + i)));
    let products: [[f64; J]; K] = dot_products(x, y);
    for (k, products) in k.zip(&products) {
        let column = column_mut(sum, at[k]);
        j.clone().zip(products).filter(|(j, _)| *j >= k).for_each(|(j, product)| column[at[j]] += product);
    }
}

/// Dot products of all x with all y; those with one y are side by side.
fn dot_products<const J: usize, const K: usize>(x: [&[f64]; J], y: [&[f64]; K]) -> [[f64; J]; K] {
    let ((x, x_rest), (y, y_rest)) = (split(x), split(y));
    let count = x[0].len();
    let (x, y) = (x.map(|x| &x[..count]), y.map(|y| &y[..count]));
    let mut sums = [[Part::ZERO; J]; K];
    for i in 0..count {
        let x = x.map(|x| Part::new(x[i]));
        for k in 0..K {
            let y = Part::new(y[k][i]);
            (0..J).for_each(|j| sums[k][j] = x[j].mul_add(y, sums[k][j]));
        }
    }
    std::array::from_fn(|k| std::array::from_fn(|j| sums[k][j].reduce_add() + dot(x_rest[j], y_rest[k])))
}

/// Columns as registers of numbers, and the numbers that are left.
type Registers<'a, const N: usize> = ([&'a [[f64; PART]]; N], [&'a [f64]; N]);

fn split<const N: usize>(columns: [&[f64]; N]) -> Registers<'_, N> {
    (columns.map(|x| x.as_chunks().0), columns.map(|x| x.as_chunks::<PART>().1))
}

/// L of A = LLᵀ from the lower triangle of A; `None` if A is not positive definite in double precision.
pub fn cholesky(mut a: DMatrix<f64>) -> Option<Cholesky<f64, Dyn>> {
    let n = a.nrows();
    for start in (0..n).step_by(BLOCK) {
        let end = n.min(start + BLOCK);
        let corner = Cholesky::new(a.view_range(start..end, start..end).into_owned())?.unpack_dirty();
        a.view_range_mut(start..end, start..end).copy_from(&corner);
        if end == n {
            break;
        }
        // The rows below become A L⁻ᵀ; their product is subtracted from the columns to the right.
        let inverse = corner.solve_lower_triangular(&DMatrix::identity(end - start, end - start))?;
        let below = a.view_range(end.., start..end) * inverse.transpose();
        let rows = below.transpose();
        for first in (end..n).step_by(BLOCK) {
            let last = n.min(first + BLOCK);
            let mut rest = a.view_range_mut(first.., first..last);
            rest.gemm(
                -1.0,
                &below.rows_range(first - end..),
                &rows.columns_range(first - end..last - end),
                1.0,
            );
        }
        a.view_range_mut(end.., start..end).copy_from(&below);
    }
    Some(Cholesky::pack_dirty(a))
}

/// Singular values in descending order, with their vectors: A V = U Σ.
pub struct Singular {
    /// σ.
    pub values: Vec<f64>,
    /// Uσ, as columns.
    pub left: DMatrix<f64>,
    /// V, as columns. If A is symmetric and positive semidefinite, these are its eigenvectors, and σ its eigenvalues.
    pub right: DMatrix<f64>,
}

/// The singular values of a matrix; `None` if an entry is not finite.
///
/// Source: Demmel and Veselić, "Jacobi's method is more accurate than QR", 1992 (one-sided rotations).
pub fn singular(a: &DMatrix<f64>) -> Option<Singular> {
    if a.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let p = a.ncols();
    let (mut left, mut right) = (a.clone(), DMatrix::identity(p, p));
    // Columns of smaller norm are rounding errors.
    let least = f64::EPSILON * f64::EPSILON * a.norm_squared();
    for _ in 0..SWEEPS {
        let mut turned = false;
        for (i, j) in (0..p).flat_map(|i| (i + 1..p).map(move |j| (i, j))) {
            let Some(rotation) = rotation([i, j].map(|k| column(&left, k)), least) else { continue };
            turned = true;
            [&mut left, &mut right].into_iter().for_each(|of| rotate(of, (i, j), rotation));
        }
        if !turned {
            break;
        }
    }
    let values: Vec<f64> = (0..p).map(|j| dot(column(&left, j), column(&left, j)).sqrt()).collect();
    let mut order: Vec<usize> = (0..p).collect();
    order.sort_by(|i, j| values[*j].total_cmp(&values[*i]));
    let [left, right] = [left, right].map(|of| of.select_columns(&order));
    Some(Singular { values: order.into_iter().map(|j| values[j]).collect(), left, right })
}

/// Rotation (cosine, sine) that makes two columns orthogonal; `None` if they already are, or if the squared norm of one
/// is at most `least`.
fn rotation([x, y]: [&[f64]; 2], least: f64) -> Option<(f64, f64)> {
    let (xx, yy, xy) = (dot(x, x), dot(y, y), dot(x, y));
    if xx.min(yy) <= least || xy.abs() <= ORTHOGONAL * (xx * yy).sqrt() {
        return None;
    }
    let zeta = (yy - xx) / (2.0 * xy);
    let tangent = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
    let cosine = tangent.hypot(1.0).recip();
    Some((cosine, cosine * tangent))
}

fn rotate(a: &mut DMatrix<f64>, (i, j): (usize, usize), (cosine, sine): (f64, f64)) {
    let rows = a.nrows();
    let (before, after) = a.as_mut_slice().split_at_mut(j * rows);
    for (x, y) in before[i * rows..][..rows].iter_mut().zip(after) {
        (*x, *y) = (cosine * *x - sine * *y, sine * *x + cosine * *y);
    }
}

/// Σ xᵢyᵢ in four partial sums, for vector registers.
fn dot(x: &[f64], y: &[f64]) -> f64 {
    let ((x, x_rest), (y, y_rest)) = (x.as_chunks::<4>(), y.as_chunks::<4>());
    let mut sums = [0.0; 4];
    for (x, y) in x.iter().zip(y) {
        sums.iter_mut().zip(x.iter().zip(y)).for_each(|(sum, (x, y))| *sum += x * y);
    }
    sums.iter().sum::<f64>() + x_rest.iter().zip(y_rest).map(|(x, y)| x * y).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers without a recognisable pattern.
    fn wave(rows: usize, columns: usize) -> DMatrix<f64> {
        DMatrix::from_fn(rows, columns, |i, j| (1.7 * i as f64 + 2.3 * (j * j) as f64 + 0.1).sin())
    }

    fn close(found: &DMatrix<f64>, expected: &DMatrix<f64>) {
        let error = (found - expected).abs().max();
        assert!(error < 1e-10 * expected.abs().max(), "{error}");
    }

    #[test]
    fn a_gram_is_a_product_in_its_lower_triangle() {
        for (rows, columns) in [(1, 1), (3, 2), (50, 7), (240, 97), (31, 250), (1030, 61), (513, 64)] {
            let a = wave(rows, columns);
            let mut sum = DMatrix::from_element(columns, columns, 0.5);
            add_gram(&mut sum, &a, &Vec::from_iter(0..columns));
            let expected = (a.transpose() * &a).add_scalar(0.5);
            close(&sum.lower_triangle(), &expected.lower_triangle());
        }
    }

    #[test]
    fn a_gram_of_few_columns_is_that_with_zeros_in_the_others() {
        let (at, a) = ([1, 4, 5, 9, 12], wave(530, 5));
        let mut whole = DMatrix::zeros(530, 14);
        at.iter().enumerate().for_each(|(j, at)| whole.set_column(*at, &a.column(j)));
        let [mut few, mut all] = [(); 2].map(|()| DMatrix::from_element(14, 14, 0.5));
        add_gram(&mut few, &a, &at);
        add_gram(&mut all, &whole, &Vec::from_iter(0..14));
        assert_eq!(few.lower_triangle(), all.lower_triangle());
    }

    #[test]
    fn a_factor_in_blocks_solves() {
        for n in [1, 5, 96, 97, 250] {
            let a = wave(n + 30, n);
            let mut matrix = a.transpose() * &a + DMatrix::identity(n, n);
            let (x, whole) = (wave(n, 1), matrix.clone());
            matrix.fill_upper_triangle(f64::NAN, 1);
            let factor = cholesky(matrix).unwrap();
            close(&(factor.l() * factor.l().transpose()), &whole);
            close(&factor.solve(&(&whole * &x)), &x);
            let mut indefinite = whole;
            indefinite[(n - 1, n - 1)] = -1.0;
            assert!(cholesky(indefinite).is_none());
        }
        assert!(cholesky(DMatrix::from_element(2, 2, f64::NAN)).is_none());
    }

    #[test]
    fn singular_values_are_found_to_the_last_one_that_counts() {
        // Orthogonal columns of these lengths, rotated.
        let (sizes, turn) = ([4.0, 3.0, 3.0, 1e-3, 1e-9], wave(5, 5).qr().q());
        let orthogonal = wave(40, 5).qr().q();
        let a = &orthogonal * DMatrix::from_diagonal(&sizes.to_vec().into()) * turn.transpose();
        let found = singular(&a).unwrap();
        for (found, size) in found.values.iter().zip(sizes) {
            assert!((found / size - 1.0).abs() < 1e-6, "{found} {size}");
        }
        close(&(&a * &found.right), &found.left);
        close(&(found.right.transpose() * &found.right), &DMatrix::identity(5, 5));
    }

    #[test]
    fn matrices_that_lack_rank_have_no_more_singular_values() {
        let found = singular(&DMatrix::from_element(6, 21, 1.0)).unwrap();
        assert!((found.values[0] - 126.0_f64.sqrt()).abs() < 1e-12);
        assert!(found.values[1..].iter().all(|value| *value < 1e-14));
        assert!(singular(&DMatrix::from_element(2, 2, f64::INFINITY)).is_none());
        assert_eq!(singular(&DMatrix::zeros(3, 2)).unwrap().values, [0.0, 0.0]);
        assert!(singular(&DMatrix::zeros(0, 0)).unwrap().values.is_empty());
    }
}
