//! Stiction and end stops in a step: set-valued laws with two multipliers, as RATTLE has.
//!
//! The dry friction of a step is the impulse Λ⁻ = (h/2)λ⁻ at its start and Λ⁺ = (h/2)λ⁺ at its end. λ⁻ belongs to the increment w: where
//! λ⁻_i stays within the levels of [`Grip`], w_i = 0; else λ⁻_i = −c sign w_i. λ⁺ belongs in the same way to the velocity
//! v₁ = M(q₁)⁻¹p₁ at the end. While a coordinate slides, both are the midpoint rule of a constant force, of order 2; while it sticks, w_i and
//! v₁,i are exactly 0. A multiplier for both ends together would instead give p₁ = −p₀ at rest: the ringing of a stiff smooth law.
//! With V = 0 neither multiplier lets the kinetic energy grow: λ⁻·w ≤ 0 and λ⁺·v₁ ≤ 0.
//!
//! An end stop is such a law with one sign. A coordinate that would pass it within the step ends on it: w_i = (q̄_i − q₀,i)/h, by a force that
//! only pushes. Of its momentum at the end, as it would be without the stop, the velocity turns from v to −e v; a coordinate that rests on
//! the stop has v = 0, whatever e is, and so has one that would be back within a few steps. The instant of a strike is off by a part of the step.
//!
//! Where a coordinate sticks, its equation of momentum is replaced by w_i = 0 and that of its bubble by s_i = 0. A coordinate that
//! was revised to rest three times has no bubble when it moves either: with one, neither rest nor motion may agree. Every evaluation of Newton's
//! method compares the motions it was made for with what it finds, and revises them, at most 8n + 2 times in a step; the bound on updates
//! counts from the last revision. From the n-th revision on, one coordinate is revised at a time, which ends for friction of any coupling
//! (Murty 1974).
//!
//! Source: Moreau, "Unilateral contact and dry friction in finite freedom dynamics", 1988; Acary and Brogliato, "Numerical methods for
//! nonsmooth dynamical systems", 2008, chapter 10.

use super::contact::{Contact, End, slack};
use super::motion::Motion;
use super::newton::{Solved, StepEquations, Target};
use super::{GaussPoint, Interval, Path, StepError, Variation};
use crate::forces::{Forces, System};
use crate::lagrangian::Lagrangian;
use crate::linear::{add_scaled, solve};
use crate::newton::{Equations, Newton, Report};
use crate::scalar::Real;

/// A step that is solved: its path, and the momentum at its end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ended<R, P, const N: usize> {
    pub solved: Solved<R, P, N>,
    pub end: End<R, N>,
}

/// Equations of a step with friction, for motions that they revise.
struct StickingEquations<'a, R: Real, L, F, P: Path, const N: usize, const ENDS: bool> {
    step: StepEquations<'a, R, L, F, P, N, ENDS>,
    contact: Contact<R, N>,
    /// Impulses that would balance the equations of momentum.
    needed: [R; N],
    /// Number of revisions.
    revisions: usize,
    /// Whether the last evaluation revised the motions.
    revised: bool,
}

impl<'a, R, L, F, P, const N: usize, const ENDS: bool> StickingEquations<'a, R, L, F, P, N, ENDS>
where
    R: Real,
    L: Lagrangian<R, N>,
    F: Forces<R, N>,
    P: Path,
{
    fn new(system: &'a System<L, F>, guess: Interval<R, P, N>, target: &'a Target<R, N>) -> Self {
        let grips = system.forces.grips(&guess.u.at(R::one().half()));
        let contact = Contact::new(&grips, &system.forces.stops(), &guess);
        let step = StepEquations::new(system, guess, target);
        Self { step, contact, needed: [R::zero(); N], revisions: 0, revised: false }
    }

    /// Solves the step. Rest that lasts takes one evaluation and no update.
    fn solve(&mut self, newton: &Newton<R>) -> Result<Report<R>, StepError<R>> {
        if self.contact.all_rest() {
            let residual = self.residual();
            if !self.revised {
                return newton.accepted(Report { iterations: 0, residual });
            }
        }
        let report = newton.solve(self)?;
        if self.revised || self.contradicts() { Err(StepError::NotConverged(report)) } else { Ok(report) }
    }

    /// Whether motions that may be revised no more contradict the last evaluation.
    fn contradicts(&self) -> bool {
        let (w, slacks) = (self.step.interval.increment(), self.step.size().map(slack));
        self.contact.contradict(self.revisions, &w, &self.needed, &slacks)
    }

    /// Compares the motions with the last evaluation. Between two given ends the increments tell the motions: no momentum at the start is given
    /// that would tell an impulse.
    #[inline(always)]
    fn revise(&mut self) {
        if ENDS {
            return;
        }
        let (w, slacks) = (self.step.interval.increment(), self.step.size().map(slack));
        self.revised = self.contact.revise_path(self.revisions, &w, &self.needed, &slacks);
        self.revisions += usize::from(self.revised);
    }

    /// Impulse Λ⁻ of friction at the start. A stop that is struck acts at the end.
    fn start_impulse(&self, i: usize) -> R {
        if self.contact.rests(i) { self.needed[i] } else { self.contact.sliding(i) }
    }

    /// Momentum at the end.
    fn end(&self, p0: &[R; N]) -> Result<End<R, N>, StepError<R>> {
        let impulse = &self.step.linearised.balance.impulse;
        let gain: [R; N] = core::array::from_fn(|i| impulse[i] + self.start_impulse(i));
        let sliding: [R; N] = core::array::from_fn(|i| gain[i] + self.contact.sliding(i));
        let before = add_scaled(&gain, R::one(), p0);
        if !self.contact.any_held() {
            if self.keeps_sliding(&add_scaled(&sliding, R::one(), p0))? {
                return Ok(End::sliding(sliding));
            }
        } else if let Some(end) = self.contact.resting_end(&before) {
            return Ok(end);
        }
        self.contact.end(self.step.system, &self.step.interval.end(), (&before, &gain))
    }

    /// Whether every coordinate certainly keeps its direction to the end if friction gives the momentum p₁: if w changes by less than half
    /// until then. The matrix of Newton's method, nearly −M, tells the change without another evaluation.
    fn keeps_sliding(&self, p1: &[R; N]) -> Result<bool, StepError<R>> {
        let (v, w) = (solve(self.step.linearised.momentum_w, *p1)?, self.step.interval.increment());
        let keeps = |i: usize| (v[i] + w[i]).abs() < w[i].abs().half();
        Ok((0..N).all(|i| self.contact.motion(i) == Motion::Free || keeps(i)))
    }
}

