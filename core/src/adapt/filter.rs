//! Kalman filter of constant numbers, with the covariance as the product UDUᵀ.

use crate::linear::add_scaled;
use crate::scalar::Real;

/// Estimate of P numbers x from scalar measurements y = a·x + e, with its covariance C = UDUᵀ: U is upper triangular with ones on its
/// diagonal, D diagonal and never negative, so C cannot lose its sign by rounding. T = P(P − 1)/2 is the number of entries above the
/// diagonal of U.
///
/// A number of variance 0 stays what it is, and costs no bit of the others: a filter may have more places than it uses.
///
/// Sources: G. Bierman, "Factorization Methods for Discrete Sequential Estimation", 1977 (measurements); C. Thornton and G. Bierman 1980, after
/// W. Agee and R. Turner 1972 (growth by one direction); L. Cao and H. Schwartz 2000 (forgetting along a measurement); P. Huber 1964 (weights of outliers).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filter<R, const P: usize, const T: usize> {
    estimate: [R; P],
    /// Columns of U above the diagonal, one after the other: column j has j entries.
    upper: [R; T],
    diagonal: [R; P],
}

/// Weight of one measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement<'a, R, const P: usize> {
    /// Row a.
    pub row: &'a [R; P],
    /// Measured y.
    pub value: R,
    /// Variance of e, above 0.
    pub variance: R,
    /// Largest square of an innovation, over its variance, that counts fully. A larger one counts as if e had the variance with which it were this
    /// large, so that a single wrong reading moves the estimate little.
    pub largest: R,
    /// Share of the knowledge along C a that is forgotten before the measurement is taken, from 0 to below 1.
    pub forgotten: R,
}

/// Difference between a measurement and what the filter expected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Innovation<R> {
    /// y − a·x before the measurement.
    pub value: R,
    /// Variance of it, a·C a plus that of e.
    pub variance: R,
}

impl<R: Real> Innovation<R> {
    /// Square over variance: near 1 on average if the variances are right.
    pub fn normalised_square(&self) -> R {
        self.value * self.value / self.variance
    }
}

/// Products of the factors with a row.
struct Spread<R, const P: usize> {
    /// Uᵀa.
    seen: [R; P],
    /// D Uᵀa.
    weighted: [R; P],
}

impl<R: Real, const P: usize> Spread<R, P> {
    /// aᵀC a.
    fn variance(&self) -> R {
        self.seen.iter().zip(&self.weighted).fold(R::zero(), |sum, (f, g)| sum + *f * *g)
    }
}

impl<R: Real, const P: usize, const T: usize> Filter<R, P, T> {
    /// Creates the estimate 0 with independent standard deviations, 0 or more.
    pub fn new(deviations: [R; P]) -> Self {
        Self::at([R::zero(); P], deviations)
    }

    /// Creates an estimate with independent standard deviations, 0 or more.
    pub fn at(estimate: [R; P], deviations: [R; P]) -> Self {
        const { assert!(2 * T == P * P.saturating_sub(1), "T is P(P − 1)/2") };
        Self { estimate, upper: [R::zero(); T], diagonal: deviations.map(|s| s * s) }
    }

    /// The numbers x.
    pub fn estimate(&self) -> &[R; P] {
        &self.estimate
    }

    /// Variance of number i; 0 for one that the filter does not have.
    pub fn variance(&self, i: usize) -> R {
        let own = self.diagonal.get(i).copied().unwrap_or_else(R::zero);
        let later = self.diagonal.iter().enumerate().skip(i + 1);
        later.fold(own, |sum, (j, d)| {
            let u = self.column(j).get(i).copied().unwrap_or_else(R::zero);
            sum + u * u * *d
        })
    }

    /// Takes a measurement, and returns how far it was from what was expected. The estimate is unchanged if the measurement is not finite.
    pub fn take(&mut self, measurement: &Measurement<R, P>) -> Option<Innovation<R>> {
        let &Measurement { row, value, variance, largest, forgotten } = measurement;
        let spread = self.spread(row);
        let expected = row.iter().zip(&self.estimate).fold(R::zero(), |sum, (a, x)| sum + *a * *x);
        let (innovation, seen) = (value - expected, spread.variance());
        let (total, grown) = (seen / (R::one() - forgotten) + variance, R::one() / (R::one() - forgotten));
        if !(innovation.is_finite() && total.is_finite() && total > R::zero()) {
            return None;
        }
        let more = (innovation * innovation / largest - total).max(R::zero());
        let gain = self.change(&spread, (seen, grown), variance + more);
        self.estimate = add_scaled(&self.estimate, grown * innovation / (total + more), &gain);
        Some(Innovation { value: innovation, variance: total })
    }

