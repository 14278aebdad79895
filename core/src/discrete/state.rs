use super::contact::End;
use super::newton::{Residual, Target};
use super::{Control, Interval, Path, Solved, StepError};
use crate::lagrangian::Lagrangian;
use crate::linear;
use crate::scalar::{Compensated, Real, all_finite};

/// Number of steps from which the initial guess extrapolates.
const HISTORY: usize = 3;

/// Numbers of a state, one row of N per quantity, from which [`State::resume`] continues with the same bits: q and its carry (m or rad), p
/// and its carry (kg m/s or kg m²/s), the last three increments (m/s or rad/s) each with its bubble, newest first, and the two residuals that
/// Newton's method left.
pub type SavedState<R, const N: usize> = [[R; N]; 4 + 2 * HISTORY + 2];

/// State of a discrete trajectory: position and momentum, both summed with compensation, and the last increments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<R, const N: usize> {
    q: [Compensated<R>; N],
    p: [Compensated<R>; N],
    /// Increment and bubble of the last steps, newest first; only the first `known` entries are valid.
    history: [Increment<R, N>; HISTORY],
    known: u8,
    /// Residual that Newton's method left in the last step.
    left: Residual<R, N>,
}

/// Increment w and bubble s of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Increment<R, const N: usize> {
    w: [R; N],
    s: [R; N],
}

impl<R: Real, const N: usize> State<R, N> {
    /// Creates a state at position q with velocity v; p = L_v(q, v). An error if a number is not finite.
    pub fn new<L: Lagrangian<R, N>>(lagrangian: &L, q: [R; N], v: [R; N]) -> Result<Self, StepError<R>> {
        Self::with_momentum(q, lagrangian.linearization(&q, &v).l_v, v)
    }

    /// Creates a state from position q, momentum p, and a guess of the next increment (about the velocity). An error if a number is not
    /// finite.
    pub fn with_momentum(q: [R; N], p: [R; N], w: [R; N]) -> Result<Self, StepError<R>> {
        let (q, p) = (q.map(Compensated::new), p.map(Compensated::new));
        Self::checked(&q, &p, &w)?;
        let history = [Increment { w, s: [R::zero(); N] }; HISTORY];
        Ok(Self { q, p, history, known: 1, left: Residual::zero() })
    }

    /// Creates an unknown state: position and momentum are NaN, and every step is refused.
    // Called once per program, so optimised for size, not speed.
    #[inline(never)]
    pub(crate) fn unknown() -> Self {
        let unknown = [Compensated::new(R::constant(f64::NAN)); N];
        let history = [Increment { w: [R::zero(); N], s: [R::zero(); N] }; HISTORY];
        Self { q: unknown, p: unknown, history, known: 1, left: Residual::zero() }
    }

    /// Returns the state as numbers, and how many of its increments are known.
    pub fn save(&self) -> (SavedState<R, N>, u8) {
        let Self { q, p, history: [a, b, c], known, left } = self;
        let split = |sums: &[Compensated<R>; N]| [sums.map(|sum| sum.value()), sums.map(|sum| sum.carry())];
        let ([q, q_carry], [p, p_carry]) = (split(q), split(p));
        ([q, q_carry, p, p_carry, a.w, a.s, b.w, b.s, c.w, c.s, left.momentum, left.bubble], *known)
    }

    /// Restores the state that [`State::save`] returned.
    ///
    /// # Errors
    /// [`StepError::NotFinite`] if a number is infinite or NaN.
    pub fn resume(saved: &SavedState<R, N>, known: u8) -> Result<Self, StepError<R>> {
        if !saved.iter().all(all_finite) {
            return Err(StepError::NotFinite);
        }
        let [q, q_carry, p, p_carry, w0, s0, w1, s1, w2, s2, momentum, bubble] = *saved;
        let sums = |value: [R; N], carry: [R; N]| {
            core::array::from_fn(|i| Compensated::from_parts(value[i], carry[i]))
        };
        let history = [(w0, s0), (w1, s1), (w2, s2)].map(|(w, s)| Increment { w, s });
        let (q, p) = (sums(q, q_carry), sums(p, p_carry));
        let known = known.clamp(1, HISTORY as u8);
        Ok(Self { q, p, history, known, left: Residual { momentum, bubble } })
    }

