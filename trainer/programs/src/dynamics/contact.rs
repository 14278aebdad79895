//! Contacts of a step: which coordinates stick or lie on an end stop, and the momentum that this leaves at its end, for samples side by side.
//!
//! [`leastaction_core::discrete`] has the equations: the friction of a step is the impulse Λ⁻ = (h/2)λ⁻ at its start, which belongs to the
//! increment w, and Λ⁺ = (h/2)λ⁺ at its end, which belongs to v₁ = M(q₁)⁻¹p₁. A coordinate that would pass a stop ends on it.

use super::interval::{Balance, GaussPoint, Integrals, Interval};
use super::matrix::Lu;
use super::{Failures, Order};
use crate::program::{Program, Workspace};
use crate::row::{Row, WIDTH};

/// Motion of a coordinate during a step or at its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Motion {
    Sticks,
    Forward,
    Backward,
    /// Moves without friction that sticks.
    Free,
    /// Ends on the lower stop.
    AtLower,
    /// Ends on the upper stop.
    AtUpper,
}

/// Motions of all coordinates of all samples, the impulses that friction can give in half a step, and the increments that lead to the stops.
#[derive(Clone, Debug)]
pub(crate) struct Contact {
    /// Levels forwards and backwards times h/2, then the ratio of friction at rest; n rows each.
    grips: [Vec<Row>; 3],
    /// Lower and upper stop, then the restitution; n rows each.
    stops: [Vec<Row>; 3],
    /// Increments w that lead to the lower and to the upper stop; 0 from a stop and from beyond it.
    to_stops: [Vec<Row>; 2],
    motion: Vec<[Motion; WIDTH]>,
    /// How often a motion was revised to one whose increment is given.
    returns: Vec<[usize; WIDTH]>,
    /// Impulse of a constant force in the equation of the bubble over that in the equation of the momentum: 2 Σ b β.
    bubble_share: f64,
    /// Number of revisions of every sample.
    revisions: [usize; WIDTH],
}

/// End of a step.
pub(crate) struct End {
    /// p₁, n rows.
    pub momentum: Vec<Row>,
    pub strikes: Vec<Strike>,
    pub failed: Failures,
}

/// A coordinate that ends a step on a stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Strike {
    pub coordinate: usize,
    pub sample: usize,
    /// e, or 0 if it stays there.
    pub restitution: f64,
    /// Gain of its velocity over the step, over the velocity of the strike; 0 if it stays there.
    pub gain: f64,
}

/// Momenta before friction and stops act at the end, and their differences to those at the start; n rows each.
pub(crate) struct Before {
    pub momentum: Vec<Row>,
    pub gain: Vec<Row>,
}

/// Number of steps within which forces would give a coordinate the velocity of a strike, below which it does not bounce.
const SLOW: f64 = 4.0;

/// The most revisions of a sample's motions in a step and at its end.
const fn most_revisions(n: usize) -> usize {
    8 * n + 2
}

/// Number of revisions to rest, or to a stop, after which the path of a coordinate has no bubble: with one, neither rest nor motion may agree.
const RETURNS: usize = 3;

/// How closely an impulse in a sum of terms of this size is known.
fn slack(size: f64) -> f64 {
    8.0 * f64::EPSILON * size
}

impl Contact {
    /// The motions that a guess of the path shows.
    pub fn new(
        (laws, workspace): &mut (Program, Workspace),
        weights: &[f64],
        (h, order): (f64, Order),
        path: &Interval,
    ) -> Self {
        let [start, end] = &path.tau;
        let tau: Vec<Row> = start.iter().zip(end).map(|(a, b)| a.zip(b, |a, b| 0.5 * (a + b))).collect();
        laws.run_outputs(weights, &[&path.q0, &path.w, &tau], workspace);
        let impulse = |row: &Row| Row(row.0.map(|level| 0.5 * h.abs() * level));
        let grips = [
            workspace.output(0).iter().map(impulse).collect(),
            workspace.output(1).iter().map(impulse).collect(),
            workspace.output(2).to_vec(),
        ];
        let stops = [3, 4, 5].map(|k| workspace.output(k).to_vec());
        let to = |stop: usize, ahead: fn(f64) -> f64| {
            let each = stops[stop].iter().zip(&path.q0);
            each.map(|(at, q)| at.zip(q, |at, q| ahead((at - q) / h))).collect()
        };
        let to_stops = [to(0, |w| w.min(0.0)), to(1, |w| w.max(0.0))];
        let share = |point: &GaussPoint| 2.0 * point.weight * point.bubble(1.0).force;
        let bubble_share = order.points().iter().map(share).sum();
        let motion = vec![[Motion::Free; WIDTH]; path.w.len()];
        let (returns, revisions) = (vec![[0; WIDTH]; path.w.len()], [0; WIDTH]);
        let mut contact = Self { grips, stops, to_stops, motion, returns, bubble_share, revisions };
        for (i, w) in path.w.iter().enumerate() {
            contact.motion[i] = std::array::from_fn(|sample| contact.seen(i, w.0[sample], sample));
        }
        contact
    }

