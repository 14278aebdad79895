//! Stiction in a step: friction as a set-valued law with two multipliers, as RATTLE has.
//!
//! The dry friction of a step is the impulse Λ⁻ = (h/2)λ⁻ at its start and Λ⁺ = (h/2)λ⁺ at its end. λ⁻ belongs to the increment w: where
//! λ⁻_i stays within the levels of [`Grip`], w_i = 0; else λ⁻_i = −c sign w_i. λ⁺ belongs in the same way to the velocity
//! v₁ = M(q₁)⁻¹p₁ at the end. While a coordinate slides, both are the midpoint rule of a constant force, of order 2; while it sticks, w_i and
//! v₁,i are exactly 0. A multiplier for both ends together would instead give p₁ = −p₀ at rest: the ringing of a stiff smooth law.
//! With V = 0 neither multiplier lets the kinetic energy grow: λ⁻·w ≤ 0 and λ⁺·v₁ ≤ 0.
//!
//! Where a coordinate sticks, its equation of momentum is replaced by w_i = 0 and that of its bubble by s_i = 0. Every evaluation of Newton's
//! method compares the motions it was made for with what it finds, and revises them, at most 2n + 1 times in a step; the bound on updates
//! counts from the last revision. From the n-th revision on, one coordinate is revised at a time, which ends for friction of any coupling
//! (Murty 1974).
//!
//! Source: Moreau, "Unilateral contact and dry friction in finite freedom dynamics", 1988; Acary and Brogliato, "Numerical methods for
//! nonsmooth dynamical systems", 2008, chapter 10.

use super::newton::{Solved, StepEquations, Target};
use super::{GaussPoint, Interval, Path, StepError, Variation};
use crate::forces::{Forces, Grip, System};
use crate::lagrangian::Lagrangian;
use crate::linear::{Matrix, add_scaled, multiply, solve};
use crate::newton::{Equations, Newton, Report};
use crate::scalar::{Real, all_finite};

/// Motion of a coordinate during a step or at its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Motion {
    Sticks,
    Forward,
    Backward,
    /// Moves without dry friction, and cannot stick.
    Free,
}

impl Motion {
    /// The motion that a velocity shows, under these levels of friction.
    #[inline(always)]
    fn of<R: Real>(v: R, grip: &Grip<R>) -> Self {
        if grip.forward + grip.backward == R::zero() {
            Self::Free
        } else if v > R::zero() {
            Self::Forward
        } else if v < R::zero() {
            Self::Backward
        } else {
            Self::Sticks
        }
    }
}

/// Which coordinates stick, and the impulses of friction that half a step can give.
#[derive(Clone, Copy, Debug)]
struct Contact<R, const N: usize> {
    /// Levels times h/2.
    grips: [Grip<R>; N],
    motion: [Motion; N],
}

impl<R: Real, const N: usize> Contact<R, N> {
    fn new(grips: &[Grip<R>; N], h: R, v: &[R; N]) -> Self {
        let half = h.abs().half();
        let impulse = |grip: &Grip<R>| Grip {
            forward: half * grip.forward,
            backward: half * grip.backward,
            breakaway: grip.breakaway,
        };
        let motion = core::array::from_fn(|i| Motion::of(v[i], &grips[i]));
        Self { grips: core::array::from_fn(|i| impulse(&grips[i])), motion }
    }

    #[inline(always)]
    fn sticks(&self, i: usize) -> bool {
        self.motion[i] == Motion::Sticks
    }

    fn any_sticks(&self) -> bool {
        self.motion.contains(&Motion::Sticks)
    }

    fn all_stick(&self) -> bool {
        self.motion.iter().all(|motion| *motion == Motion::Sticks)
    }

    /// Impulse of sliding friction; 0 where a coordinate sticks.
    #[inline(always)]
    fn sliding(&self, i: usize) -> R {
        match self.motion[i] {
            Motion::Sticks | Motion::Free => R::zero(),
            Motion::Forward => -self.grips[i].forward,
            Motion::Backward => self.grips[i].backward,
        }
    }

