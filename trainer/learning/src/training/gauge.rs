//! Combinations of numbers that samples leave free, and the return along them to where the numbers began.
//!
//! A free direction is a change of the numbers that changes no residual to first order: an eigenvector of JᵀJ whose
//! eigenvalue is 0. An optimiser has no reason to stay anywhere along it, so the numbers it ends with depend on its
//! path. [`Free::least_motion`] removes this arbitrariness: among all weights with the same residuals it takes those nearest
//! to the initial ones, in relative terms.

use super::Objective;
use super::shown::Directions;
use crate::matrix::singular;
use nalgebra::{DMatrix, DVector};

/// Eigenvalue below which a direction is free, if the diagonal of the matrix is scaled to 1.
pub(crate) const RANK: f64 = 1e-9;
/// Relative change of a number, in a free direction of norm 1, below which the number is determined.
const HANGS: f64 = 1e-3;
/// Largest number of learned numbers that are moved: eigenvalues of larger matrices take seconds.
const MOST_NUMBERS: usize = 200;
/// Largest number of times that the normal equations are computed: they take about as long as an iteration of the fit.
const EVALUATIONS: usize = 60;
/// Largest relative change of a number in one move.
const FURTHEST: f64 = 0.3;
/// Relative change below which numbers are where they should be.
const NEAR: f64 = 1e-3;
/// Gauss–Newton steps that lead back to the least loss after a move.
const CORRECTIONS: usize = 3;
/// Number of times that the parameters of single samples are solved for after all samples have gone the way of a part.
const FOLLOWS: usize = 3;
/// Growth of moves as long as none has to be halved.
const GROWTH: f64 = 1.5;
/// Number of times that a move is halved if the loss rises.
const HALVINGS: usize = 4;
/// Part of itself that a number above 0 keeps in a move.
const LEAST_PART: f64 = 0.3;
/// Rise of the loss that is tolerated, as a multiple of the optimiser's tolerance.
const RISE: f64 = 3.0;

/// Directions that the samples leave free.
pub(crate) struct FreeDirections {
    /// Relative changes of the numbers, as orthonormal columns.
    basis: DMatrix<f64>,
    /// Directions of the numbers in units of 1/√(JᵀJ)_ii that the samples determine.
    shown: Directions,
}

/// A combination of numbers that the samples leave free: relative changes by number, that of the first being 1.
pub type Combination = Vec<(usize, f64)>;

impl FreeDirections {
    /// The directions that a matrix JᵀJ leaves free, for numbers of these sizes.
    pub fn of(gram: &DMatrix<f64>, sizes: &[f64]) -> Self {
        let (units, scaled) = with_unit_diagonal(gram);
        let shown = Directions::of(&scaled, |_| RANK);
        let hidden = shown.complement();
        let relative =
            DMatrix::from_fn(sizes.len(), hidden.ncols(), |i, k| units[i] / sizes[i] * hidden[(i, k)]);
        Self { basis: orthonormal(relative), shown }
    }

    /// Directions of the numbers in units of 1/√(JᵀJ)_ii that the samples determine.
    pub fn shown(&self) -> &Directions {
        &self.shown
    }

    /// Number of directions.
    pub fn count(&self) -> usize {
        self.basis.ncols()
    }

    /// Whether a number changes in one of the directions.
    pub fn moves(&self, i: usize) -> bool {
        self.basis.row(i).norm() > HANGS
    }

    /// One combination per direction. The first number of each occurs in no other combination.
    pub fn combinations(&self) -> Vec<Combination> {
        let (mut rest, mut firsts) = (self.basis.clone(), Vec::new());
        for k in 0..rest.ncols() {
            let first = rest.columns_range(k..).iamax_full();
            let (row, column) = (first.0, first.1 + k);
            rest.swap_columns(k, column);
            let pivot = rest[(row, k)];
            rest.column_mut(k).scale_mut(pivot.recip());
            let own = rest.column(k).into_owned();
            for other in (0..rest.ncols()).filter(|other| *other != k) {
                let part = rest[(row, other)];
                rest.column_mut(other).axpy(-part, &own, 1.0);
            }
            firsts.push(row);
        }
        let of = |(k, first): (usize, &usize)| {
            let others = (0..rest.nrows()).filter(|i| i != first && rest[(*i, k)].abs() > HANGS);
            std::iter::once((*first, 1.0)).chain(others.map(|i| (i, rest[(i, k)]))).collect()
        };
        firsts.iter().enumerate().map(of).collect()
    }