    /// The motion that a velocity shows.
    fn seen(&self, i: usize, v: f64, sample: usize) -> Motion {
        let [lower, upper] = self.to_stops(i, sample);
        match (v == 0.0, lower == 0.0, upper == 0.0) {
            (true, true, _) => Motion::AtLower,
            (true, _, true) => Motion::AtUpper,
            _ => self.moving(i, v, sample),
        }
    }

    /// The motion that a velocity shows away from the stops.
    fn moving(&self, i: usize, v: f64, sample: usize) -> Motion {
        let [forward, backward, _] = self.grip(i, sample);
        match v {
            _ if forward + backward == 0.0 => Motion::Free,
            v if v > 0.0 => Motion::Forward,
            v if v < 0.0 => Motion::Backward,
            _ => Motion::Sticks,
        }
    }

    fn to_stops(&self, i: usize, sample: usize) -> [f64; 2] {
        self.to_stops.each_ref().map(|rows| rows[i].0[sample])
    }

    fn grip(&self, i: usize, sample: usize) -> [f64; 3] {
        self.grips.each_ref().map(|rows| rows[i].0[sample])
    }

    /// Whether the increment of coordinate i is given: it sticks, or ends on a stop.
    pub fn is_held(&self, i: usize, sample: usize) -> bool {
        matches!(self.motion[i][sample], Motion::Sticks | Motion::AtLower | Motion::AtUpper)
    }

    /// Whether the path of coordinate i has no bubble.
    pub fn is_straight(&self, i: usize, sample: usize) -> bool {
        self.is_held(i, sample) || self.returns[i][sample] >= RETURNS
    }

    /// The increment w_i of a coordinate that is held.
    pub fn increment(&self, i: usize, sample: usize) -> f64 {
        let [lower, upper] = self.to_stops(i, sample);
        match self.motion[i][sample] {
            Motion::AtLower => lower,
            Motion::AtUpper => upper,
            _ => 0.0,
        }
    }

    /// Whether coordinate i does not move.
    fn rests(&self, i: usize, sample: usize) -> bool {
        self.is_held(i, sample) && self.increment(i, sample) == 0.0
    }

    /// Sliding friction in the equation of the bubble; 0 where a coordinate rests.
    pub fn sliding_bubble(&self, i: usize, sample: usize) -> f64 {
        self.bubble_share * self.sliding(i, sample)
    }

    /// Impulse of sliding friction in half a step; 0 where a coordinate rests.
    pub fn sliding(&self, i: usize, sample: usize) -> f64 {
        let [forward, backward, _] = self.grip(i, sample);
        match self.motion[i][sample] {
            _ if self.rests(i, sample) => 0.0,
            // Slides until it strikes.
            Motion::Forward | Motion::AtUpper => -forward,
            Motion::Backward | Motion::AtLower => backward,
            Motion::Free | Motion::Sticks => 0.0,
        }
    }

    /// The motion of coordinate i that agrees with its increment or, where that is given, with the impulse that this needs.
    fn agreeing(&self, i: usize, sample: usize, [v, needed, known_to]: [f64; 3]) -> Motion {
        let [forward, backward, breakaway] = self.grip(i, sample);
        let [lower, upper] = self.to_stops(i, sample);
        let [forward_hold, backward_hold] = [forward, backward].map(|level| breakaway * level + known_to);
        let is_there = |at: f64| (v - at).abs() <= slack(v.abs() + at.abs());
        let moving = |v: f64| self.moving(i, v, sample);
        match self.motion[i][sample] {
            // Not where it is held yet: the impulse tells nothing.
            Motion::Sticks if v != 0.0 => Motion::Sticks,
            Motion::AtLower if !is_there(lower) => Motion::AtLower,
            Motion::AtUpper if !is_there(upper) => Motion::AtUpper,
            Motion::Sticks if needed < -forward_hold => Motion::Forward,
            Motion::Sticks if needed > backward_hold => Motion::Backward,
            // A stop only pushes; friction holds too where the coordinate rests, and slides where it strikes.
            Motion::AtUpper if upper == 0.0 && needed > backward_hold => moving(-1.0),
            Motion::AtLower if lower == 0.0 && needed < -forward_hold => moving(1.0),
            Motion::AtUpper if upper > 0.0 && needed > known_to - forward => moving(1.0),
            Motion::AtLower if lower < 0.0 && needed < backward - known_to => moving(-1.0),
            Motion::Forward | Motion::Free if v > upper => Motion::AtUpper,
            Motion::Backward | Motion::Free if v < lower => Motion::AtLower,
            Motion::Forward if v < 0.0 => Motion::Sticks,
            Motion::Backward if v > 0.0 => Motion::Sticks,
            same => same,
        }
    }

