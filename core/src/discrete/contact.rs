//! Contacts of a step: which coordinates stick or lie on an end stop, and the momentum that this leaves at its end.

use super::motion::Motion;
use super::{Interval, Path, StepError};
use crate::forces::{Grip, Stop, System};
use crate::lagrangian::Lagrangian;
use crate::linear::{Matrix, multiply, solve, solve_many};
use crate::newton::Report;
use crate::scalar::{Real, all_finite};

/// Motions of all coordinates, the impulses that friction can give in half a step, and the increments that lead to the stops.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contact<R, const N: usize> {
    /// Levels times h/2.
    grips: [Grip<R>; N],
    stops: [Stop<R>; N],
    /// Increments w that lead to the lower and to the upper stop; 0 from a stop and from beyond it.
    to_stops: [[R; 2]; N],
    motion: [Motion; N],
    /// How often a motion of each coordinate was revised to one whose increment is given.
    returns: [u8; N],
}

/// Momentum at the end of a step with contacts.
#[derive(Clone, Copy, Debug)]
pub(super) struct End<R, const N: usize> {
    /// Gain of momentum where a coordinate moves freely; its momentum where `held`.
    pub momentum: [R; N],
    /// Coordinates whose velocity is given: at rest, or leaving a stop.
    pub held: [bool; N],
    /// The stop on which a coordinate ends that was away from it, m or rad.
    pub on_stop: [Option<R>; N],
}

impl<R: Real, const N: usize> End<R, N> {
    /// The end of a step without contacts.
    pub fn sliding(momentum: [R; N]) -> Self {
        Self { momentum, held: [false; N], on_stop: [None; N] }
    }
}

/// The most revisions of motions in a step and at its end. A set of motions that agrees is found in 2n + 1 if each is solved; Newton's method
/// revises them on its way.
const fn revisions(coordinates: usize) -> usize {
    8 * coordinates + 2
}

/// Number of steps within which forces would give a coordinate the velocity of a strike, below which it does not bounce: the time between
/// two bounces would be no longer.
const SLOW: f64 = 4.0;

/// Number of revisions to rest, or to a stop, after which the path of a coordinate has no bubble. A motion with a bubble and rest, which has
/// none, may both contradict what they lead to; of motions without a bubble always one agrees.
const RETURNS: u8 = 3;

/// How closely an impulse in a sum of terms of this size is known.
#[inline(always)]
pub(super) fn slack<R: Real>(size: R) -> R {
    R::constant(8.0) * R::EPSILON * size
}

impl<R: Real, const N: usize> Contact<R, N> {
    /// The contacts of a path, before any revision.
    pub fn new<P: Path>(grips: &[Grip<R>; N], stops: &[Stop<R>; N], path: &Interval<R, P, N>) -> Self {
        let (zero, half) = (R::zero(), path.h.abs().half());
        let (q0, w) = (path.start(), path.increment());
        let to_stops = core::array::from_fn(|i| {
            let [lower, upper] = [stops[i].lower, stops[i].upper].map(|stop| (stop - q0[i]) / path.h);
            [-((-lower).max(zero)), upper.max(zero)]
        });
        let grips = core::array::from_fn(|i| grips[i].over(half));
        let mut contact = Self { grips, stops: *stops, to_stops, motion: [Motion::Free; N], returns: [0; N] };
        contact.motion = core::array::from_fn(|i| contact.seen(i, w[i]));
        contact
    }

    /// The motion that a velocity shows.
    #[inline(always)]
    fn seen(&self, i: usize, v: R) -> Motion {
        let [lower, upper] = self.to_stops[i];
        match (v == R::zero(), lower == R::zero(), upper == R::zero()) {
            (true, true, _) => Motion::AtLower,
            (true, _, true) => Motion::AtUpper,
            _ => self.moving(i, v),
        }
    }

    /// The motion that a velocity shows away from the stops.
    #[inline(always)]
    fn moving(&self, i: usize, v: R) -> Motion {
        Motion::shown(&self.grips[i], v)
    }

    #[inline(always)]
    pub fn motion(&self, i: usize) -> Motion {
        self.motion[i]
    }

    /// Whether the increment of coordinate i is given: it sticks, or ends on a stop.
    #[inline(always)]
    fn is_held(&self, i: usize) -> bool {
        matches!(self.motion[i], Motion::Sticks | Motion::AtLower | Motion::AtUpper)
    }

    /// The increment w_i of a coordinate that is held.
    #[inline(always)]
    pub fn increment(&self, i: usize) -> R {
        let [lower, upper] = self.to_stops[i];
        match self.motion[i] {
            Motion::AtLower => lower,
            Motion::AtUpper => upper,
            _ => R::zero(),
        }
    }

    /// Whether the path of coordinate i has no bubble.
    #[inline(always)]
    fn is_straight(&self, i: usize) -> bool {
        self.is_held(i) || self.returns[i] >= RETURNS
    }

    /// Whether coordinate i does not move.
    #[inline(always)]
    pub fn rests(&self, i: usize) -> bool {
        self.is_held(i) && self.increment(i) == R::zero()
    }

