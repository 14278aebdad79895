//! Linear least squares for the numbers on which a torque depends linearly, as far as a log determines them.

use crate::matrix::{column, column_mut, singular};
use crate::torque::Samples;
use leastaction_models::tree::Tree;
use nalgebra::DMatrix;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Numbers that are learned besides those of the bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Terms {
    /// Rotor inertia J of every coordinate, with the torque J a.
    pub rotors: bool,
    /// Viscous friction b v.
    pub viscous: bool,
    /// Coulomb friction c tanh(v/ε) with this ε (rad/s, m/s).
    pub coulomb: Option<f64>,
    /// A constant torque.
    pub offsets: bool,
}

/// Rows of a least-squares problem: row k n + i is torque i of sample k.
#[derive(Clone, Debug)]
pub struct Design {
    /// \[rows\]\[columns\]: the bodies' columns, then n columns each for rotors, viscous friction, Coulomb friction and offsets, as far as
    /// they are learned.
    pub matrix: DMatrix<f64>,
    /// The logged torques.
    pub target: Vec<f64>,
    /// Number of coordinates n.
    pub coordinates: usize,
}

/// The minimum-norm least-squares solution, with every number scaled by the norm of its column.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// One number per column.
    pub numbers: Vec<f64>,
    /// Number of singular values above [`TOLERANCE`] times the largest, columns scaled to norm 1.
    pub rank: usize,
    /// Ratio of the largest singular value to the smallest that counts.
    pub condition: f64,
}

/// Relative threshold at or below which singular values count as 0.
pub const TOLERANCE: f64 = 1e-9;

impl Design {
    /// The problem of a tree and samples.
    #[must_use]
    pub fn new(tree: &Tree, samples: &Samples, terms: &Terms) -> Self {
        let n = tree.coordinates();
        let bodies = tree.parameter_count() - n;
        let inertial = bodies + if terms.rotors { n } else { 0 };
        let mut rows: Vec<Vec<f64>> = Vec::with_capacity(n * samples.count());
        for (q, (v, a)) in samples.q.iter().zip(samples.v.iter().zip(samples.a.iter())) {
            for (i, mut row) in tree.regressor(q, v, a).into_iter().enumerate() {
                row.truncate(inertial);
                let unit = |x: f64| (0..n).map(move |k| if k == i { x } else { 0.0 });
                if terms.viscous {
                    row.extend(unit(v[i]));
                }
                if let Some(width) = terms.coulomb {
                    row.extend(unit((v[i] / width).tanh()));
                }
                if terms.offsets {
                    row.extend(unit(1.0));
                }
                rows.push(row);
            }
        }
        let columns = rows.first().map_or(0, Vec::len);
        let matrix = DMatrix::from_fn(rows.len(), columns, |i, j| rows[i][j]);
        Self { matrix, target: samples.tau.as_flat().to_vec(), coordinates: n }
    }

    /// Divides every row by the scale of its coordinate.
    #[must_use]
    pub fn over(mut self, scales: &[f64]) -> Self {
        let n = self.coordinates;
        self.target.iter_mut().enumerate().for_each(|(i, x)| *x /= scales[i % n]);
        for j in 0..self.matrix.ncols() {
            column_mut(&mut self.matrix, j).iter_mut().enumerate().for_each(|(i, x)| *x /= scales[i % n]);
        }
        self
    }

