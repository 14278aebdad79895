//! Which coordinates stick in a step, and the momentum that this leaves at its end, for samples side by side.
//!
//! [`leastaction_core::discrete`] has the equations: the friction of a step is the impulse Λ⁻ = (h/2)λ⁻ at its start, which belongs to the
//! increment w, and Λ⁺ = (h/2)λ⁺ at its end, which belongs to v₁ = M(q₁)⁻¹p₁.

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
}

/// Motions of all coordinates of all samples, and the impulses that friction can give in half a step.
#[derive(Clone, Debug)]
pub(crate) struct Contact {
    /// Levels forwards and backwards times h/2, then the ratio of friction at rest; n rows each.
    grips: [Vec<Row>; 3],
    motion: Vec<[Motion; WIDTH]>,
    /// Impulse of a constant force in the equation of the bubble over that in the equation of the momentum: 2 Σ b β.
    bubble_share: f64,
    /// Number of revisions of every sample.
    revisions: [usize; WIDTH],
}

/// Momenta at the end of a step.
pub(crate) struct End {
    /// p₁, n rows.
    pub momentum: Vec<Row>,
    pub failed: Failures,
}

/// The most revisions of a sample's motions in a step and at its end.
const fn most_revisions(n: usize) -> usize {
    8 * n + 2
}

/// How closely an impulse in a sum of terms of this size is known.
fn slack(size: f64) -> f64 {
    8.0 * f64::EPSILON * size
}

impl Contact {
    /// The motions that a guess of the path shows.
    pub fn new(
        (levels, workspace): &mut (Program, Workspace),
        weights: &[f64],
        (h, order): (f64, Order),
        path: &Interval,
    ) -> Self {
        let [start, end] = &path.tau;
        let tau: Vec<Row> = start.iter().zip(end).map(|(a, b)| a.zip(b, |a, b| 0.5 * (a + b))).collect();
        levels.run_outputs(weights, &[&path.q0, &path.w, &tau], workspace);
        let impulse = |row: &Row| Row(row.0.map(|level| 0.5 * h.abs() * level));
        let grips = [
            workspace.output(0).iter().map(impulse).collect(),
            workspace.output(1).iter().map(impulse).collect(),
            workspace.output(2).to_vec(),
        ];
        let share = |point: &GaussPoint| 2.0 * point.weight * point.bubble(1.0).force;
        let bubble_share = order.points().iter().map(share).sum();
        let motion = vec![[Motion::Free; WIDTH]; path.w.len()];
        let mut contact = Self { grips, motion, bubble_share, revisions: [0; WIDTH] };
        for (i, w) in path.w.iter().enumerate() {
            contact.motion[i] = std::array::from_fn(|sample| contact.seen(i, w.0[sample], sample));
        }
        contact
    }

    /// The motion that a velocity shows.
    fn seen(&self, i: usize, v: f64, sample: usize) -> Motion {
        let [forward, backward, _] = self.grip(i, sample);
        match v {
            _ if forward + backward == 0.0 => Motion::Free,
            v if v > 0.0 => Motion::Forward,
            v if v < 0.0 => Motion::Backward,
            _ => Motion::Sticks,
        }
    }

    fn grip(&self, i: usize, sample: usize) -> [f64; 3] {
        self.grips.each_ref().map(|rows| rows[i].0[sample])
    }

    pub fn sticks(&self, i: usize, sample: usize) -> bool {
        self.motion[i][sample] == Motion::Sticks
    }

    /// Sliding friction in the equation of the bubble; 0 where a coordinate sticks.
    pub fn sliding_bubble(&self, i: usize, sample: usize) -> f64 {
        self.bubble_share * self.sliding(i, sample)
    }

    /// Impulse of sliding friction in half a step; 0 where a coordinate sticks.
    pub fn sliding(&self, i: usize, sample: usize) -> f64 {
        let [forward, backward, _] = self.grip(i, sample);
        match self.motion[i][sample] {
            Motion::Forward => -forward,
            Motion::Backward => backward,
            Motion::Free | Motion::Sticks => 0.0,
        }
    }

    /// The motion of coordinate i that agrees with its velocity or, where it sticks, with the impulse that this needs.
    fn agreeing(&self, i: usize, sample: usize, [v, needed, known_to]: [f64; 3]) -> Motion {
        let [forward, backward, breakaway] = self.grip(i, sample);
        match self.motion[i][sample] {
            // Not at rest yet: the impulse tells nothing.
            Motion::Sticks if v != 0.0 => Motion::Sticks,
            Motion::Sticks if needed < -(breakaway * forward + known_to) => Motion::Forward,
            Motion::Sticks if needed > breakaway * backward + known_to => Motion::Backward,
            Motion::Forward if v < 0.0 => Motion::Sticks,
            Motion::Backward if v > 0.0 => Motion::Sticks,
            same => same,
        }
    }

