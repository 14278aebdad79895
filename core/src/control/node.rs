use super::Transition;
use crate::linear::multiply;
use crate::scalar::Real;

/// A node of a motion: its state and control, its linear approximation, and the change of control that the last backward pass found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node<R, const D: usize, const M: usize> {
    /// State x at the start of the node.
    pub x: [R; D],
    /// Control u, held over the node.
    pub u: [R; M],
    /// Linear approximation about x and u.
    pub transition: Transition<R, D, M>,
    /// Change k of the control.
    pub change: [R; M],
    /// Gain K of the deviation from x: u + αk − K δx. Rows of controls at a limit are 0.
    pub gain: [[R; D]; M],
    /// Multipliers of the limits of x.
    pub multiplier: [R; D],
    /// Course of the node, as its plant keeps it ([`Plant::advance`](super::Plant::advance)).
    pub course: [R; D],
    /// State, control and course of the trial under way.
    pub(super) trial: ([R; D], [R; M], [R; D]),
}

impl<R: Real, const D: usize, const M: usize> Node<R, D, M> {
    /// A node with the given control, its state unknown.
    pub fn new(u: [R; M]) -> Self {
        let zero = [R::zero(); D];
        Self {
            x: zero,
            u,
            transition: Transition::identity(),
            change: [R::zero(); M],
            gain: [zero; M],
            multiplier: zero,
            course: zero,
            trial: (zero, u, zero),
        }
    }

    /// Control at x for a part of the change, without limits.
    pub(super) fn control(&self, part: R, x: &[R; D]) -> [R; M] {
        let deviation = core::array::from_fn(|i| x[i] - self.x[i]);
        let feedback = multiply(&self.gain, &deviation);
        core::array::from_fn(|j| self.u[j] + part * self.change[j] - feedback[j])
    }
}