    /// Torques predicted by these numbers, row by row.
    #[must_use]
    pub fn predict(&self, numbers: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.matrix.nrows()];
        for (j, number) in numbers.iter().enumerate() {
            sums.iter_mut().zip(column(&self.matrix, j)).for_each(|(sum, x)| *sum += number * x);
        }
        sums
    }

    /// The condition number of some columns, each scaled to norm 1; infinite if they are linearly dependent.
    #[must_use]
    pub fn condition_of(&self, columns: &[usize]) -> f64 {
        let chosen = self.matrix.select_columns(columns);
        if chosen.is_empty() {
            return 0.0;
        }
        // A search calls this function for every candidate. Eigenvalues of the small matrix AᵀA take a fraction of the
        // time of singular values.
        let scaled = scaled(&chosen, &norms(&chosen));
        let gram = scaled.transpose() * &scaled;
        if gram.iter().any(|x| !x.is_finite()) {
            return f64::INFINITY;
        }
        let squares = gram.symmetric_eigenvalues();
        let (least, largest) = (squares.min(), squares.max());
        if least > TOLERANCE * TOLERANCE * largest { (largest / least).sqrt() } else { f64::INFINITY }
    }

    /// The solution; `None` if a number is not finite.
    #[must_use]
    pub fn solve(&self) -> Option<Solution> {
        let (scales, p) = (norms(&self.matrix), self.matrix.ncols());
        // The last column of the triangular factor is Qᵀτ.
        let target = self.target.iter().copied();
        let mut with_target = scaled(&self.matrix, &scales).resize_horizontally(p + 1, 0.0);
        column_mut(&mut with_target, p).iter_mut().zip(target).for_each(|(to, tau)| *to = tau);
        let triangle = triangle(&with_target);
        let svd = singular(&triangle.view((0, 0), (p, p)).into_owned())?;
        let largest = svd.values.first().copied().unwrap_or(0.0);
        let rank = svd.values.iter().filter(|s| **s > TOLERANCE * largest).count();
        let mut numbers = vec![0.0; p];
        for (k, s) in svd.values.iter().take(rank).enumerate() {
            let part = column(&svd.left, k).iter().zip(column(&triangle, p)).map(|(u, y)| u * y).sum::<f64>();
            numbers.iter_mut().zip(column(&svd.right, k)).for_each(|(x, v)| *x += part / (s * s) * v);
        }
        numbers.iter_mut().zip(&scales).for_each(|(x, scale)| *x /= scale);
        let condition = largest / rank.checked_sub(1).map_or(0.0, |last| svd.values[last]);
        numbers.iter().all(|x| x.is_finite()).then_some(Solution { numbers, rank, condition })
    }
}

/// Norms of the columns; 1 for a zero column.
fn norms(matrix: &DMatrix<f64>) -> Vec<f64> {
    matrix.column_iter().map(|column| column.norm()).map(|norm| if norm > 0.0 { norm } else { 1.0 }).collect()
}

/// The matrix with every column divided by its scale.
fn scaled(matrix: &DMatrix<f64>, scales: &[f64]) -> DMatrix<f64> {
    DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |i, j| matrix[(i, j)] / scales[j])
}

/// Rows per factorisation.
const ROWS: usize = 512;

/// The upper triangular R of A = QR, updated by blocks of rows that fit in the cache.
fn triangle(a: &DMatrix<f64>) -> DMatrix<f64> {
    let p = a.ncols();
    let mut triangle = DMatrix::zeros(p, p);
    for start in (0..a.nrows()).step_by(ROWS) {
        let rows = a.rows_range(start..a.nrows().min(start + ROWS));
        let mut stacked = triangle.resize_vertically(p + rows.nrows(), 0.0);
        stacked.rows_range_mut(p..).copy_from(&rows);
        triangle = stacked.qr().unpack_r();
    }
    triangle
}

/// The base parameters K π of a tree: the combinations of its parameters on which its torques depend. Every row of K
/// stands for one independent parameter and the dependent parameters that add to it.
///
/// Source: Gautier, "Numerical calculation of the base inertial parameters of robots", 1991.
#[derive(Clone, Debug)]
pub struct BaseParameters {
    /// Indices of the independent parameters, in ascending order.
    pub independent: Vec<usize>,
    /// K, \[independent\]\[parameters\]; the columns of independent parameters hold 1 and 0.
    pub combination: DMatrix<f64>,
}

/// Seed of the random states; any seed would do.
const SEED: u64 = 1991;

impl BaseParameters {
    /// The base parameters of a tree, determined from random states.
    #[must_use]
    pub fn of(tree: &Tree) -> Self {
        Self::among(tree, &(0..tree.parameter_count()).collect::<Vec<_>>())
    }