    /// The motion of coordinate i that agrees with its velocity or, at rest, with the impulse that keeps it there.
    #[inline(always)]
    fn agreeing(&self, i: usize, v: R, needed: R, slack: R) -> Motion {
        let Grip { forward, backward, breakaway } = self.grips[i];
        match self.motion[i] {
            // Not at rest yet: the impulse tells nothing.
            Motion::Sticks if v != R::zero() => Motion::Sticks,
            Motion::Sticks if needed < -(breakaway * forward + slack) => Motion::Forward,
            Motion::Sticks if needed > breakaway * backward + slack => Motion::Backward,
            Motion::Forward if v < R::zero() => Motion::Sticks,
            Motion::Backward if v > R::zero() => Motion::Sticks,
            same => same,
        }
    }

    /// Revises the motions after a solution with velocities v, in which coordinates at rest needed the impulses `needed`, known to `slack`.
    /// Returns whether any changed. From round N on only the last that contradicts the solution does.
    fn revise(&mut self, round: usize, v: &[R; N], needed: &[R; N], slack: &[R; N]) -> bool {
        let mut changed = false;
        for i in (0..N).rev() {
            let motion = self.agreeing(i, v[i], needed[i], slack[i]);
            if motion != self.motion[i] && !(changed && round >= N) {
                (self.motion[i], changed) = (motion, true);
            }
        }
        changed
    }

    /// Replaces the rows of coordinates that stick by those of the identity times `diagonal`.
    #[inline(always)]
    fn hold_rows(&self, matrix: &mut Matrix<R, N>, diagonal: R) {
        for i in (0..N).filter(|i| self.sticks(*i)) {
            matrix[i] = [R::zero(); N];
            matrix[i][i] = diagonal;
        }
    }

    /// Replaces the components of coordinates that stick.
    #[inline(always)]
    fn held(&self, x: &[R; N], at_rest: impl Fn(usize) -> R) -> [R; N] {
        core::array::from_fn(|i| if self.sticks(i) { at_rest(i) } else { x[i] })
    }
}

/// A step that is solved: its path, and the momentum at its end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ended<R, P, const N: usize> {
    pub solved: Solved<R, P, N>,
    pub end: End<R, N>,
}

/// Momentum at the end of a step with friction that sticks.
#[derive(Clone, Copy, Debug)]
pub(super) struct End<R, const N: usize> {
    /// Gain of momentum where a coordinate slides; its momentum where `sticks`.
    pub momentum: [R; N],
    /// Coordinates at rest.
    pub sticks: [bool; N],
}

/// The most rounds in which motions are revised.
const fn rounds(coordinates: usize) -> usize {
    2 * coordinates + 1
}

/// How closely an impulse in a sum of terms of this size is known.
#[inline(always)]
fn slack<R: Real>(size: R) -> R {
    R::constant(8.0) * R::EPSILON * size
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
        let contact = Contact::new(&grips, guess.h, &guess.increment());
        let step = StepEquations::new(system, guess, target);
        Self { step, contact, needed: [R::zero(); N], revisions: 0, revised: false }
    }

    /// Solves the step. Rest that lasts takes one evaluation and no update.
    fn solve(&mut self, newton: &Newton<R>) -> Result<Report<R>, StepError<R>> {
        if self.contact.all_stick() {
            let residual = self.residual();
            if !self.revised {
                return newton.accepted(Report { iterations: 0, residual });
            }
        }
        let report = newton.solve(self)?;
        if self.revised { Err(StepError::NotConverged(report)) } else { Ok(report) }
    }

    /// Compares the motions with the last evaluation.
    #[inline(always)]
    fn revise(&mut self) {
        let (w, slacks) = (self.step.interval.increment(), self.step.size().map(slack));
        self.revised = self.contact.revise(self.revisions, &w, &self.needed, &slacks);
        self.revisions += usize::from(self.revised);
    }

    /// Impulse Λ⁻ of friction at the start.
    fn start_impulse(&self, i: usize) -> R {
        if self.contact.sticks(i) { self.needed[i] } else { self.contact.sliding(i) }
    }

    /// Momentum at the end.
    fn end(&self, p0: &[R; N]) -> Result<End<R, N>, StepError<R>> {
        let impulse = &self.step.linearised.balance.impulse;
        let gain: [R; N] = core::array::from_fn(|i| impulse[i] + self.start_impulse(i));
        let sliding: [R; N] = core::array::from_fn(|i| gain[i] + self.contact.sliding(i));
        let before = add_scaled(&gain, R::one(), p0);
        if !self.contact.any_sticks() {
            if self.keeps_sliding(&add_scaled(&sliding, R::one(), p0))? {
                return Ok(End { momentum: sliding, sticks: [false; N] });
            }
        } else if let Some(end) = self.contact.all_rest(&before) {
            return Ok(end);
        }
        let mut contact = self.contact;
        contact.end(self.step.system, &self.step.interval.end(), &before, &gain)
    }

    /// Whether every coordinate certainly keeps its direction to the end if friction gives the momentum p₁: if w changes by less than half
    /// until then. The matrix of Newton's method, nearly −M, tells the change without another evaluation.
    fn keeps_sliding(&self, p1: &[R; N]) -> Result<bool, StepError<R>> {
        let (v, w) = (solve(self.step.linearised.momentum_w, *p1)?, self.step.interval.increment());
        let keeps = |i: usize| (v[i] + w[i]).abs() < w[i].abs().half();
        Ok((0..N).all(|i| self.contact.motion[i] == Motion::Free || keeps(i)))
    }
}