    /// The motion of coordinate i that agrees with its velocity at the end or, where that is given, with the impulse that this needs.
    fn agreeing_at_end(&self, i: usize, sample: usize, [v, needed, known_to]: [f64; 3]) -> Motion {
        let [forward, backward, breakaway] = self.grip(i, sample);
        let hold = |level: f64| if self.rests(i, sample) { breakaway * level } else { 0.0 } + known_to;
        match self.motion[i][sample] {
            Motion::Sticks | Motion::AtLower if needed < -hold(forward) => self.moving(i, 1.0, sample),
            Motion::Sticks | Motion::AtUpper if needed > hold(backward) => self.moving(i, -1.0, sample),
            Motion::Forward if v < 0.0 => Motion::Sticks,
            Motion::Backward if v > 0.0 => Motion::Sticks,
            same => same,
        }
    }

    /// Revises the motions of a sample by increments, the impulses that given ones need, and the sizes of their terms; returns whether any
    /// contradicts them.
    pub fn revise(&mut self, sample: usize, of: impl Fn(usize) -> [f64; 3]) -> bool {
        self.revise_by(sample, |own, i| {
            let [v, needed, size] = of(i);
            own.agreeing(i, sample, [v, needed, slack(size)])
        })
    }

    /// From revision n on only the last motion that contradicts changes, and after the most revisions none.
    fn revise_by(&mut self, sample: usize, agreeing: impl Fn(&Self, usize) -> Motion) -> bool {
        let (n, revision) = (self.motion.len(), self.revisions[sample]);
        let mut changed = false;
        for i in (0..n).rev() {
            let motion = agreeing(self, i);
            if motion != self.motion[i][sample] && !(changed && revision >= n) {
                changed = true;
                if self.may_be_revised(sample) {
                    self.motion[i][sample] = motion;
                    self.returns[i][sample] += usize::from(self.is_held(i, sample));
                }
            }
        }
        self.revisions[sample] += usize::from(changed);
        changed
    }

    /// Whether the motions of a sample may be revised further.
    fn may_be_revised(&self, sample: usize) -> bool {
        self.revisions[sample] < most_revisions(self.motion.len())
    }

    /// Sets the increment of a sample exactly where a coordinate is held, and the bubble to 0 where there is none.
    pub fn settle(&self, path: &mut Interval, sample: usize) {
        for i in (0..self.motion.len()).filter(|i| self.is_straight(*i, sample)) {
            path.s[i].0[sample] = 0.0;
            if self.is_held(i, sample) {
                path.w[i].0[sample] = self.increment(i, sample);
            }
        }
    }

    /// Sets the positions of coordinates that end on a stop, and were away from it, to that stop.
    pub fn land(&self, q: &mut [Row]) {
        for (i, q) in q.iter_mut().enumerate() {
            for sample in (0..WIDTH).filter(|sample| !self.rests(i, *sample)) {
                match self.motion[i][sample] {
                    Motion::AtLower => q.0[sample] = self.stops[0][i].0[sample],
                    Motion::AtUpper => q.0[sample] = self.stops[1][i].0[sample],
                    _ => {}
                }
            }
        }
    }

    /// Momenta before friction and stops act at the end: p₀ plus the impulses of forces and of friction at the start.
    pub fn before_end(&self, p0: &[Row], balance: &Balance) -> Before {
        let impulse = |i: usize, sample: usize| {
            let needed = -(p0[i].0[sample] + balance.d1_ld[i].0[sample]);
            if self.rests(i, sample) { needed } else { self.sliding(i, sample) }
        };
        let row =
            |i: usize| Row(std::array::from_fn(|sample| balance.impulse[i].0[sample] + impulse(i, sample)));
        let gain: Vec<Row> = (0..p0.len()).map(row).collect();
        let momentum = p0.iter().zip(&gain).map(|(p, gain)| p.zip(gain, |p, gain| p + gain)).collect();
        Before { momentum, gain }
    }

