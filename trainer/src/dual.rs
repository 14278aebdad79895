//! Scalars with their derivatives along a direction: forward-mode differentiation of whatever core evaluates.

use crate::architecture::HostScalar;
use leastaction_core::network::Jet;
use leastaction_core::scalar::Scalar;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// x and its derivative along a direction: one, for more would make what a wide network keeps too large for a thread's stack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<S>(Jet<S, 1>);

impl<S: HostScalar> Dual<S> {
    /// x that does not move.
    pub fn fixed(x: S) -> Self {
        Self(Jet::constant(x))
    }

    /// x that moves with this slope.
    pub fn moving(value: S, slope: S) -> Self {
        Self(Jet { value, tangent: [slope] })
    }

    /// x.
    pub fn value(self) -> S {
        self.0.value
    }

    /// ∂x.
    pub fn slope(self) -> S {
        let [slope] = self.0.tangent;
        slope
    }

    /// f(x), from the two numbers f(x) and f′(x).
    fn chain(self, value: S, slope: S) -> Self {
        Self(self.0.chain(value, slope))
    }
}

impl<S: HostScalar> HostScalar for Dual<S> {
    #[inline]
    fn if_greater(self, than: Self, then: Self, otherwise: Self) -> Self {
        let choose = |a, b| self.value().if_greater(than.value(), a, b);
        Self::moving(choose(then.value(), otherwise.value()), choose(then.slope(), otherwise.slope()))
    }
}

impl<S: HostScalar> Add for Dual<S> {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self(self.0.plus(&other.0))
    }
}

impl<S: HostScalar> Sub for Dual<S> {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl<S: HostScalar> Mul for Dual<S> {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        Self(self.0.times(&other.0))
    }
}

impl<S: HostScalar> Div for Dual<S> {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        let value = self.value() / other.value();
        Self::moving(value, (self.slope() - value * other.slope()) / other.value())
    }
}

impl<S: HostScalar> Neg for Dual<S> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self::moving(-self.value(), -self.slope())
    }
}

impl<S: HostScalar> AddAssign for Dual<S> {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<S: HostScalar> SubAssign for Dual<S> {
    #[inline]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<S: HostScalar> Scalar for Dual<S> {
    type Weight = f64;

    #[inline]
    fn weight(w: f64) -> Self {
        Self::fixed(S::weight(w))
    }
    #[inline]
    fn constant(x: f64) -> Self {
        Self::fixed(S::constant(x))
    }
    #[inline]
    fn sqrt(self) -> Self {
        let root = self.value().sqrt();
        self.chain(root, S::constant(0.5) / root)
    }
    #[inline]
    fn exp(self) -> Self {
        let value = self.value().exp();
        self.chain(value, value)
    }
    #[inline]
    fn ln_1p(self) -> Self {
        let x = self.value();
        self.chain(x.ln_1p(), S::one() / (S::one() + x))
    }
    #[inline]
    fn tanh(self) -> Self {
        let value = self.value().tanh();
        self.chain(value, S::one() - value * value)
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value().sin_cos();
        (self.chain(sin, cos), self.chain(cos, -sin))
    }
    #[inline]
    fn wrapped(self) -> Self {
        self.chain(self.value().wrapped(), S::one())
    }
    #[inline]
    fn max(self, other: Self) -> Self {
        self.if_greater(other, self, other)
    }
    #[inline]
    fn neg_abs(self) -> Self {
        Self::zero().if_greater(self, self, -self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use leastaction_core::scalar::{LANES, Lanes};
    use num_dual::{Dual64, DualNum};

    /// Two numbers that move, in the last lane; the others have other values.
    fn pair(x: [f64; 2], slopes: [f64; 2]) -> ([Dual<Lanes>; 2], [Dual64; 2]) {
        let lanes = |x: f64| Lanes(std::array::from_fn(|lane| x + 0.01 * (LANES - 1 - lane) as f64));
        let dual = |k: usize| Dual::moving(lanes(x[k]), Lanes::constant(slopes[k]));
        ([0, 1].map(dual), [0, 1].map(|k| Dual64::new(x[k], slopes[k])))
    }

    fn assert_same(name: &str, found: Dual<Lanes>, expected: Dual64) {
        let at = |x: Lanes| x.0[LANES - 1];
        for (found, expected) in [(at(found.value()), expected.re), (at(found.slope()), expected.eps)] {
            assert!((found - expected).abs() < 1e-14 * (1.0 + expected.abs()), "{name}: {found} {expected}");
        }
    }

    #[test]
    fn arithmetic_and_functions_have_the_derivatives_of_num_dual() {
        for (x, y) in [(0.7, 2.3), (1.9, -0.4), (0.2, 0.3)] {
            let ([a, b], [p, q]) = pair([x, y], [1.3, -0.6]);
            let (mut more, mut less) = (a * b, a * b);
            more += b;
            less -= a;
            let cube = y * y * y;
            let both = [
                ("+", a + b, p + q),
                ("-", a - b, p - q),
                ("*", a * b, p * q),
                ("/", a / b, p / q),
                ("neg", -(a * b), -(p * q)),
                ("+=", more, p * q + q),
                ("-=", less, p * q - p),
                ("sqrt", (a * a + b * b).sqrt(), (p * p + q * q).sqrt()),
                ("exp", (a * b).exp(), (p * q).exp()),
                ("ln_1p", (a * a * b * b).ln_1p(), (p * p * q * q).ln_1p()),
                ("tanh", (a / b).tanh(), (p / q).tanh()),
                ("sin", (a * b).sin_cos().0, (p * q).sin()),
                ("cos", (a * b).sin_cos().1, (p * q).cos()),
                ("max", a.max(b), if x > y { p } else { q }),
                ("neg_abs", b.neg_abs(), if y > 0.0 { -q } else { q }),
                ("wrapped", (b * b * b).wrapped(), q * q * q - (cube - cube.wrapped())),
            ];
            for (name, found, expected) in both {
                assert_same(name, found, expected);
            }
        }
    }

    #[test]
    fn constants_and_weights_do_not_move() {
        assert_same("constant", Dual::constant(2.5), Dual64::from_re(2.5));
        assert_same("weight", Dual::weight(-0.5), Dual64::from_re(-0.5));
    }
}
