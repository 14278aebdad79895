//! Features of a distance r = |d| that are inputs of networks, defined once for the pairs of
//! [`modular`](super::modular) and the edges of [`graph`](super::graph).

use crate::network::Jet;
use crate::scalar::Scalar;

/// A feature z(r) of a distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DistanceFeature {
    /// z = r, m; not differentiable at 0.
    Distance,
    /// z = 1/r, 1/m; infinite at 0.
    Inverse,
    /// z = r², m²: smooth everywhere, and without a square root.
    Squared,
}

impl DistanceFeature {
    /// z with its first `O` ≤ 2 derivatives in s = r².
    #[inline(always)]
    pub fn of_square<S: Scalar, const O: usize>(self, s: S) -> Jet<S, O> {
        match self {
            Self::Squared => Jet::parameter(s),
            Self::Distance => {
                let r = s.sqrt();
                let first = S::one().half() / r;
                Jet::series(r, [first, -first.half() / s])
            }
            Self::Inverse => {
                let z = S::one() / s.sqrt();
                let first = -z.half() / s;
                Jet::series(z, [first, S::constant(-1.5) * first / s])
            }
        }
    }

    /// z of a difference d, and (∂z/∂r)/r, which gives ∂z/∂d when multiplied by d; both with tangents along
    /// those of d.
    #[inline(always)]
    pub fn of_difference<S: Scalar, const T: usize, const D: usize>(
        self,
        d: &[Jet<S, T>; D],
    ) -> [Jet<S, T>; 2] {
        let squares = d.iter().map(|d| d.times(d));
        let square = squares.reduce(|sum, square| sum.plus(&square)).unwrap_or(Jet::zero());
        if self == Self::Squared {
            return [square, Jet::constant(S::constant(2.0))];
        }
        let r = square.value.sqrt();
        let inverse = S::one() / r;
        let distance = square.chain(r, inverse.half());
        let reciprocal = distance.chain(inverse, -inverse * inverse);
        if self == Self::Distance {
            return [distance, reciprocal];
        }
        let cube = reciprocal.times(&reciprocal).times(&reciprocal);
        [reciprocal, cube.scaled(-S::one())]
    }
}

#[cfg(test)]
mod tests {
    use super::DistanceFeature;
    use crate::network::Jet;

    /// ∂z/∂d and ∂²z/∂d² by the chain rule through s = |d|²: 2z′d and 2z′1 + 4z″ddᵀ.
    #[test]
    fn both_forms_have_the_same_derivatives() {
        for feature in [DistanceFeature::Distance, DistanceFeature::Inverse, DistanceFeature::Squared] {
            let d = [0.3_f64, -1.2, 0.7];
            let s: f64 = d.iter().map(|d| d * d).sum();
            let Jet { value, tangent: [first, second] } = feature.of_square(s);
            let [z, rate] = feature.of_difference(&Jet::<_, 3>::along_axes(&d, 0));
            assert!((z.value - value).abs() < 1e-15);
            assert!((rate.value - 2.0 * first).abs() < 1e-14);
            for (i, d) in d.iter().enumerate() {
                assert!((z.tangent[i] - 2.0 * first * d).abs() < 1e-14);
                assert!((rate.tangent[i] - 4.0 * second * d).abs() < 1e-14, "{feature:?} {i}");
            }
        }
    }
}