    /// The part of a relative change of the numbers that lies in these directions.
    fn part_of(&self, change: &DVector<f64>) -> DVector<f64> {
        &self.basis * self.basis.tr_mul(change)
    }
}

/// The units 1/√A_ii of numbers, 0 for a number on which nothing depends, and A in these units.
pub(crate) fn with_unit_diagonal(gram: &DMatrix<f64>) -> (Vec<f64>, DMatrix<f64>) {
    let unit = |square: f64| if square > f64::MIN_POSITIVE { square.sqrt().recip() } else { 0.0 };
    let units: Vec<f64> = (0..gram.nrows()).map(|i| unit(gram[(i, i)])).collect();
    let scaled = DMatrix::from_fn(units.len(), units.len(), |i, j| units[i] * units[j] * gram[(i, j)]);
    (units, scaled)
}

/// An orthonormal basis of the space that these columns span.
fn orthonormal(columns: DMatrix<f64>) -> DMatrix<f64> {
    let p = columns.nrows();
    let Some(found) = singular(&columns) else { return DMatrix::zeros(p, 0) };
    let least = RANK * found.values.first().copied().unwrap_or(0.0);
    let count = found.values.iter().filter(|value| **value > least).count();
    let column = |i: usize, k: usize| found.left[(i, k)] / found.values[k];
    DMatrix::from_fn(p, count, column)
}

/// Size of a number for relative changes: the larger of its value and its initial value, but at least its standard error
/// if all other numbers were known.
pub(crate) fn size(value: f64, initial: f64, error: f64) -> f64 {
    let size = value.abs().max(initial.abs()).max(error);
    if size > 0.0 { size } else { 1.0 }
}

/// Parts of a move that are tried one after the other.
fn halvings() -> impl Iterator<Item = f64> {
    (0..HALVINGS).map(|k| 0.5_f64.powi(k as i32))
}

/// Numbers of a loss that may be free.
#[derive(Clone, Copy)]
pub(crate) struct Free<'a> {
    pub objective: &'a dyn Objective,
    /// Positions of the numbers, among those that samples share.
    pub positions: &'a [usize],
    /// Initial values of all numbers that samples share.
    pub initial: &'a [f64],
}

impl Free<'_> {
    /// The weights with the same loss that are nearest to the initial ones in relative terms, and their loss; `None` if
    /// the samples leave nothing free, or if the weights are there already. `weights` are all parameters at a minimum.
    pub fn least_motion(self, weights: &[f64]) -> Option<(Vec<f64>, f64)> {
        let (mut best, bound) = self.completed(weights);
        let (mut found, mut step) = (None, FURTHEST);
        let mut left = EVALUATIONS;
        while left > 0 {
            left -= 1;
            let at = At::new(self, &best)?;
            let pull = at.pull();
            let largest = pull.amax();
            if largest < NEAR {
                break;
            }
            let steps = halvings().map(|part| step * part);
            let mut trials = steps.map(|step| {
                let change = &pull * (step / largest).min(1.0);
                Some((step, self.settled(self.moved(&best, (&at, &change)), (bound, &mut left))?))
            });
            let Some((taken, (trial, loss))) = trials.find_map(|trial| trial) else { break };
            (best, found) = (trial, Some(loss));
            step = if taken == step { (GROWTH * step).min(FURTHEST) } else { taken };
        }
        found.map(|loss| (best, loss))
    }

    /// [`Free::least_motion`] with the way found on `part`, a part of the samples, from `weights_of_part`. All samples go that way at once,
    /// or as far as their loss lets them.
    pub fn least_motion_of_part(
        self,
        weights: &[f64],
        (part, weights_of_part): (&dyn Objective, &[f64]),
    ) -> Option<(Vec<f64>, f64)> {
        let (moved, _) = Free { objective: part, ..self }.least_motion(weights_of_part)?;
        let (start, bound) = self.completed(weights);
        halvings().find_map(|far| {
            let mut trial = start.clone();
            let shared = trial.iter_mut().zip(&moved).take(self.objective.shared());
            shared.for_each(|(x, moved)| *x += far * (moved - *x));
            // The parameters of single samples follow step by step.
            let loss =
                (0..FOLLOWS).map(|_| self.objective.completed_loss(&mut trial)).find(|loss| *loss <= bound);
            loss.map(|loss| (trial, loss))
        })
    }

    /// The completed weights, and the largest loss that is taken for theirs.
    fn completed(self, weights: &[f64]) -> (Vec<f64>, f64) {
        let mut weights = weights.to_vec();
        let loss = self.objective.completed_loss(&mut weights);
        let bound = loss * (1.0 + RISE * self.objective.tolerance().max(f64::EPSILON));
        (weights, bound)
    }

    /// Weights with a loss of at most `bound`, by Gauss–Newton steps from these; `None` if they do not lead there with the
    /// evaluations that are left.
    fn settled(self, weights: Vec<f64>, (bound, left): (f64, &mut usize)) -> Option<(Vec<f64>, f64)> {
        let mut trial = weights;
        let mut loss = self.objective.completed_loss(&mut trial);
        for _ in 0..CORRECTIONS {
            if loss <= bound || *left == 0 {
                break;
            }
            *left -= 1;
            let at = At::new(self, &trial)?;
            trial = self.moved(&trial, (&at, &at.correction()?));
            loss = self.objective.completed_loss(&mut trial);
        }
        (loss <= bound).then_some((trial, loss))
    }

    /// The weights after a relative change of the numbers, each kept in its range. A number above 0 keeps a part of
    /// itself.
    fn moved(self, weights: &[f64], (at, change): (&At, &DVector<f64>)) -> Vec<f64> {
        let mut moved = weights.to_vec();
        for ((i, size), change) in at.positions.iter().zip(&at.sizes).zip(change.iter()) {
            let least =
                if self.objective.bounds().is_positive(*i) { LEAST_PART * weights[*i] } else { f64::MIN };
            moved[*i] = (weights[*i] + size * change).max(least);
        }
        let mut moved = self.objective.bounds().within(moved);
        self.objective.project(&mut moved);
        moved
    }
}

