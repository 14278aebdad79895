//! Further starts of a fit of rigid bodies that has ended badly.
//!
//! Motion is not convex in the numbers of bodies: from some starts a fit ends where no force has an effect, because all
//! inertias have become huge, or where a joint's axis has wandered off. Such an end is recognised ([`doubt`](super::doubt)),
//! and the fit begins again: first from the numbers that the configuration gives, if the first start was a fit to
//! smoothed states, then from random numbers around them. Of all fits the best is kept. Where the first start leads to
//! a good fit, nothing is done; where a fit follows the motion and another start is hardly better, the model can do no better.

use super::doubt::{follows_the_motion, is_bad};
use super::plan::Plan;
use super::{Run, within};
use crate::checkpoint::State;
use leastaction_models::bounds::Range;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Number of starts after the first.
pub(super) const FURTHER: u64 = 6;
/// Logarithm of the largest factor between a number above 0 and its random start.
const SPREAD: f64 = 1.4;
/// Relative difference of losses below which two starts have led to the same fit: then the model cannot do better.
const SAME: f64 = 0.01;
/// Relative fall of the loss that makes further starts worth their time where a fit follows the motion.
const WORTH: f64 = 0.1;

impl Run {
    /// Begins again from another start, if the fit has ended badly and there is one left; else goes back to the best fit
    /// of all starts and returns false.
    pub(super) fn begin_again(&mut self) -> bool {
        let Self { plan, state, pool, .. } = self;
        within(pool.as_ref(), || state.begin_again(plan))
    }

    /// Number of starts from which the fit has begun; 1 if the first was good enough.
    pub fn starts(&self) -> u64 {
        self.state.start.min(self.plan.further_starts) + 1
    }
}

impl State {
    /// See [`Run::begin_again`].
    pub(super) fn begin_again(&mut self, plan: &Plan) -> bool {
        let next =
            if self.start < plan.further_starts && is_bad(plan, self) { self.at_next(plan) } else { None };
        let goes_on = next.is_some();
        if let Some(next) = next {
            let before = std::mem::replace(self, next);
            self.earlier = Some(Box::new(before.better(plan)));
        } else if self.earlier.is_some() {
            *self = self.clone().better(plan);
        }
        goes_on
    }

    /// The state at the next start; `None` if there is nothing new to expect, because this fit is that of an earlier start, or hardly better
    /// than an earlier one that follows the motion.
    fn at_next(&self, plan: &Plan) -> Option<Self> {
        let score =
            |state: &Self| plan.stages.get(state.stage).map_or(f64::NAN, |stage| state.best.score(stage));
        let (own, start) = (score(self), self.start + 1);
        let is_same = |earlier: &Self| (own - score(earlier)).abs() < SAME * own;
        let is_no_help =
            |earlier: &Self| own > (1.0 - WORTH) * score(earlier) && follows_the_motion(plan, earlier);
        if self.earlier.as_deref().is_some_and(|earlier| is_same(earlier) || is_no_help(earlier)) {
            return None;
        }
        let next = Self::from_start(plan, plan.start(start), (start, self.iteration))?;
        Some(Self { seconds: self.seconds, ..next })
    }

    /// This fit or the best of the earlier ones, whichever is better, with the count of iterations and starts of this.
    fn better(mut self, plan: &Plan) -> Self {
        let Some(earlier) = self.earlier.take() else { return self };
        let score = |state: &Self| plan.stages.get(state.stage).map(|stage| state.best.score(stage));
        let is_better = self.best.is_a_model() && score(&self) <= score(&earlier);
        let (iteration, seconds, start) = (self.iteration, self.seconds, self.start);
        let best = if is_better { self } else { *earlier };
        Self { iteration, seconds, start, earlier: None, ..best }
    }
}

impl Plan {
    /// Start number k ≥ 1: the numbers of the configuration or random numbers around them.
    fn start(&self, k: u64) -> Vec<f64> {
        let parameters = self.parameters();
        let mut numbers = self.given[..parameters].to_vec();
        if k == 1 && self.initial.get(..parameters) != Some(&numbers[..]) {
            return numbers;
        }
        let mut stream = Pcg64::seed_from_u64(self.config.training.seed.wrapping_add(k));
        let names = self.architecture.number_names();
        let unit_at = |at: usize| names.get(at).and_then(Option::as_ref).map(|name| name.unit);
        for (at, range) in self.architecture.family.ranges() {
            let own = stream.random_range(-1.0..1.0);
            let of_unit = (0..parameters).filter(|other| unit_at(*other) == unit_at(at));
            let size = of_unit.map(|other| self.given[other].abs()).fold(0.0, f64::max);
            numbers[at] = match range {
                Range::Positive => numbers[at] * f64::exp(SPREAD * own),
                Range::Any => numbers[at] + size * own,
                Range::Between(..) => numbers[at],
            };
        }
        numbers
    }
}
