//! Linear least squares for the numbers in which a torque is linear, as far as a log determines them.

use crate::torque::Samples;
use faer::{Mat, Side};
use leastaction_models::tree::Tree;
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
    pub matrix: Mat<f64>,
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
        let matrix = Mat::from_fn(rows.len(), columns, |i, j| rows[i][j]);
        Self { matrix, target: samples.tau.as_flat().to_vec(), coordinates: n }
    }

    /// Divides every row by the scale of its coordinate.
    #[must_use]
    pub fn over(mut self, scales: &[f64]) -> Self {
        let n = self.coordinates;
        self.target.iter_mut().enumerate().for_each(|(i, x)| *x /= scales[i % n]);
        self.matrix.col_iter_mut().for_each(|column| {
            column.iter_mut().enumerate().for_each(|(i, x)| *x /= scales[i % n]);
        });
        self
    }

    /// Torques predicted by these numbers, row by row.
    #[must_use]
    pub fn predict(&self, numbers: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.matrix.nrows()];
        for (j, number) in numbers.iter().enumerate() {
            sums.iter_mut().zip(self.matrix.col_as_slice(j)).for_each(|(sum, x)| *sum += number * x);
        }
        sums
    }

    /// The condition number of some columns, each scaled to norm 1; infinite if they are linearly dependent.
    #[must_use]
    pub fn condition_of(&self, columns: &[usize]) -> f64 {
        let chosen = Mat::from_fn(self.matrix.nrows(), columns.len(), |i, j| self.matrix[(i, columns[j])]);
        let scales = norms(&chosen);
        let gram = chosen.transpose() * &chosen;
        let scaled =
            Mat::from_fn(columns.len(), columns.len(), |i, j| gram[(i, j)] / (scales[i] * scales[j]));
        let Ok(squares) = scaled.self_adjoint_eigenvalues(Side::Lower) else { return f64::INFINITY };
        let (least, largest) =
            squares.iter().fold((f64::INFINITY, 0.0_f64), |(least, most), x| (least.min(*x), most.max(*x)));
        if least > TOLERANCE * TOLERANCE * largest { (largest / least).sqrt() } else { f64::INFINITY }
    }

    /// The solution; `None` if a number is not finite.
    #[must_use]
    pub fn solve(&self) -> Option<Solution> {
        let scales = norms(&self.matrix);
        let scaled =
            Mat::from_fn(self.matrix.nrows(), self.matrix.ncols(), |i, j| self.matrix[(i, j)] / scales[j]);
        let svd = scaled.thin_svd().ok()?;
        let singular: Vec<f64> = svd.S().column_vector().iter().copied().collect();
        let largest = singular.first().copied().unwrap_or(0.0);
        let rank = singular.iter().filter(|s| **s > TOLERANCE * largest).count();
        let mut numbers = vec![0.0; self.matrix.ncols()];
        for (k, s) in singular.iter().take(rank).enumerate() {
            let part: f64 = svd.U().col(k).iter().zip(&self.target).map(|(u, y)| u * y).sum::<f64>() / s;
            numbers.iter_mut().zip(svd.V().col(k).iter()).for_each(|(x, v)| *x += part * v);
        }
        numbers.iter_mut().zip(&scales).for_each(|(x, scale)| *x /= scale);
        let condition = largest / rank.checked_sub(1).map_or(0.0, |last| singular[last]);
        numbers.iter().all(|x| x.is_finite()).then_some(Solution { numbers, rank, condition })
    }
}

/// Norms of the columns; 1 for a zero column.
fn norms(matrix: &Mat<f64>) -> Vec<f64> {
    let norm = |column: usize| matrix.col_as_slice(column).iter().map(|x| x * x).sum::<f64>().sqrt();
    (0..matrix.ncols()).map(norm).map(|norm| if norm > 0.0 { norm } else { 1.0 }).collect()
}

/// The base parameters K π of a tree: the combinations of its parameters that its torques depend on. Every row of K has one independent
/// parameter and the dependent ones that add to it.
///
/// Source: Gautier, "Numerical calculation of the base inertial parameters of robots", 1991.
#[derive(Clone, Debug)]
pub struct BaseParameters {
    /// Indices of the independent parameters, in ascending order.
    pub independent: Vec<usize>,
    /// K, \[independent\]\[parameters\]; the columns of independent parameters hold 1 and 0.
    pub combination: Mat<f64>,
}

/// Seed of the random states; any would do.
const SEED: u64 = 1991;

impl BaseParameters {
    /// The base parameters of a tree, found at random states.
    #[must_use]
    pub fn of(tree: &Tree) -> Self {
        Self::among(tree, &(0..tree.parameter_count()).collect::<Vec<_>>())
    }

    /// The base parameters of the parameters `learned`, with the other parameters known; K is 0 in the columns of known parameters.
    #[must_use]
    pub fn among(tree: &Tree, learned: &[usize]) -> Self {
        let mut random = Pcg64::seed_from_u64(SEED);
        let (n, p) = (tree.coordinates(), tree.parameter_count());
        let mut rows: Vec<Vec<f64>> = Vec::new();
        while rows.len() < 4 * p {
            let mut state = || (0..n).map(|_| random.random_range(-3.0..3.0)).collect::<Vec<f64>>();
            rows.extend(tree.regressor(&state(), &state(), &state()));
        }
        let matrix = Mat::from_fn(rows.len(), learned.len(), |i, j| rows[i][learned[j]]);
        let scales = norms(&matrix);
        let scaled = Mat::from_fn(rows.len(), learned.len(), |i, j| matrix[(i, j)] / scales[j]);
        let Self { independent, combination } = Self::of_columns(&scaled, &scales);
        let mut all = Mat::zeros(combination.nrows(), p);
        for (j, column) in learned.iter().enumerate() {
            all.col_mut(*column).copy_from(combination.col(j));
        }
        Self { independent: independent.into_iter().map(|j| learned[j]).collect(), combination: all }
    }

    fn of_columns(scaled: &Mat<f64>, scales: &[f64]) -> Self {
        let qr = scaled.col_piv_qr();
        let (upper, order) = (qr.thin_R(), qr.P().arrays().0);
        let count = upper.nrows().min(upper.ncols());
        let first = if count > 0 { upper[(0, 0)].abs() } else { 0.0 };
        let rank = (0..count).take_while(|k| upper[(*k, *k)].abs() > TOLERANCE * first).count();
        let p = scaled.ncols();
        // R₁⁻¹R₂ by back substitution.
        let mut dependent = Mat::from_fn(rank, p - rank, |i, j| upper[(i, rank + j)]);
        for j in 0..p - rank {
            for i in (0..rank).rev() {
                let later: f64 = (i + 1..rank).map(|k| upper[(i, k)] * dependent[(k, j)]).sum();
                dependent[(i, j)] = (dependent[(i, j)] - later) / upper[(i, i)];
            }
        }
        let mut rows: Vec<usize> = (0..rank).collect();
        rows.sort_by_key(|k| order[*k]);
        let mut combination = Mat::zeros(rank, p);
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