/// The numbers at some weights.
struct At {
    /// Positions of the numbers on which residuals depend.
    positions: Vec<usize>,
    /// JᵀJ and Jᵀr for these numbers.
    gram: DMatrix<f64>,
    gradient: DVector<f64>,
    /// Sizes of these numbers.
    sizes: Vec<f64>,
    /// Initial numbers less the present ones, in sizes.
    away: DVector<f64>,
    directions: FreeDirections,
}

impl At {
    /// `None` if the loss cannot be evaluated there, or if there are too many numbers.
    fn new(Free { objective, positions, initial }: Free, weights: &[f64]) -> Option<Self> {
        let equations = objective.normal_equations(weights)?;
        let depends = |i: &usize| equations.entry(*i, *i) > f64::MIN_POSITIVE;
        let positions: Vec<usize> = positions.iter().copied().filter(depends).collect();
        let p = positions.len();
        if p == 0 || p > MOST_NUMBERS {
            return None;
        }
        let gram = DMatrix::from_fn(p, p, |i, j| equations.entry(positions[i], positions[j]));
        let variance = equations.squares / equations.rows.max(1) as f64;
        let size = |k: usize, i: usize| size(weights[i], initial[i], (variance / gram[(k, k)]).sqrt());
        let sizes: Vec<f64> = positions.iter().enumerate().map(|(k, i)| size(k, *i)).collect();
        let away = positions.iter().zip(&sizes).map(|(i, size)| (initial[*i] - weights[*i]) / size);
        Some(Self {
            directions: FreeDirections::of(&gram, &sizes),
            gradient: DVector::from_iterator(p, positions.iter().map(|i| equations.gradient[*i])),
            away: DVector::from_iterator(p, away),
            positions,
            gram,
            sizes,
        })
    }

    /// The relative change along the free directions that leads nearest to the initial numbers.
    fn pull(&self) -> DVector<f64> {
        self.directions.part_of(&self.away)
    }

