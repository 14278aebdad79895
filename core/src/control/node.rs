use super::Transition;
use crate::linear::{add_scaled, multiply};
use crate::scalar::Real;

/// A node of a motion: its state and control, its linear approximation, and the change of control that the last backward pass found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node<R, const D: usize, const M: usize> {
    /// State x at the start of the node.
    pub x: [R; D],
    /// Control u, held over the node.
    pub u: [R; M],
    /// Number of ticks that the node lasts, at least 1.
    pub ticks: u16,
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
    /// The trial under way.
    pub(super) trial: Trial<R, D, M>,
}

/// A node of a trial motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trial<R, const D: usize, const M: usize> {
    /// Number of ticks.
    pub ticks: u16,
    /// State at the start.
    pub x: [R; D],
    /// Control.
    pub u: [R; M],
    /// Course.
    pub course: [R; D],
}

impl<R: Copy, const D: usize, const M: usize> Node<R, D, M> {
    /// Memory of a node: all its numbers are the given zero, as a constant expression has it. In static memory it takes no flash.
    pub const fn blank(zero: R) -> Self {
        let (x, u) = ([zero; D], [zero; M]);
        Self {
            x,
            u,
            ticks: 0,
            transition: Transition { a: [x; D], b: [u; D] },
            change: u,
            gain: [x; M],
            multiplier: x,
            course: x,
            trial: Trial { ticks: 0, x, u, course: x },
        }
    }
}

impl<R: Real, const D: usize, const M: usize> Node<R, D, M> {
    /// A node of some ticks with the given control, its state unknown.
    pub fn new(ticks: u16, u: [R; M]) -> Self {
        let blank = Self::blank(R::zero());
        let trial = Trial { ticks, u, ..blank.trial };
        Self { u, ticks, transition: Transition::identity(), trial, ..blank }
    }

    /// Control at x for a part of the change, without limits.
    pub(super) fn control(&self, part: R, x: &[R; D]) -> [R; M] {
        let held = self.followed(&self.x, x);
        core::array::from_fn(|j| held[j] + part * self.change[j])
    }

    /// Control u − K(x − x̄), without limits.
    pub(super) fn followed(&self, reference: &[R; D], x: &[R; D]) -> [R; M] {
        feedback((&self.u, &self.gain), &add_scaled(x, -R::one(), reference))
    }

    /// Makes the trial the present node.
    pub(super) fn accept(&mut self) {
        let Trial { ticks, x, u, course } = self.trial;
        (self.ticks, self.x, self.u, self.course) = (ticks, x, u, course);
    }
}

/// u − K δx.
pub(super) fn feedback<R: Real, const D: usize, const M: usize>(
    (u, gain): (&[R; M], &[[R; D]; M]),
    dx: &[R; D],
) -> [R; M] {
    add_scaled(u, -R::one(), &multiply(gain, dx))
}
