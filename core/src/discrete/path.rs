use crate::scalar::Scalar;

/// A Gauss point of the unit interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node<S> {
    /// τ, between 0 and 1.
    pub tau: S,
    /// b; the weights of a path sum to 1.
    pub weight: S,
}

impl<S: Scalar> Node<S> {
    /// β(τ) = 4τ(1 − τ), the bubble.
    #[inline(always)]
    pub fn bubble(&self) -> S {
        S::constant(4.0) * self.tau * (S::one() - self.tau)
    }

    /// γ(τ) = β′ = 4(1 − 2τ).
    #[inline(always)]
    pub fn bubble_rate(&self) -> S {
        S::constant(4.0) * (S::one() - (self.tau + self.tau))
    }
}

/// The path that a step assumes between two positions, and the points at which it sums the action.
pub trait Path: Copy {
    /// Order of accuracy of the integrator.
    const ORDER: u8;
    /// Whether the path has a bubble.
    const BUBBLE: bool;
    /// The Gauss points.
    fn nodes<S: Scalar>() -> impl AsRef<[Node<S>]>;
}

/// A straight path, the action taken at its midpoint: order 2.
#[derive(Clone, Copy, Debug)]
pub struct Midpoint;

impl Path for Midpoint {
    const ORDER: u8 = 2;
    const BUBBLE: bool = false;

    #[inline(always)]
    fn nodes<S: Scalar>() -> impl AsRef<[Node<S>]> {
        [Node { tau: S::constant(0.5), weight: S::one() }]
    }
}

/// A quadratic path, the action summed over two Gauss points: order 4.
#[derive(Clone, Copy, Debug)]
pub struct Galerkin;

impl Path for Galerkin {
    const ORDER: u8 = 4;
    const BUBBLE: bool = true;

    #[inline(always)]
    fn nodes<S: Scalar>() -> impl AsRef<[Node<S>]> {
        // ½ ± √3/6. The first is 1 − τ of the second, which is exact: the two mirror each other in every scalar, and D₁L_d
        // and D₂L_d remain the derivatives of one function (else the energy drifts, by 1e-10 J a step in f32).
        let late = S::constant(0.788_675_134_594_812_9);
        let node = |tau| Node { tau, weight: S::constant(0.5) };
        [node(S::one() - late), node(late)]
    }
}
