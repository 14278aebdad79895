use super::StepError;
use crate::lagrangian::Lagrangian;
use crate::scalar::{Compensated, Real, all_finite};

/// Increments that the initial guess extrapolates from.
const HISTORY: usize = 3;

/// Where a discrete trajectory is: position and momentum, both summed with compensation, and the last increments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<R, const N: usize> {
    q: [Compensated<R>; N],
    p: [Compensated<R>; N],
    /// w of the last steps, newest first; the first `known` are real.
    increments: [[R; N]; HISTORY],
    known: u8,
}

impl<R: Real, const N: usize> State<R, N> {
    /// Position q and velocity v; p = L_v(q, v). An error where a number is not finite.
    pub fn new<L: Lagrangian<R, N>>(lagrangian: &L, q: [R; N], v: [R; N]) -> Result<Self, StepError<R>> {
        Self::with_momentum(q, lagrangian.gradient(&q, &v).l_v, v)
    }

    /// Position q, momentum p, and a guess of the next increment (about the velocity). An error where a number is not
    /// finite.
    pub fn with_momentum(q: [R; N], p: [R; N], w: [R; N]) -> Result<Self, StepError<R>> {
        let state = Self {
            q: q.map(Compensated::new),
            p: p.map(Compensated::new),
            increments: [w, [R::zero(); N], [R::zero(); N]],
            known: 1,
        };
        state.checked()
    }

    /// q.
    pub fn q(&self) -> [R; N] {
        self.q.map(|q| q.value())
    }

    /// p.
    pub fn p(&self) -> [R; N] {
        self.p.map(|p| p.value())
    }

    /// p with what rounding took from it.
    pub(super) fn momenta(&self) -> &[Compensated<R>; N] {
        &self.p
    }

    /// The last increment (q_k − q_{k−1})/h, or the guess the state was made with.
    pub fn last_increment(&self) -> [R; N] {
        self.increments[0]
    }

    /// The next increment, extrapolated by the polynomial through the last ones.
    pub(super) fn initial_guess(&self) -> [R; N] {
        let [a, b, c] = &self.increments;
        let three = R::constant(3.0);
        core::array::from_fn(|i| match self.known {
            0 | 1 => a[i],
            2 => a[i] + (a[i] - b[i]),
            _ => three * (a[i] - b[i]) + c[i],
        })
    }

    /// The state one step on.
    pub(super) fn advanced(&self, h: R, w: &[R; N], impulse: &[R; N]) -> Result<Self, StepError<R>> {
        let [a, b, _] = self.increments;
        let increments = [*w, a, b];
        let advanced = Self {
            q: core::array::from_fn(|i| self.q[i].plus(h * w[i])),
            p: core::array::from_fn(|i| self.p[i].plus(impulse[i])),
            increments,
            known: (self.known + 1).min(HISTORY as u8),
        };
        advanced.checked()
    }

    fn checked(self) -> Result<Self, StepError<R>> {
        let finite = all_finite(&self.q()) && all_finite(&self.p()) && all_finite(&self.increments[0]);
        if finite { Ok(self) } else { Err(StepError::NotFinite) }
    }
}