impl<R, L, F, P, const N: usize, const ENDS: bool> Equations<R> for StickingEquations<'_, R, L, F, P, N, ENDS>
where
    R: Real,
    L: Lagrangian<R, N>,
    F: Forces<R, N>,
    P: Path,
{
    type Error = StepError<R>;

    #[inline(always)]
    fn residual(&mut self) -> R {
        self.step.evaluate();
        self.needed = self.step.left.momentum.map(|r| -r);
        self.revise();
        let (contact, needed) = (&self.contact, &self.needed);
        let (w, s) = (self.step.interval.increment(), self.step.interval.bubble());
        let StepEquations { linearised, left, .. } = &mut self.step;
        let impulse: [R; N] = core::array::from_fn(|i| contact.sliding(i));
        if !ENDS {
            let balance = add_scaled(&left.momentum, R::one(), &impulse);
            // The impulse that keeps a coordinate at rest is any, but finite.
            let off = |i: usize| {
                linearised.momentum_w[i][i] * (w[i] - contact.increment(i)) + needed[i] * R::zero()
            };
            left.momentum = contact.held(&balance, off);
        }
        if let Some(blocks) = linearised.bubble.as_ref().first() {
            let balance = add_scaled(&left.bubble, bubble_share::<R, P>(), &impulse);
            left.bubble = contact.straight(&balance, |i| blocks.bubble_s[i][i] * s[i]);
        }
        self.step.largest()
    }

    #[inline(always)]
    fn revised(&self) -> bool {
        self.revised
    }

    #[inline(always)]
    fn update(&mut self) -> Result<(), StepError<R>> {
        let (w, s) = (self.step.interval.increment(), self.step.interval.bubble());
        let StepEquations { linearised, left, .. } = &mut self.step;
        self.contact.hold_rows(&mut linearised.momentum_w, R::one());
        left.momentum = self.contact.held(&left.momentum, |i| w[i] - self.contact.increment(i));
        if let Some(blocks) = linearised.bubble.as_mut().first_mut() {
            self.contact.hold_rows(&mut blocks.momentum_s, R::zero());
            self.contact.straighten_rows(&mut blocks.bubble_w, R::zero());
            self.contact.straighten_rows(&mut blocks.bubble_s, R::one());
            left.bubble = self.contact.straight(&left.bubble, |i| s[i]);
        }
        self.step.update()?;
        // To the last bit, which the solution of the linear equations is not: only at rest does the impulse tell whether friction holds.
        self.step.interval = self
            .contact
            .settled(&self.step.interval, |i| if ENDS { w[i] } else { self.contact.increment(i) });
        Ok(())
    }
}

/// Impulse of a constant force in the equation of the bubble over that in the equation of the momentum: 2 Σ b β.
#[inline(always)]
fn bubble_share<R: Real, P: Path>() -> R {
    let sum = |sum: R, point: &GaussPoint<R>| sum + point.weight * Variation::bubble(point, R::one()).force;
    let share = P::points().as_ref().iter().fold(R::zero(), sum);
    share + share
}

impl<R: Real> Newton<R> {
    /// [`Newton::solve_target`] for friction that sticks.
    pub(super) fn solve_sticking<L, F, P: Path, const N: usize>(
        &self,
        system: &System<L, F>,
        guess: Interval<R, P, N>,
        target: &Target<R, N>,
    ) -> Result<Ended<R, P, N>, StepError<R>>
    where
        L: Lagrangian<R, N>,
        F: Forces<R, N>,
    {
        let mut equations = StickingEquations::<_, _, _, _, N, false>::new(system, guess, target);
        let report = equations.solve(self)?;
        let end = equations.end(&target.p0)?;
        Ok(Ended { solved: equations.step.with_report(report), end })
    }

    /// Solves the path between two given ends for friction that sticks where they coincide; the momentum at its end.
    pub(super) fn solve_sticking_ends<L, F, P: Path, const N: usize>(
        &self,
        system: &System<L, F>,
        guess: Interval<R, P, N>,
    ) -> Result<[R; N], StepError<R>>
    where
        L: Lagrangian<R, N>,
        F: Forces<R, N>,
    {
        let target = Target::zero();
        let mut equations = StickingEquations::<_, _, _, _, N, true>::new(system, guess, &target);
        self.solve(&mut equations)?;
        let before = equations.step.linearised.balance.end_momentum();
        let q1 = equations.step.interval.end();
        let end = equations.contact.end(system, &q1, (&before, &before))?;
        Ok(end.momentum)
    }
}
