//! Contacts of a step: which coordinates stick or lie on an end stop, and the momentum that this leaves at its end, for samples side by side.
//!
//! [`leastaction_core::discrete`] has the equations: the friction of a step is the impulse Λ⁻ = (h/2)λ⁻ at its start, which belongs to the
//! increment w, and Λ⁺ = (h/2)λ⁺ at its end, which belongs to v₁ = M(q₁)⁻¹p₁. A coordinate that would pass a stop ends on it.

mod end;

pub(crate) use end::{Before, Strike};

use super::Order;
use super::interval::{GaussPoint, Interval};
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
}