    /// The relative change of a Gauss–Newton step of what the samples determine; `None` if there is none in double
    /// precision.
    fn correction(&self) -> Option<DVector<f64>> {
        let ((units, scaled), p) = (with_unit_diagonal(&self.gram), self.positions.len());
        let gradient = DVector::from_fn(p, |i, _| units[i] * self.gradient[i]);
        let step = self.directions.shown.inverse(&scaled)? * gradient;
        Some(DVector::from_fn(p, |i, _| -units[i] / self.sizes[i] * step[i]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::training::{Bounds, NormalEquations, Range};

    /// Residuals a b − p, c d² − 4 and e − 2, with p given; all numbers are above 0.
    struct Products(Bounds, f64);

    impl Products {
        fn rows(&self, w: &[f64]) -> [(f64, [f64; 5]); 3] {
            let [a, b, c, d, e] = [w[0], w[1], w[2], w[3], w[4]];
            [
                (a * b - self.1, [b, a, 0.0, 0.0, 0.0]),
                (c * d * d - 4.0, [0.0, 0.0, d * d, 2.0 * c * d, 0.0]),
                (e - 2.0, [0.0, 0.0, 0.0, 0.0, 1.0]),
            ]
        }
    }

    impl Objective for Products {
        fn parameters(&self) -> usize {
            5
        }
        fn samples(&self) -> usize {
            3
        }
        fn loss(&self, weights: &[f64]) -> f64 {
            // The rest stands for noise.
            1e-4 + self.rows(weights).iter().map(|(r, _)| r * r).sum::<f64>()
        }
        fn normal_equations(&self, weights: &[f64]) -> Option<NormalEquations> {
            let mut sum = NormalEquations::zero(5);
            for (r, row) in self.rows(weights) {
                let slopes: Vec<(usize, f64)> = row.into_iter().enumerate().collect();
                sum.add_square(&slopes, r, 1.0);
            }
            (sum.rows, sum.squares) = (3, self.loss(weights));
            Some(sum)
        }
        fn gradient(&self, weights: &[f64], _: std::ops::Range<usize>) -> Option<NormalEquations> {
            self.normal_equations(weights)
        }
        fn project(&self, _: &mut [f64]) {}
        fn bounds(&self) -> &Bounds {
            &self.0
        }
    }

    const PATH: [f64; 5] = [0.6, 10.0, 0.05, 8.944_271_909_999_16, 2.0];

    fn products(p: f64) -> Products {
        Products(Bounds::new((0..5).map(|i| (i, Range::Positive)).collect()), p)
    }

    #[test]
    fn the_way_of_a_part_is_followed_if_the_loss_of_all_stays() {
        let (all, initial) = (products(6.0), [2.0, 3.0, 1.0, 2.2, 9.0]);
        let free = Free { objective: &all, positions: &[0, 1, 2, 3, 4], initial: &initial };
        let (expected, _) = free.least_motion(&PATH).unwrap();
        let (found, loss) = free.least_motion_of_part(&PATH, (&products(6.0), &PATH)).unwrap();
        assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
        assert!(loss < 1.001e-4, "{loss}");
        let other = [1.2, 10.0, PATH[2], PATH[3], PATH[4]];
        assert_eq!(free.least_motion_of_part(&PATH, (&products(12.0), &other)), None);
    }

    #[test]
    fn numbers_return_to_where_they_began_as_far_as_the_residuals_let_them() {
        let products = products(6.0);
        let initial = [2.0, 3.0, 1.0, 2.2, 9.0];
        let free = Free { objective: &products, positions: &[0, 1, 2, 3, 4], initial: &initial };
        let (found, loss) = free.least_motion(&PATH).unwrap();
        assert!(loss < 1.001e-4, "{loss}");
        assert!((found[0] * found[1] - 6.0).abs() < 1e-3 && (found[4] - 2.0).abs() < 1e-6, "{found:?}");
        // The initial a and b fit; c and d are those of the least relative change.
        assert!((found[0] - 2.0).abs() < 0.01 && (found[1] - 3.0).abs() < 0.01, "{found:?}");
        let change = |c: f64| ((c - 1.0) / c.max(1.0)).powi(2) + ((2.0 / c.sqrt() - 2.2) / 2.2).powi(2);
        let own = change(found[2]);
        assert!((found[2] * found[3] * found[3] - 4.0).abs() < 1e-3, "{found:?}");
        assert!([0.95, 1.05].into_iter().all(|part| change(part * found[2]) > own), "{found:?}");
        assert!(free.least_motion(&found).is_none_or(|(again, _)| (again[2] / found[2] - 1.0).abs() < 0.01));
    }

    #[test]
    fn combinations_are_named_by_their_relative_changes() {
        let products = Products(Bounds::default(), 6.0);
        let weights = [2.0, 3.0, 1.0, 2.0, 2.0];
        let gram = products.normal_equations(&weights).unwrap();
        let gram = DMatrix::from_fn(5, 5, |i, j| gram.entry(i, j));
        let directions = FreeDirections::of(&gram, &weights);
        assert_eq!((0..5).map(|i| directions.moves(i)).collect::<Vec<_>>(), [true, true, true, true, false]);
        let mut found = directions.combinations();
        found.iter_mut().for_each(|of| of.sort_by_key(|(i, _)| *i));
        found.sort_by_key(|of| of[0].0);
        for (own, expected) in found.iter().zip([[(0, -1.0), (1, 1.0)], [(2, 1.0), (3, -0.5)]]) {
            let factor = own[0].1 / expected[0].1;
            for ((i, part), (j, other)) in own.iter().zip(expected) {
                assert!(*i == j && (part - factor * other).abs() < 1e-9, "{found:?}");
            }
        }
    }
}
