use super::adapter::Agreement;
use super::filter::Filter;
use crate::scalar::Real;
use serde::{Deserialize, Serialize};

/// A test, repeated at every window, whether a number differs from the model, with a stated rate of false alarms.
///
/// With the estimate δ, its standard error s and the prior deviation τ, δ is announced as soon as δ²/s² · τ²/(τ² + s²) ≥ 2 ln(1/α) + ln(1 +
/// τ²/s²): for a number that does not differ, the probability that this ever happens while nothing is forgotten is at most α. With forgetting,
/// it is about α over every span of time that is remembered.
///
/// Source: H. Robbins, "Statistical methods related to the law of the iterated logarithm", 1970 (mixture of normal distributions), with J.
/// Ville's inequality.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Announcement<R> {
    /// Position of the number.
    pub number: u8,
    /// 2 ln(1/α).
    pub threshold: R,
    /// Smallest |δ| worth announcing.
    pub least: R,
    /// Variance τ² of the prior.
    pub prior: R,
}

/// A number that differs from the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference<R> {
    /// Distance δ from the model.
    pub estimate: R,
    /// Standard error s.
    pub error: R,
}

impl<R: Real> Announcement<R> {
    /// The difference, if it is announced.
    pub fn of<const P: usize, const T: usize>(&self, filter: &Filter<R, P, T>) -> Option<Difference<R>> {
        let i = usize::from(self.number);
        let (estimate, variance) = (*filter.estimate().get(i)?, filter.variance(i));
        let evidence = estimate * estimate / variance * (self.prior / (self.prior + variance));
        let differs = evidence >= self.threshold + (self.prior / variance).ln_1p();
        let announced = differs && estimate.abs() >= self.least;
        announced.then(|| Difference { estimate, error: variance.sqrt() })
    }
}

/// Cumulative sum of disagreement: tells that something has changed at once.
///
/// S ← max(0, S + Σ(e²/s² − 2)) over the rows of a window, e²/s² being the squared innovations over their variances, near 1 on average. For
/// independent Gaussian innovations, the probability that S exceeds c before it returns to 0 is about e^(−0.4c) (E. Page 1954; the exponent
/// solves E e^(θ(χ² − 2)) = 1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Changes<R> {
    sum: R,
    threshold: R,
    /// Windows since the last change, up to the memory.
    since: u16,
    memory: u16,
    in_a_row: u8,
}

/// Changes in a row, each within the memory after the last, after which the machine is not the one that was learned.
const UNLIKE: u8 = 3;

impl<R: Real> Changes<R> {
    /// Creates the sum with its threshold c; `memory` is the number of windows over which changes belong together.
    pub const fn new(threshold: R, memory: u16, zero: R) -> Self {
        Self { sum: zero, threshold, since: memory, memory, in_a_row: 0 }
    }

    /// Takes the agreement of a window, and tells whether something has changed.
    pub fn take(&mut self, agreement: &Agreement<R>) -> bool {
        let expected = R::constant(f64::from(agreement.rows));
        self.sum = (self.sum + agreement.squares - (expected + expected)).max(R::zero());
        let again = self.since < self.memory;
        self.since = self.since.saturating_add(1).min(self.memory);
        let changed = self.sum >= self.threshold;
        if changed {
            self.in_a_row = if again { self.in_a_row.saturating_add(1) } else { 1 };
            (self.sum, self.since) = (R::zero(), 0);
        } else if !again {
            self.in_a_row = 0;
        }
        changed
    }

    /// Whether changes follow each other without end: no choice of the numbers explains the machine.
    pub fn unlike(&self) -> bool {
        self.in_a_row >= UNLIKE
    }
}
