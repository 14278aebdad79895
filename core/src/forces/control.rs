use crate::scalar::Real;

/// The control force τ over one step, at the actuator's output: its values at both ends, linear between them. N or N m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Control<R, const N: usize> {
    /// τ at the start.
    pub start: [R; N],
    /// τ at the end.
    pub end: [R; N],
}

impl<R: Real, const N: usize> Control<R, N> {
    /// Held control: one force at both ends (zero-order hold).
    pub const fn held(u: [R; N]) -> Self {
        Self { start: u, end: u }
    }

    /// No control.
    pub fn none() -> Self {
        Self::held([R::zero(); N])
    }

    /// τ at a fraction c of the step.
    #[inline(always)]
    pub fn at(&self, c: R) -> [R; N] {
        core::array::from_fn(|i| self.start[i] * (R::one() - c) + self.end[i] * c)
    }
}