    /// The base parameters among the parameters `learned`, when all other parameters are known; the columns of K for
    /// known parameters are 0.
    #[must_use]
    pub fn among(tree: &Tree, learned: &[usize]) -> Self {
        let mut random = Pcg64::seed_from_u64(SEED);
        let (n, p) = (tree.coordinates(), tree.parameter_count());
        let mut rows: Vec<Vec<f64>> = Vec::new();
        while rows.len() < 4 * p {
            let mut state = || (0..n).map(|_| random.random_range(-3.0..3.0)).collect::<Vec<f64>>();
            rows.extend(tree.regressor(&state(), &state(), &state()));
        }
        let matrix = DMatrix::from_fn(rows.len(), learned.len(), |i, j| rows[i][learned[j]]);
        let scales = norms(&matrix);
        let Self { independent, combination } = Self::of_columns(scaled(&matrix, &scales), &scales);
        let mut all = DMatrix::zeros(combination.nrows(), p);
        for (j, column) in learned.iter().enumerate() {
            all.column_mut(*column).copy_from(&combination.column(j));
        }
        Self { independent: independent.into_iter().map(|j| learned[j]).collect(), combination: all }
    }

    fn of_columns(scaled: DMatrix<f64>, scales: &[f64]) -> Self {
        let p = scaled.ncols();
        let Pivoted { upper, order, rank } = Pivoted::of(scaled);
        // R₁⁻¹R₂.
        let mut dependent = upper.view((0, rank), (rank, p - rank)).into_owned();
        let independent = upper.view((0, 0), (rank, rank));
        let _rank_is_full = independent.solve_upper_triangular_mut(&mut dependent);
        let mut rows: Vec<usize> = (0..rank).collect();
        rows.sort_by_key(|k| order[*k]);
        let mut combination = DMatrix::zeros(rank, p);
        for (row, k) in rows.iter().enumerate() {
            combination[(row, order[*k])] = 1.0;
            for j in 0..p - rank {
                let column = order[rank + j];
                combination[(row, column)] = dependent[(*k, j)] * scales[column] / scales[order[*k]];
            }
        }
        Self { independent: rows.iter().map(|k| order[*k]).collect(), combination }
    }

    /// Number of base parameters.
    #[must_use]
    pub fn count(&self) -> usize {
        self.independent.len()
    }

    /// The values K π.
    #[must_use]
    pub fn values(&self, parameters: &[f64]) -> Vec<f64> {
        let row = |i: usize| parameters.iter().enumerate().map(|(j, x)| self.combination[(i, j)] * x).sum();
        (0..self.count()).map(row).collect()
    }
}

/// R of a QR factorisation with column pivoting, up to the numerical rank.
struct Pivoted {
    upper: DMatrix<f64>,
    order: Vec<usize>,
    /// Numerical rank: the number of pivots above [`TOLERANCE`] times the first.
    rank: usize,
}

impl Pivoted {
    /// Source: Golub and Van Loan, "Matrix Computations", section 5.4 (column pivoting), by modified Gram–Schmidt.
    fn of(mut columns: DMatrix<f64>) -> Self {
        let p = columns.ncols();
        let (mut upper, mut order) = (DMatrix::zeros(p, p), (0..p).collect::<Vec<_>>());
        for k in 0..p {
            let norms: Vec<f64> = (k..p).map(|j| columns.column(j).norm()).collect();
            let largest = (k..p).max_by(|i, j| norms[i - k].total_cmp(&norms[j - k])).unwrap_or(k);
            let norm = norms[largest - k];
            if norm <= TOLERANCE * upper[(0, 0)] {
                return Self { upper, order, rank: k };
            }
            columns.swap_columns(k, largest);
            upper.swap_columns(k, largest);
            order.swap(k, largest);
            upper[(k, k)] = norm;
            columns.column_mut(k).unscale_mut(norm);
            let unit = columns.column(k).into_owned();
            for j in k + 1..p {
                upper[(k, j)] = unit.dot(&columns.column(j));
                columns.column_mut(j).axpy(-upper[(k, j)], &unit, 1.0);
            }
        }
        Self { upper, order, rank: p }
    }
}