    /// Momenta p₁ at the end of a path, from those before friction and stops act there: velocities M(q₁)⁻¹p₁ and impulses Λ⁺ that agree.
    pub fn end(mut self, integrals: &mut Integrals, weights: &[f64], path: &Interval, before: Before) -> End {
        let (n, zero) = (path.q0.len(), vec![Row::default(); path.q0.len()]);
        let mut end = path.q0.clone();
        end.iter_mut().zip(&path.w).for_each(|(q, w)| q.add_scaled(integrals.h, w));
        integrals.differentiate(weights, [&end, &zero, &zero]);
        let (momentum, failed) = (before.momentum.clone(), Failures::default());
        let mut found = End { momentum, strikes: Vec::new(), failed };
        let mut lu = Lu::default();
        self.revisions = [0; WIDTH];
        for sample in 0..WIDTH {
            let mass = |i: usize, j: usize| integrals.momentum_columns(j)[1][i].0[sample];
            let of = [&before.momentum, &before.gain];
            let [momentum, gain] = of.map(|rows| rows.iter().map(|row| row.0[sample]).collect::<Vec<_>>());
            let before = (&mass as &dyn Fn(usize, usize) -> f64, [&*momentum, &*gain]);
            let strikes = self.strikes(sample, &mut lu, before);
            let momentum = strikes.as_deref().and_then(|of| self.sample_end(sample, &mut lu, before, of));
            found.strikes.extend(strikes.into_iter().flatten().map(|(strike, _)| strike));
            found.failed.0[sample] = momentum.is_none();
            let momentum = momentum.unwrap_or_else(|| vec![f64::NAN; n]);
            found.momentum.iter_mut().zip(momentum).for_each(|(row, p)| row.0[sample] = p);
        }
        found
    }

    /// The momentum of one sample; `None` if M is singular or no motions agree.
    fn sample_end(
        &mut self,
        sample: usize,
        lu: &mut Lu,
        (mass, [before, _]): AtEnd,
        strikes: &[(Strike, f64)],
    ) -> Option<Vec<f64>> {
        let n = before.len();
        let mut leaving = vec![0.0; n];
        strikes.iter().for_each(|(strike, v)| leaving[strike.coordinate] = -strike.restitution * v);
        loop {
            let is_held: Vec<bool> = (0..n).map(|i| self.is_held(i, sample)).collect();
            let slides = |i: usize| before[i] + self.sliding(i, sample);
            let v = velocities(lu, (mass, &is_held), |i| if is_held[i] { leaving[i] } else { slides(i) })?;
            let p: Vec<f64> = (0..n).map(|i| (0..n).map(|j| mass(i, j) * v[j]).sum()).collect();
            let momentum: Vec<f64> = (0..n).map(|i| if is_held[i] { p[i] } else { slides(i) }).collect();
            if momentum.iter().any(|p| !p.is_finite()) || !self.may_be_revised(sample) {
                return None;
            }
            let known = |i: usize| [v[i], p[i] - before[i], slack(p[i].abs() + before[i].abs())];
            if !self.revise_by(sample, |own, i| own.agreeing_at_end(i, sample, known(i))) {
                return Some(momentum);
            }
        }
    }

    /// Coordinates that end on a stop, each with the velocity of its strike in a motion in which what rests stays at rest; `None` if M is
    /// singular.
    fn strikes(
        &self,
        sample: usize,
        lu: &mut Lu,
        (mass, [before, gain]): AtEnd,
    ) -> Option<Vec<(Strike, f64)>> {
        let n = before.len();
        let is_on_stop = |i: &usize| matches!(self.motion[*i][sample], Motion::AtLower | Motion::AtUpper);
        let strikes = |i: usize| is_on_stop(&i) && !self.rests(i, sample);
        let rests: Vec<bool> = (0..n).map(|i| self.rests(i, sample)).collect();
        let (mut v, mut gained) = (vec![0.0; n], vec![0.0; n]);
        if (0..n).any(strikes) {
            let mut of = |p: &[f64]| velocities(lu, (mass, &rests), |i| if rests[i] { 0.0 } else { p[i] });
            (v, gained) = (of(before)?, of(gain)?);
        }
        let strike = |i: usize| {
            let bounces = strikes(i) && v[i].abs() > SLOW * gained[i].abs();
            let restitution = if bounces { self.stops[2][i].0[sample] } else { 0.0 };
            let gain = if bounces { gained[i] / v[i] } else { 0.0 };
            (Strike { coordinate: i, sample, restitution, gain }, v[i])
        };
        Some((0..n).filter(is_on_stop).map(strike).collect())
    }
}

/// Mass matrix of a sample at the end of a step, its momentum before friction and stops act there, and that momentum's gain.
type AtEnd<'a> = (&'a dyn Fn(usize, usize) -> f64, [&'a [f64]; 2]);

/// Velocities of which those that are given equal the right-hand side, and the others have it as their momentum; `None` if M is singular.
fn velocities(
    lu: &mut Lu,
    (mass, are_given): (&dyn Fn(usize, usize) -> f64, &[bool]),
    right: impl Fn(usize) -> f64,
) -> Option<Vec<f64>> {
    let row = |i: usize, j: usize| if are_given[i] { f64::from(u8::from(i == j)) } else { mass(i, j) };
    lu.factor(are_given.len(), row).then(|| lu.solve(right).to_vec())
}