    pub fn any_held(&self) -> bool {
        (0..N).any(|i| self.is_held(i))
    }

    pub fn all_rest(&self) -> bool {
        (0..N).all(|i| self.rests(i))
    }

    /// Impulse of sliding friction; 0 where a coordinate rests.
    #[inline(always)]
    pub fn sliding(&self, i: usize) -> R {
        match self.motion[i] {
            _ if self.rests(i) => R::zero(),
            // Slides until it strikes.
            Motion::AtUpper => Motion::Forward.sliding(&self.grips[i]),
            Motion::AtLower => Motion::Backward.sliding(&self.grips[i]),
            other => other.sliding(&self.grips[i]),
        }
    }

    /// The motion of coordinate i that agrees with its increment, which must lie between those to the stops, or, where it is held, with the
    /// impulse that this needs.
    #[inline(always)]
    fn agreeing(&self, i: usize, v: R, needed: R, known_to: R) -> Motion {
        let Grip { forward, backward, breakaway } = self.grips[i];
        let [lower, upper] = self.to_stops[i];
        let [forward_hold, backward_hold] = [breakaway * forward + known_to, breakaway * backward + known_to];
        let is_there = |at: R| (v - at).abs() <= slack(v.abs() + at.abs());
        match self.motion[i] {
            // Not where it is held yet: the impulse tells nothing.
            Motion::Sticks if v != R::zero() => Motion::Sticks,
            Motion::AtLower if !is_there(lower) => Motion::AtLower,
            Motion::AtUpper if !is_there(upper) => Motion::AtUpper,
            // A stop only pushes; friction holds too where the coordinate rests, and slides where it strikes.
            Motion::AtUpper if upper == R::zero() && needed > backward_hold => self.moving(i, -R::one()),
            Motion::AtLower if lower == R::zero() && needed < -forward_hold => self.moving(i, R::one()),
            Motion::AtUpper if upper > R::zero() && needed > known_to - forward => self.moving(i, R::one()),
            Motion::AtLower if lower < R::zero() && needed < backward - known_to => self.moving(i, -R::one()),
            Motion::Forward | Motion::Free if v > upper => Motion::AtUpper,
            Motion::Backward | Motion::Free if v < lower => Motion::AtLower,
            same => same.agreeing(&self.grips[i], v, needed, known_to),
        }
    }

    /// Revises the motions after a solution with increments w, in which coordinates that are held needed the impulses `needed`, known to
    /// `slack`. Returns whether any changed. From revision N on only the last coordinate that contradicts the solution does.
    pub fn revise_path(&mut self, revision: usize, w: &[R; N], needed: &[R; N], slack: &[R; N]) -> bool {
        revision < revisions(N) && self.revise(revision, |own, i| own.agreeing(i, w[i], needed[i], slack[i]))
    }

    /// Whether motions that were revised as often as they may be contradict a solution.
    pub fn contradict(&self, revision: usize, w: &[R; N], needed: &[R; N], slack: &[R; N]) -> bool {
        let differs = |i: usize| self.agreeing(i, w[i], needed[i], slack[i]) != self.motion[i];
        revision >= revisions(N) && (0..N).any(differs)
    }

    #[inline(always)]
    fn revise(&mut self, revision: usize, agreeing: impl Fn(&Self, usize) -> Motion) -> bool {
        let mut changed = false;
        for i in (0..N).rev() {
            let motion = agreeing(self, i);
            if motion != self.motion[i] && !(changed && revision >= N) {
                (self.motion[i], changed) = (motion, true);
                self.returns[i] += u8::from(self.is_held(i) && self.returns[i] < RETURNS);
            }
        }
        changed
    }

    /// Replaces the rows of coordinates that are held by those of the identity times `diagonal`.
    #[inline(always)]
    pub fn hold_rows(&self, matrix: &mut Matrix<R, N>, diagonal: R) {
        replace_rows(matrix, diagonal, |i| self.is_held(i));
    }

    /// Replaces the rows of coordinates without a bubble by those of the identity times `diagonal`.
    #[inline(always)]
    pub fn straighten_rows(&self, matrix: &mut Matrix<R, N>, diagonal: R) {
        replace_rows(matrix, diagonal, |i| self.is_straight(i));
    }

    /// Replaces the components of coordinates that are held.
    #[inline(always)]
    pub fn held(&self, x: &[R; N], replaced: impl Fn(usize) -> R) -> [R; N] {
        core::array::from_fn(|i| if self.is_held(i) { replaced(i) } else { x[i] })
    }

    /// Replaces the components of coordinates without a bubble.
    #[inline(always)]
    pub fn straight(&self, x: &[R; N], replaced: impl Fn(usize) -> R) -> [R; N] {
        core::array::from_fn(|i| if self.is_straight(i) { replaced(i) } else { x[i] })
    }

    /// The path with exactly these increments of coordinates that are held, and no bubble there.
    #[inline(always)]
    pub fn settled<P: Path>(
        &self,
        path: &Interval<R, P, N>,
        increment: impl Fn(usize) -> R,
    ) -> Interval<R, P, N> {
        path.with_increments(&core::array::from_fn(|i| self.is_held(i).then(|| increment(i))))
    }

