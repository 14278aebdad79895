use crate::scalar::Real;
use core::num::NonZero;

/// A band matrix with `band` diagonals on either side of the main one, in the caller's workspace; [`Banded::factor`] replaces it by its LU
/// factors.
///
/// Rows are stored one after another. Each row holds the 2 `band` + 1 entries around the diagonal, then the
/// size of the diagonal entry before elimination. Elimination does not pivot: A₁ M⁻¹ A₀ᵀ is symmetric positive
/// definite if both Jacobians are taken at the same position, and its symmetric part stays positive definite as
/// long as no constraint turns by much within a step. For a symmetric matrix the factors are LDLᵀ.
pub(crate) struct Banded<'a, R> {
    band: usize,
    entries: &'a mut [R],
}

/// Length of a stored row, 2 `band` + 2. Never 0, so no division by it can fail.
const fn width(band: usize) -> NonZero<usize> {
    NonZero::<usize>::MIN.saturating_add(band.saturating_mul(2).saturating_add(1))
}

impl<'a, R: Real> Banded<'a, R> {
    /// Workspace length of a matrix.
    pub const fn workspace(equations: usize, band: usize) -> usize {
        equations * width(band).get()
    }

    /// Creates a matrix with undefined entries in the given workspace.
    pub fn new(band: usize, entries: &'a mut [R]) -> Self {
        Self { band, entries }
    }

    /// Sets every entry inside the band; `sizes`: also the sizes by which pivots are judged, to those of the diagonal.
    #[inline(always)]
    pub fn set(&mut self, sizes: bool, entry: impl Fn(usize, usize) -> R) {
        let (band, width) = (self.band, width(self.band));
        let equations = self.entries.len() / width;
        for (k, row) in self.entries.chunks_exact_mut(width.get()).enumerate() {
            let mut diagonal = R::zero();
            for (offset, value) in row.iter_mut().enumerate() {
                let column = (k + offset).checked_sub(band).filter(|l| *l < equations && offset <= 2 * band);
                *value = column.map_or(R::zero(), |l| entry(k, l));
                if offset == band {
                    diagonal = value.abs();
                }
            }
            if let (true, Some(size)) = (sizes, row.last_mut()) {
                *size = diagonal;
            }
        }
    }

    /// Factors the matrix in place. Fails with the index of the row whose pivot is no more than rounding error,
    /// or is not finite.
    pub fn factor(&mut self) -> Result<(), usize> {
        self.eliminate(false)
    }

    /// [`Banded::factor`] for equations that may follow from those before them: their unknown is then 0. Fails with the index of a row that
    /// is not finite.
    pub fn factor_independent(&mut self) -> Result<(), usize> {
        self.eliminate(true)
    }

    /// Whether [`Banded::factor_independent`] has found that an equation follows from those before it.
    pub fn is_dependent(&self, equation: usize) -> bool {
        let mut rows = self.entries.chunks_exact(width(self.band).get());
        rows.nth(equation).and_then(|row| row.get(self.band)).is_some_and(|pivot| !pivot.is_finite())
    }

    #[inline(always)]
    fn eliminate(&mut self, skips: bool) -> Result<(), usize> {
        let (band, width) = (self.band, width(self.band));
        // A redundant row is left with a pivot of a few rounding units of its diagonal entry.
        let smallest = R::constant(64.0) * R::EPSILON;
        for k in 0..self.entries.len() / width {
            let Some((upper, lower)) = self.entries.split_at_mut_checked((k + 1) * width.get()) else {
                return Err(k);
            };
            let Some(row) = upper.get_mut(k * width.get()..) else { return Err(k) };
            let (Some(pivot), Some(size)) = (row.get(band).copied(), row.last()) else { return Err(k) };
            let is_dependent = pivot.abs() <= smallest * *size;
            if (is_dependent && !skips) || !pivot.is_finite() {
                return Err(k);
            }
            if let (true, Some(pivot)) = (is_dependent, row.get_mut(band)) {
                *pivot = R::constant(f64::INFINITY);
            }
            let mut above = row.iter().skip(band);
            let Some(pivot) = above.next() else { return Err(k) };
            for (offset, row) in lower.chunks_exact_mut(width.get()).take(band).enumerate() {
                let mut entries = row.iter_mut().skip(band - 1 - offset);
                let Some(factor) = entries.next() else { return Err(k) };
                *factor = *factor / *pivot;
                for (entry, above) in entries.zip(above.clone().take(band)) {
                    *entry -= *factor * *above;
                }
            }
        }
        Ok(())
    }

    /// Replaces b by the solution; call after [`Banded::factor`].
    pub fn solve(&self, b: &mut [R]) {
        debug_assert!(b.len() * width(self.band).get() == self.entries.len(), "{} numbers", b.len());
        let (band, width) = (self.band, width(self.band));
        for (k, row) in self.entries.chunks_exact(width.get()).enumerate() {
            let Some((done, [value, ..])) = b.split_at_mut_checked(k) else { return };
            for (factor, above) in row.iter().take(band).rev().zip(done.iter().rev()) {
                *value -= *factor * *above;
            }
        }
        for (k, row) in self.entries.chunks_exact(width.get()).enumerate().rev() {
            let Some((_, [value, done @ ..])) = b.split_at_mut_checked(k) else { return };
            let mut entries = row.iter().skip(band).take(band + 1);
            let Some(pivot) = entries.next() else { return };
            for (entry, below) in entries.zip(done.iter()) {
                *value -= *entry * *below;
            }
            *value = *value / *pivot;
        }
    }
}