    /// Forgets along C a and then takes a measurement of variance R, as one change of C; returns C a as it was before. With s = aᵀC a and the
    /// factor F by which forgetting lets s grow:
    ///
    /// C ← C + (F − 1) C a aᵀC/s − F² C a aᵀC/(F s + R) = C − C a aᵀC/(s + R′), R′ = F R/(F − (F − 1) R/s),
    ///
    /// that is, as if nothing were forgotten and the measurement had the variance R′. Where R′ has no finite value above 0, more is forgotten
    /// than learned.
    fn change(&mut self, spread: &Spread<R, P>, (seen, grown): (R, R), variance: R) -> [R; P] {
        let (more, known) = (grown - R::one(), grown * seen);
        let rest = known - more * variance;
        if rest > R::zero() {
            return self.narrow(spread, known * variance / rest);
        }
        let gain = self.times_upper(&spread.weighted);
        if seen > R::zero() {
            self.widen(gain, -rest / (seen * (known + variance)));
        }
        gain
    }

    /// Moves numbers x so that a·x changes by `by`, at the least cost in the metric C⁻¹: well-known numbers move little. They stay where they
    /// are if C says that a·x cannot change.
    pub fn moved(&self, x: &[R; P], row: &[R; P], by: R) -> [R; P] {
        let spread = self.spread(row);
        let seen = spread.variance();
        if seen > R::zero() { add_scaled(x, by / seen, &self.times_upper(&spread.weighted)) } else { *x }
    }

    /// Adds `variance` ≥ 0 to number i: it is known that much less.
    pub fn loosen(&mut self, i: usize, variance: R) {
        let mut direction = [R::zero(); P];
        if let Some(one) = direction.get_mut(i) {
            *one = R::one();
            self.widen(direction, variance);
        }
    }

    fn column(&self, j: usize) -> &[R] {
        let begin = j * j.saturating_sub(1) / 2;
        self.upper.get(begin..begin + j).unwrap_or_default()
    }

    fn spread(&self, row: &[R; P]) -> Spread<R, P> {
        let (mut seen, mut rest) = (*row, self.upper.as_slice());
        for (j, sum) in seen.iter_mut().enumerate() {
            let (column, others) = rest.split_at_checked(j).unwrap_or_default();
            *sum = column.iter().zip(row).fold(*sum, |sum, (u, a)| sum + *u * *a);
            rest = others;
        }
        let mut weighted = seen;
        weighted.iter_mut().zip(&self.diagonal).for_each(|(g, d)| *g = *g * *d);
        Spread { seen, weighted }
    }

    /// U g.
    fn times_upper(&self, g: &[R; P]) -> [R; P] {
        let mut product = *g;
        for (j, g) in g.iter().enumerate() {
            product.iter_mut().zip(self.column(j)).for_each(|(sum, u)| *sum += *u * *g);
        }
        product
    }

    /// Updates the factors by a measurement with the given variance, and returns C a.
    fn narrow(&mut self, spread: &Spread<R, P>, variance: R) -> [R; P] {
        let (mut gain, mut before) = ([R::zero(); P], variance);
        let (mut rest, terms) = (self.upper.as_mut_slice(), spread.seen.iter().zip(&spread.weighted));
        for (j, ((f, g), d)) in terms.zip(&mut self.diagonal).enumerate() {
            let after = before + *f * *g;
            *d = *d * (before / after);
            let back = -*f / before;
            let (column, others) = core::mem::take(&mut rest).split_at_mut_checked(j).unwrap_or_default();
            for (u, k) in column.iter_mut().zip(&mut gain) {
                let old = *u;
                *u = old + back * *k;
                *k += *g * old;
            }
            if let Some(own) = gain.get_mut(j) {
                *own = *g;
            }
            (before, rest) = (after, others);
        }
        gain
    }

    /// C ← C + c w wᵀ, c ≥ 0.
    fn widen(&mut self, mut w: [R; P], mut c: R) {
        for j in (0..P).rev() {
            let begin = j * j.saturating_sub(1) / 2;
            let (Some(own), Some(d)) = (w.get(j).copied(), self.diagonal.get_mut(j)) else { return };
            let before = *d;
            let after = before + c * own * own;
            *d = after;
            if after <= R::zero() {
                continue;
            }
            let (share, pull) = (before / after, c * own / after);
            c = c * share;
            let Some(column) = self.upper.get_mut(begin..begin + j) else { return };
            for (u, w) in column.iter_mut().zip(&mut w) {
                let old = *u;
                *w -= own * old;
                *u = old + pull * *w;
            }
        }
    }
}