    /// The end where nothing moves and friction and stops hold it; `before` is the momentum before they act at the end.
    pub fn resting_end(&self, before: &[R; N]) -> Option<End<R, N>> {
        let holds = |i: usize| {
            self.rests(i) && self.agreeing(i, R::zero(), -before[i], slack(before[i].abs())) == self.motion[i]
        };
        let end = || End { momentum: [R::zero(); N], held: [true; N], on_stop: self.on_stop() };
        (0..N).all(holds).then(end)
    }

    /// The stops on which coordinates end that were away from them. What rests beyond a stop stays where it is.
    fn on_stop(&self) -> [Option<R>; N] {
        core::array::from_fn(|i| match self.motion[i] {
            _ if self.rests(i) => None,
            Motion::AtLower => Some(self.stops[i].lower),
            Motion::AtUpper => Some(self.stops[i].upper),
            _ => None,
        })
    }

    /// Solves the end: velocities v = M(q₁)⁻¹p₁ and impulses Λ⁺ that agree, from the momentum `before` they act and its difference `gain` to
    /// that at the start of the step.
    pub fn end<L: Lagrangian<R, N>, F>(
        &self,
        system: &System<L, F>,
        q: &[R; N],
        (before, gain): (&[R; N], &[R; N]),
    ) -> Result<End<R, N>, StepError<R>> {
        let mass = system.lagrangian.linearization(q, &[R::zero(); N]).l_vv;
        let leaving = self.leaving(&mass, before, gain)?;
        let mut own = *self;
        for round in 0..=revisions(N) {
            let mut rows = mass;
            own.hold_rows(&mut rows, R::one());
            let right = core::array::from_fn(|i| before[i] + own.sliding_at_end(i));
            let v = solve(rows, own.held(&right, |i| leaving[i]))?;
            let p = multiply(&mass, &v);
            let needed: [R; N] = core::array::from_fn(|i| p[i] - before[i]);
            if !all_finite(&needed) {
                return Err(StepError::NotFinite);
            }
            let size = |i: usize| slack(p[i].abs() + before[i].abs());
            if !own.revise(round, |own, i| own.agreeing_at_end(i, v[i], needed[i], size(i))) {
                let momentum = |i: usize| if own.is_held(i) { p[i] } else { gain[i] + own.sliding_at_end(i) };
                let held = core::array::from_fn(|i| own.is_held(i));
                return Ok(End { momentum: core::array::from_fn(momentum), held, on_stop: self.on_stop() });
            }
        }
        Err(StepError::NotConverged(Report::nothing()))
    }

    /// Impulse of sliding friction at the end; none where a coordinate is held.
    fn sliding_at_end(&self, i: usize) -> R {
        if self.is_held(i) { R::zero() } else { self.sliding(i) }
    }

    /// Velocities at the end of coordinates that are held: −e v where a stop is struck with the velocity v, else 0. v is that of a motion in
    /// which what rests stays at rest: were it free until the strike, restitution could give energy.
    fn leaving(&self, mass: &Matrix<R, N>, before: &[R; N], gain: &[R; N]) -> Result<[R; N], StepError<R>> {
        let strikes = |i: usize| self.is_held(i) && !self.rests(i);
        if !(0..N).any(strikes) {
            return Ok([R::zero(); N]);
        }
        let mut until = *self;
        for i in (0..N).filter(|i| strikes(*i)) {
            until.motion[i] = Motion::Free;
        }
        let mut rows = *mass;
        until.hold_rows(&mut rows, R::one());
        let [v, gained] = solve_many(rows, [before, gain].map(|p| until.held(p, |_| R::zero())))?;
        let bounces = |i: usize| strikes(i) && v[i].abs() > R::constant(SLOW) * gained[i].abs();
        Ok(core::array::from_fn(|i| if bounces(i) { -self.stops[i].restitution * v[i] } else { R::zero() }))
    }

    /// The motion of coordinate i that agrees with its velocity at the end or, where that is given, with the impulse that this needs.
    #[inline(always)]
    fn agreeing_at_end(&self, i: usize, v: R, needed: R, slack: R) -> Motion {
        let Grip { forward, backward, breakaway } = self.grips[i];
        let rests = self.rests(i);
        let [forward_hold, backward_hold] =
            if rests { [breakaway * forward + slack, breakaway * backward + slack] } else { [slack; 2] };
        match self.motion[i] {
            Motion::AtLower if needed < -forward_hold => self.moving(i, R::one()),
            Motion::AtUpper if needed > backward_hold => self.moving(i, -R::one()),
            same => same.agreeing(&self.grips[i], v, needed, slack),
        }
    }
}

/// Replaces rows by those of the identity times `diagonal`.
#[inline(always)]
fn replace_rows<R: Real, const N: usize>(
    matrix: &mut Matrix<R, N>,
    diagonal: R,
    is_replaced: impl Fn(usize) -> bool,
) {
    for i in (0..N).filter(|i| is_replaced(*i)) {
        matrix[i] = [R::zero(); N];
        matrix[i][i] = diagonal;
    }
}
