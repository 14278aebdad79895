use crate::discrete::StepError;
use crate::linear::{add_scaled, multiply};
use crate::scalar::Real;

/// Linear approximation of a node: δx⁺ = A δx + B δu.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transition<R, const D: usize, const M: usize> {
    /// A = ∂x⁺/∂x, row by row.
    pub a: [[R; D]; D],
    /// B = ∂x⁺/∂u, row by row.
    pub b: [[R; M]; D],
}

impl<R: Real, const D: usize, const M: usize> Transition<R, D, M> {
    /// No motion: A = 1, B = 0.
    pub fn identity() -> Self {
        Self { a: crate::linear::identity(), b: [[R::zero(); M]; D] }
    }

    /// A δx + B δu.
    pub fn apply(&self, dx: &[R; D], du: &[R; M]) -> [R; D] {
        add_scaled(&multiply(&self.a, dx), R::one(), &multiply(&self.b, du))
    }
}

/// A controlled process that passes from node to node.
///
/// A plant gives the same numbers for the same arguments.
pub trait Plant<R: Real, const D: usize, const M: usize> {
    /// A motion under way: the state with whatever its steps carry on.
    type Motion;

    /// Begins a motion at a state.
    ///
    /// # Errors
    /// [`StepError::NotFinite`] if a number is not finite.
    fn begin(&self, x: &[R; D]) -> Result<Self::Motion, StepError<R>>;

    /// Advances a motion by one node under the control u, and returns the state at the node's end.
    ///
    /// # Errors
    /// [`StepError`] if the node cannot be computed; the motion is then over.
    fn advance(&self, motion: &mut Self::Motion, u: &[R; M]) -> Result<[R; D], StepError<R>>;

    /// Linearises the node that begins at x under the control u.
    ///
    /// # Errors
    /// As [`Plant::advance`].
    fn linearise(&self, x: &[R; D], u: &[R; M]) -> Result<Transition<R, D, M>, StepError<R>>;
}

impl<R: Real, T: Plant<R, D, M>, const D: usize, const M: usize> Plant<R, D, M> for &T {
    type Motion = T::Motion;

    fn begin(&self, x: &[R; D]) -> Result<Self::Motion, StepError<R>> {
        (**self).begin(x)
    }

    fn advance(&self, motion: &mut Self::Motion, u: &[R; M]) -> Result<[R; D], StepError<R>> {
        (**self).advance(motion, u)
    }

    fn linearise(&self, x: &[R; D], u: &[R; M]) -> Result<Transition<R, D, M>, StepError<R>> {
        (**self).linearise(x, u)
    }
}
