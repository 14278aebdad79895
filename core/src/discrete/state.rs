use super::newton::{Residual, Target};
use super::{Control, Interval, Path, Solved, StepError};
use crate::lagrangian::Lagrangian;
use crate::linear;
use crate::scalar::{Compensated, Real, all_finite};

/// Steps that the initial guess extrapolates from.
const HISTORY: usize = 3;

/// Where a discrete trajectory is: position and momentum, both summed with compensation, and the last increments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<R, const N: usize> {
    q: [Compensated<R>; N],
    p: [Compensated<R>; N],
    /// Increment and bubble of the last steps, newest first; the first `known` are real.
    history: [Increment<R, N>; HISTORY],
    known: u8,
    /// What Newton's method left of the last step's equations.
    left: Residual<R, N>,
}

/// w and s of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Increment<R, const N: usize> {
    w: [R; N],
    s: [R; N],
}

impl<R: Real, const N: usize> State<R, N> {
    /// Position q and velocity v; p = L_v(q, v). An error where a number is not finite.
    pub fn new<L: Lagrangian<R, N>>(lagrangian: &L, q: [R; N], v: [R; N]) -> Result<Self, StepError<R>> {
        Self::with_momentum(q, lagrangian.linearization(&q, &v).l_v, v)
    }

    /// Position q, momentum p, and a guess of the next increment (about the velocity). An error where a number is not
    /// finite.
    pub fn with_momentum(q: [R; N], p: [R; N], w: [R; N]) -> Result<Self, StepError<R>> {
        let (q, p) = (q.map(Compensated::new), p.map(Compensated::new));
        Self::checked(&q, &p, &w)?;
        let history = [Increment { w, s: [R::zero(); N] }; HISTORY];
        Ok(Self { q, p, history, known: 1, left: Residual::zero() })
    }

    /// A state of which nothing is known: position and momentum are not numbers, and every step is refused.
    // Once a program: small rather than fast.
    #[inline(never)]
    pub(crate) fn unknown() -> Self {
        let unknown = [Compensated::new(R::constant(f64::NAN)); N];
        let history = [Increment { w: [R::zero(); N], s: [R::zero(); N] }; HISTORY];
        Self { q: unknown, p: unknown, history, known: 1, left: Residual::zero() }
    }

    /// q.
    pub fn q(&self) -> [R; N] {
        self.q.map(|q| q.value())
    }

    /// p.
    pub fn p(&self) -> [R; N] {
        self.p.map(|p| p.value())
    }

    /// v = M⁻¹p, T being taken as ½vᵀM(q)v.
    ///
    /// # Errors
    /// [`StepError::Singular`] where M is, [`StepError::NotFinite`] where a number of it is not finite.
    pub fn velocity<L: Lagrangian<R, N>>(&self, lagrangian: &L) -> Result<[R; N], StepError<R>> {
        let mass = lagrangian.linearization(&self.q(), &[R::zero(); N]).l_vv;
        Ok(linear::solve(mass, self.p())?)
    }

    /// What the next step starts from.
    pub(super) fn target(&self) -> Target<R, N> {
        let Residual { momentum, bubble } = self.left;
        let momentum = core::array::from_fn(|i| self.p[i].carry() + momentum[i]);
        Target { p0: self.p(), left: Residual { momentum, bubble } }
    }

    /// The last increment (q_k − q_{k−1})/h, or the guess the state was made with.
    pub fn last_increment(&self) -> [R; N] {
        self.history[0].w
    }

    /// The next path, its increment and bubble extrapolated by the polynomials through the last ones.
    pub(super) fn initial_guess<P: Path>(&self, h: R, u: &Control<R, N>) -> Interval<R, P, N> {
        let [a, b, c] = &self.history;
        let w = core::array::from_fn(|i| self.extrapolated(a.w[i], b.w[i], c.w[i]));
        let s = core::array::from_fn(|i| self.extrapolated(a.s[i], b.s[i], c.s[i]));
        Interval::new(self.q(), w, h, *u).moved(&[R::zero(); N], &s)
    }

    #[inline(always)]
    fn extrapolated(&self, a: R, b: R, c: R) -> R {
        match self.known {
            0 | 1 => a,
            2 => a + (a - b),
            _ => R::constant(3.0) * (a - b) + c,
        }
    }

    /// Goes one step on; on error the state is what it was.
    pub(super) fn advance<P: Path>(&mut self, h: R, solved: &Solved<R, P, N>) -> Result<(), StepError<R>> {
        let (w, s) = (solved.interval.increment(), solved.interval.bubble());
        let q = core::array::from_fn(|i| self.q[i].plus(h * w[i]));
        let p = core::array::from_fn(|i| self.p[i].plus(solved.balance.impulse[i]));
        Self::checked(&q, &p, &w)?;
        let [a, b, _] = self.history;
        (self.q, self.p) = (q, p);
        self.history = [Increment { w, s }, a, b];
        self.known = (self.known + 1).min(HISTORY as u8);
        self.left = solved.left;
        Ok(())
    }

    /// An error where a number is not finite.
    #[inline(always)]
    fn checked(q: &[Compensated<R>; N], p: &[Compensated<R>; N], w: &[R; N]) -> Result<(), StepError<R>> {
        let finite = [q, p].iter().all(|sums| all_finite(&sums.map(|sum| sum.value())));
        if finite && all_finite(w) { Ok(()) } else { Err(StepError::NotFinite) }
    }
}
