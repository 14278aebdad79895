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
/// A node is given by what is `held`: a control u, and for how many ticks, at least 1. A plant gives the same numbers for the same
/// arguments.
pub trait Plant<R: Real, const D: usize, const M: usize> {
    /// A motion under way: the state with whatever its steps carry on.
    type Motion;
    /// Data of a state that both nodes which meet there need for their linearisation.
    type Frame;

    /// Begins a motion at a state.
    ///
    /// # Errors
    /// [`StepError::NotFinite`] if a number is not finite.
    fn begin(&self, x: &[R; D]) -> Result<Self::Motion, StepError<R>>;

    /// Advances a motion by a node, and returns the state at the node's end. `course` receives what
    /// [`Plant::linearise`] may use again.
    ///
    /// # Errors
    /// [`StepError`] if the node cannot be computed; the motion is then over.
    fn advance(
        &self,
        motion: &mut Self::Motion,
        held: (u16, &[R; M]),
        course: &mut [R; D],
    ) -> Result<[R; D], StepError<R>>;

    /// Data of a state.
    fn frame(&self, x: &[R; D]) -> Self::Frame;

    /// Linearises a node from its two ends, each a state with its data, what is held, and its course.
    ///
    /// # Errors
    /// [`StepError`] if the node cannot be computed.
    fn linearise(
        &self,
        ends: [(&[R; D], &Self::Frame); 2],
        held: (u16, &[R; M]),
        course: &[R; D],
    ) -> Result<Transition<R, D, M>, StepError<R>>;

    /// Energy T + V of a state, and its slope; `None` if the plant has no energy.
    fn energy(&self, _: &[R; D]) -> Option<(R, [R; D])> {
        None
    }

    /// Linearises the node that begins at x.
    ///
    /// # Errors
    /// [`StepError`] if the node cannot be computed.
    fn linearise_at(&self, x: &[R; D], held: (u16, &[R; M])) -> Result<Transition<R, D, M>, StepError<R>> {
        let mut course = [R::zero(); D];
        let end = self.advance(&mut self.begin(x)?, held, &mut course)?;
        self.linearise([(x, &self.frame(x)), (&end, &self.frame(&end))], held, &course)
    }
}

impl<R: Real, T: Plant<R, D, M>, const D: usize, const M: usize> Plant<R, D, M> for &T {
    type Motion = T::Motion;
    type Frame = T::Frame;

    fn begin(&self, x: &[R; D]) -> Result<Self::Motion, StepError<R>> {
        (**self).begin(x)
    }

    fn advance(
        &self,
        motion: &mut Self::Motion,
        held: (u16, &[R; M]),
        course: &mut [R; D],
    ) -> Result<[R; D], StepError<R>> {
        (**self).advance(motion, held, course)
    }

    fn frame(&self, x: &[R; D]) -> Self::Frame {
        (**self).frame(x)
    }

    fn linearise(
        &self,
        ends: [(&[R; D], &Self::Frame); 2],
        held: (u16, &[R; M]),
        course: &[R; D],
    ) -> Result<Transition<R, D, M>, StepError<R>> {
        (**self).linearise(ends, held, course)
    }

    fn energy(&self, x: &[R; D]) -> Option<(R, [R; D])> {
        (**self).energy(x)
    }
}