impl<R: Real, const N: usize> Contact<R, N> {
    /// The end at rest, if friction holds every coordinate; `before` is the momentum before friction acts at the end.
    fn all_rest(&self, before: &[R; N]) -> Option<End<R, N>> {
        let holds = |i: usize| {
            self.sticks(i)
                && self.agreeing(i, R::zero(), -before[i], slack(before[i].abs())) == Motion::Sticks
        };
        (0..N).all(holds).then(|| End { momentum: [R::zero(); N], sticks: [true; N] })
    }

    /// Solves the end: velocities v = M(q₁)⁻¹p₁ and impulses Λ⁺ that agree, from the momentum `before` friction acts there. `gain` is its
    /// difference to the momentum at the start of the step.
    fn end<L: Lagrangian<R, N>, F>(
        &mut self,
        system: &System<L, F>,
        q: &[R; N],
        before: &[R; N],
        gain: &[R; N],
    ) -> Result<End<R, N>, StepError<R>> {
        let mass = system.lagrangian.linearization(q, &[R::zero(); N]).l_vv;
        for round in 0..=rounds(N) {
            let mut rows = mass;
            self.hold_rows(&mut rows, R::one());
            let right = core::array::from_fn(|i| before[i] + self.sliding(i));
            let v = solve(rows, self.held(&right, |_| R::zero()))?;
            let p = multiply(&mass, &v);
            let needed = core::array::from_fn(|i| p[i] - before[i]);
            let slacks = core::array::from_fn(|i| slack(p[i].abs() + before[i].abs()));
            if !all_finite(&needed) {
                return Err(StepError::NotFinite);
            }
            if !self.revise(round, &v, &needed, &slacks) {
                let momentum = |i: usize| if self.sticks(i) { p[i] } else { gain[i] + self.sliding(i) };
                let sticks = self.motion.map(|motion| motion == Motion::Sticks);
                return Ok(End { momentum: core::array::from_fn(momentum), sticks });
            }
        }
        Err(StepError::NotConverged(Report::nothing()))
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
            let at_rest = |i: usize| linearised.momentum_w[i][i] * w[i] + needed[i] * R::zero();
            left.momentum = contact.held(&balance, at_rest);
        }
        if let Some(blocks) = linearised.bubble.as_ref().first() {
            let balance = add_scaled(&left.bubble, bubble_share::<R, P>(), &impulse);
            left.bubble = contact.held(&balance, |i| blocks.bubble_s[i][i] * s[i]);
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
        left.momentum = self.contact.held(&left.momentum, |i| w[i]);
        if let Some(blocks) = linearised.bubble.as_mut().first_mut() {
            self.contact.hold_rows(&mut blocks.momentum_s, R::zero());
            self.contact.hold_rows(&mut blocks.bubble_w, R::zero());
            self.contact.hold_rows(&mut blocks.bubble_s, R::one());
            left.bubble = self.contact.held(&left.bubble, |i| s[i]);
        }
        self.step.update()
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
        let end = equations.contact.end(system, &q1, &before, &before)?;
        Ok(end.momentum)
    }
}