    /// Position q, m or rad.
    pub fn q(&self) -> [R; N] {
        self.q.map(|q| q.value())
    }

    /// Momentum p, kg m/s or kg m²/s.
    pub fn p(&self) -> [R; N] {
        self.p.map(|p| p.value())
    }

    /// Velocity v = M⁻¹p, with T taken as ½vᵀM(q)v.
    ///
    /// # Errors
    /// [`StepError::Singular`] if M is singular, [`StepError::NotFinite`] if one of its numbers is not finite.
    pub fn velocity<L: Lagrangian<R, N>>(&self, lagrangian: &L) -> Result<[R; N], StepError<R>> {
        let mass = lagrangian.linearization(&self.q(), &[R::zero(); N]).l_vv;
        Ok(linear::solve(mass, self.p())?)
    }

    /// Starting data of the next step.
    pub(super) fn target(&self) -> Target<R, N> {
        let Residual { momentum, bubble } = self.left;
        let momentum = core::array::from_fn(|i| self.p[i].carry() + momentum[i]);
        Target { p0: self.p(), left: Residual { momentum, bubble } }
    }

    /// The last increment (q_k − q_{k−1})/h, or the guess with which the state was created.
    pub fn last_increment(&self) -> [R; N] {
        self.history[0].w
    }

    /// The bubble of the last step; 0 at order 2, and before the first step.
    pub fn last_bubble(&self) -> [R; N] {
        self.history[0].s
    }

    /// Guess of the next path: increment and bubble, each extrapolated by the polynomial through its last
    /// values.
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

    /// The guess with coordinates at rest that were at rest in the last step.
    pub(super) fn rested<P: Path>(&self, guess: Interval<R, P, N>) -> Interval<R, P, N> {
        guess.with_increments(&self.last_increment().map(|w| (w == R::zero()).then_some(w)))
    }

    /// Advances by one step; an error leaves the state unchanged.
    pub(super) fn advance<P: Path>(&mut self, h: R, solved: &Solved<R, P, N>) -> Result<(), StepError<R>> {
        let p = core::array::from_fn(|i| self.p[i].plus(solved.balance.impulse[i]));
        self.advance_with(h, solved, p)
    }

    /// [`State::advance`] for friction that sticks: the momentum of a coordinate at rest is set, not summed.
    pub(super) fn advance_to<P: Path>(
        &mut self,
        h: R,
        solved: &Solved<R, P, N>,
        end: &End<R, N>,
    ) -> Result<(), StepError<R>> {
        let p = core::array::from_fn(|i| {
            let momentum = end.momentum[i];
            if end.held[i] { Compensated::new(momentum) } else { self.p[i].plus(momentum) }
        });
        self.advance_with(h, solved, p)?;
        for (q, stop) in self.q.iter_mut().zip(end.on_stop) {
            *q = stop.map_or(*q, Compensated::new);
        }
        Ok(())
    }

    #[inline(always)]
    fn advance_with<P: Path>(
        &mut self,
        h: R,
        solved: &Solved<R, P, N>,
        p: [Compensated<R>; N],
    ) -> Result<(), StepError<R>> {
        let (w, s) = (solved.interval.increment(), solved.interval.bubble());
        let q = core::array::from_fn(|i| self.q[i].plus(h * w[i]));
        Self::checked(&q, &p, &w)?;
        let [a, b, _] = self.history;
        (self.q, self.p) = (q, p);
        self.history = [Increment { w, s }, a, b];
        self.known = (self.known + 1).min(HISTORY as u8);
        self.left = solved.left;
        Ok(())
    }

    /// Checks that all numbers are finite.
    #[inline(always)]
    fn checked(q: &[Compensated<R>; N], p: &[Compensated<R>; N], w: &[R; N]) -> Result<(), StepError<R>> {
        let finite = [q, p].iter().all(|sums| all_finite(&sums.map(|sum| sum.value())));
        if finite && all_finite(w) { Ok(()) } else { Err(StepError::NotFinite) }
    }
}
