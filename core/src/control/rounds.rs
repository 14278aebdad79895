//! Rounds of the augmented Lagrangian.

use super::{Iteration, Options, Status};
use crate::scalar::Real;

/// Decision after an iteration.
pub enum Next {
    /// The round goes on.
    Iterate,
    /// A new round begins; its penalties are larger if `more`.
    Round {
        /// Whether the violation fell too little.
        more: bool,
    },
    /// The search ends.
    End(Status),
}

/// Rounds of the augmented Lagrangian: each ends when the cost falls by less than a tolerance, which becomes stricter from round to round.
pub struct Rounds<R> {
    tolerance: R,
    last_tolerance: R,
    accepted: R,
    /// Violation at the end of the last round.
    violation: R,
    /// Rounds in a row that hardly lowered the violation.
    idle: u8,
}

/// Tolerance of the first round.
const FIRST_TOLERANCE: f64 = 1e-2;
/// Maximum number of rounds in a row that hardly lower the violation.
const MAX_IDLE: u8 = 8;

impl<R: Real> Rounds<R> {
    /// First round of a search that begins with a violation.
    pub fn new(options: &Options<R>, violation: R) -> Self {
        let tolerance = R::constant(FIRST_TOLERANCE).max(options.tolerance);
        Self { tolerance, last_tolerance: options.tolerance, accepted: options.violation, violation, idle: 0 }
    }

    /// Decides after an iteration; `stuck` if no step lowers the cost any more.
    pub fn after(&mut self, iteration: &Iteration<R>, stuck: bool) -> Next {
        let least = self.tolerance * (R::one() + iteration.cost.abs());
        let small = iteration.expected <= least || iteration.part > R::zero() && iteration.fall <= least;
        if !(stuck || small) {
            return Next::Iterate;
        }
        let met = iteration.violation <= self.accepted;
        if met && self.tolerance <= self.last_tolerance {
            return Next::End(Status::Solved);
        }
        let lowered = |part: f64| iteration.violation <= R::constant(part) * self.violation;
        self.idle = if met || lowered(0.9) { 0 } else { self.idle + 1 };
        if self.idle > MAX_IDLE {
            return Next::End(Status::Infeasible);
        }
        let more = !met && !lowered(0.25);
        self.violation = iteration.violation;
        self.tolerance = (self.tolerance * R::constant(0.1)).max(self.last_tolerance);
        Next::Round { more }
    }
}
