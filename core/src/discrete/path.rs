use super::Order;
use crate::scalar::Scalar;
use core::fmt::Debug;

/// A Gauss point of the unit interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaussPoint<S> {
    /// Position c, between 0 and 1.
    pub c: S,
    /// Weight b; the weights of a path sum to 1.
    pub weight: S,
}

impl<S: Scalar> GaussPoint<S> {
    /// Bubble β(c) = 4c(1 − c).
    #[inline(always)]
    pub fn bubble(&self) -> S {
        S::constant(4.0) * self.c * (S::one() - self.c)
    }

    /// Whether the point lies in the first half of the step, where γ > 0.
    #[inline(always)]
    pub(super) fn is_early(&self) -> bool
    where
        S: PartialOrd,
    {
        self.bubble_rate() > S::zero()
    }

    /// Rate of the bubble, γ(c) = β′ = 4(1 − 2c).
    #[inline(always)]
    pub fn bubble_rate(&self) -> S {
        S::constant(4.0) * (S::one() - (self.c + self.c))
    }
}

/// The path that a step assumes between two positions, and the points at which it sums the action.
pub trait Path: Copy {
    /// Order of accuracy of the integrator.
    const ORDER: Order;
    /// Whether the path has a bubble.
    const BUBBLE: bool;
    /// Container for data of the bubble: one item, or none for a path without a bubble.
    type Bubbles<T: Copy + Debug>: Copy + Debug + AsRef<[T]> + AsMut<[T]>;
    /// The Gauss points.
    fn points<S: Scalar>() -> impl AsRef<[GaussPoint<S>]>;
    /// Wraps `value` for the bubble, if there is one.
    fn bubbles<T: Copy + Debug>(value: T) -> Self::Bubbles<T>;
}

/// A straight path, with the action taken at its midpoint: order 2.
#[derive(Clone, Copy, Debug)]
pub struct Midpoint;

impl Path for Midpoint {
    const ORDER: Order = Order::Two;
    const BUBBLE: bool = false;
    type Bubbles<T: Copy + Debug> = [T; 0];

    #[inline(always)]
    fn points<S: Scalar>() -> impl AsRef<[GaussPoint<S>]> {
        [GaussPoint { c: S::constant(0.5), weight: S::one() }]
    }

    #[inline(always)]
    fn bubbles<T: Copy + Debug>(_: T) -> [T; 0] {
        []
    }
}

/// A quadratic path, with the action summed over two Gauss points: order 4.
#[derive(Clone, Copy, Debug)]
pub struct Galerkin;

impl Path for Galerkin {
    const ORDER: Order = Order::Four;
    const BUBBLE: bool = true;
    type Bubbles<T: Copy + Debug> = [T; 1];

    #[inline(always)]
    fn points<S: Scalar>() -> impl AsRef<[GaussPoint<S>]> {
        // ½ ± √3/6. The first c is exactly 1 minus the second: the points mirror each other in every scalar, and D₁L_d and D₂L_d remain
        // derivatives of one function (else the energy drifts, by 1e-10 J per step in f32).
        let late = S::constant(0.788_675_134_594_812_9);
        let point = |c| GaussPoint { c, weight: S::constant(0.5) };
        [point(S::one() - late), point(late)]
    }

    #[inline(always)]
    fn bubbles<T: Copy + Debug>(value: T) -> [T; 1] {
        [value]
    }
}