    /// Revises the motions of a sample by velocities, the impulses that rest needs, and the sizes of their terms; returns whether any contradicts
    /// them. From revision n on only the last of these changes, and after the most revisions none.
    pub fn revise(&mut self, sample: usize, of: impl Fn(usize) -> [f64; 3]) -> bool {
        let (n, revision) = (self.motion.len(), self.revisions[sample]);
        let mut changed = false;
        for i in (0..n).rev() {
            let [v, needed, size] = of(i);
            let motion = self.agreeing(i, sample, [v, needed, slack(size)]);
            if motion != self.motion[i][sample] && !(changed && revision >= n) {
                changed = true;
                if self.may_be_revised(sample) {
                    self.motion[i][sample] = motion;
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

    /// Sets increment and bubble of a sample to exactly 0 where a coordinate sticks; between two given ends its increment is 0.
    pub fn settle(&self, path: &mut Interval, sample: usize) {
        for (i, _) in self.motion.iter().enumerate().filter(|(i, _)| self.sticks(*i, sample)) {
            (path.w[i].0[sample], path.s[i].0[sample]) = (0.0, 0.0);
        }
    }

    /// Momenta before friction acts at the end, p₀ plus the impulses of forces and of friction at the start.
    pub fn before_end(&self, p0: &[Row], balance: &Balance) -> Vec<Row> {
        let impulse = |i: usize, sample: usize| {
            let needed = -(p0[i].0[sample] + balance.d1_ld[i].0[sample]);
            if self.sticks(i, sample) { needed } else { self.sliding(i, sample) }
        };
        let row = |(i, p0): (usize, &Row)| {
            Row(std::array::from_fn(|sample| {
                p0.0[sample] + balance.impulse[i].0[sample] + impulse(i, sample)
            }))
        };
        p0.iter().enumerate().map(row).collect()
    }

    /// Momenta p₁ at the end of a path, from those before friction acts there: velocities M(q₁)⁻¹p₁ and impulses Λ⁺ that agree.
    pub fn end(mut self, integrals: &mut Integrals, weights: &[f64], path: &Interval, before: &[Row]) -> End {
        let (n, zero) = (before.len(), vec![Row::default(); before.len()]);
        let mut end = path.q0.clone();
        end.iter_mut().zip(&path.w).for_each(|(q, w)| q.add_scaled(integrals.h, w));
        integrals.differentiate(weights, [&end, &zero, &zero]);
        let mut found = End { momentum: before.to_vec(), failed: Failures::default() };
        let mut lu = Lu::default();
        self.revisions = [0; WIDTH];
        for sample in 0..WIDTH {
            let mass = |i: usize, j: usize| integrals.momentum_columns(j)[1][i].0[sample];
            let before: Vec<f64> = before.iter().map(|row| row.0[sample]).collect();
            let momentum = self.sample_end(sample, &mut lu, (&mass, &before));
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
        (mass, before): (&dyn Fn(usize, usize) -> f64, &[f64]),
    ) -> Option<Vec<f64>> {
        let n = before.len();
        loop {
            let holds = |i: usize| self.sticks(i, sample);
            let row = |i: usize, j: usize| if holds(i) { f64::from(u8::from(i == j)) } else { mass(i, j) };
            if !lu.factor(n, row) {
                return None;
            }
            let right = |i: usize| if holds(i) { 0.0 } else { before[i] + self.sliding(i, sample) };
            let v = lu.solve(right).to_vec();
            let p: Vec<f64> = (0..n).map(|i| (0..n).map(|j| mass(i, j) * v[j]).sum()).collect();
            let momentum = |i: usize| if self.sticks(i, sample) { p[i] } else { right(i) };
            let found: Vec<f64> = (0..n).map(momentum).collect();
            if found.iter().any(|p| !p.is_finite()) || !self.may_be_revised(sample) {
                return None;
            }
            let known = |i: usize| {
                let at_rest = self.motion[i][sample] == Motion::Sticks;
                let v = if at_rest { 0.0 } else { v[i] };
                [v, p[i] - before[i], p[i].abs() + before[i].abs()]
            };
            let known: Vec<[f64; 3]> = (0..n).map(known).collect();
            if !self.revise(sample, |i| known[i]) {
                return Some(found);
            }
        }
    }
}
