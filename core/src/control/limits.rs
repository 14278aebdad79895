use crate::scalar::Real;

/// A box: least and most of every component, infinite where there is no limit. Equal numbers are a value to be met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits<R, const N: usize> {
    /// Lower ends.
    pub least: [R; N],
    /// Upper ends, at least `least`.
    pub most: [R; N],
}

impl<R: Real, const N: usize> Limits<R, N> {
    /// No limits.
    pub fn none() -> Self {
        let infinite = R::constant(f64::INFINITY);
        Self { least: [-infinite; N], most: [infinite; N] }
    }

    /// The nearest point of the box; the lower end for a component that is NaN.
    #[inline]
    pub fn clamped(&self, x: &[R; N]) -> [R; N] {
        core::array::from_fn(|i| clamped(x[i], self.least[i], self.most[i]))
    }

    /// x − its nearest point in the box: the excess over the limits.
    #[inline]
    pub fn excess(&self, x: &[R; N]) -> [R; N] {
        core::array::from_fn(|i| x[i] - clamped(x[i], self.least[i], self.most[i]))
    }
}

fn clamped<R: Real>(x: R, least: R, most: R) -> R {
    if x > most {
        most
    } else if x >= least {
        x
    } else {
        least
    }
}

/// Augmented Lagrangian of a box of states, ½ρw_i e_i² − ½μ_i²/(ρw_i), with e the excess of x + μ/(ρw) over the box.
///
/// The slope is ρwe, the curvature ρw where e ≠ 0. The multipliers of the next round are the slopes of this one. Soft limits keep μ = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Penalty<R, const D: usize> {
    /// The box.
    pub limits: Limits<R, D>,
    /// Weights w > 0, the inverse squares of deviations of equal weight.
    pub weights: [R; D],
}

impl<R: Real, const D: usize> Penalty<R, D> {
    /// No limits.
    pub fn none() -> Self {
        Self { limits: Limits::none(), weights: [R::one(); D] }
    }

    /// Slope and curvature in component i at x; `scale` is ρ.
    #[inline]
    pub(super) fn slope(&self, i: usize, x: R, multiplier: R, scale: R) -> (R, R) {
        let weight = scale * self.weights[i];
        let shifted = x + multiplier / weight;
        let excess = shifted - clamped(shifted, self.limits.least[i], self.limits.most[i]);
        // An excess of exactly 0 is inside: no curvature.
        if excess.abs() > R::zero() { (weight * excess, weight) } else { (R::zero(), R::zero()) }
    }

    /// Value at x.
    pub(super) fn value(&self, x: &[R; D], multiplier: &[R; D], scale: R) -> R {
        let mut sum = R::zero();
        for i in 0..D {
            let weight = scale * self.weights[i];
            let (slope, _) = self.slope(i, x[i], multiplier[i], scale);
            sum += (slope * slope - multiplier[i] * multiplier[i]) / weight;
        }
        sum.half()
    }

    /// Multipliers of the next round.
    pub(super) fn multipliers(&self, x: &[R; D], multiplier: &[R; D], scale: R) -> [R; D] {
        core::array::from_fn(|i| self.slope(i, x[i], multiplier[i], scale).0)
    }

    /// Largest excess over the limits, each divided by its deviation of weight 1.
    pub fn violation(&self, x: &[R; D]) -> R {
        let each = self.limits.excess(x).into_iter().zip(self.weights);
        each.fold(R::zero(), |most, (excess, weight)| (excess.abs() * weight.sqrt()).max(most))
    }
}
