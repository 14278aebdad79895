//! Numbers with a range, as the optimisers see them: free numbers θ, from which they follow. Weight blocks everywhere else hold the
//! numbers themselves.
//!
//! A number above 0 is w = e^θ: a step of θ is a step in proportion to the number. The damping of Levenberg–Marquardt and the steps of
//! Adam are the same for every θ, so whatever the unit, from 10⁻³ to 10³, they suit; ln(1 + e^θ), which is linear from 1 on, has
//! that only below 1. Where Gauss–Newton goes too far up, the step is refused and damped like any other, and down it takes
//! δθ = (w* − w)/w > −1 for a residual that is linear in w. A number between a and b is w = a + ½(b − a)(1 + tanh θ).
//!
//! θ ends a little before the number would be at its bound in double precision, where its slope would be 0 and nothing could move it
//! any more: [`LEAST`] and [`MARGIN`].

use crate::tree::{INERTIAL, Inertia, LogCholesky};
use serde::{Deserialize, Serialize};

/// Numbers above 0 stay between this and one over it.
pub const LEAST: f64 = 1e-12;
/// Numbers between bounds stay this part of the way from one to the other away from both.
pub const MARGIN: f64 = 1e-4;

/// Range of a number of a weight block.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Range {
    /// Anywhere: θ = w.
    Any,
    /// Above 0: w = e^θ.
    Positive,
    /// Between two bounds, the lower first: w = a + ½(b − a)(1 + tanh θ).
    Between(f64, f64),
}

impl Range {
    /// The θ of a number, finite whatever the number; of one that is out of range or at a bound, as of the nearest that is not.
    pub fn free(self, w: f64) -> f64 {
        match self {
            Self::Any => w,
            Self::Positive => w.clamp(LEAST, LEAST.recip()).ln(),
            Self::Between(least, most) => {
                let part = ((w - least) / (most - least)).clamp(MARGIN, 1.0 - MARGIN);
                // atanh(2 part − 1)
                0.5 * (part / (1.0 - part)).ln()
            }
        }
    }

    /// θ, no further than numbers go.
    fn held(self, theta: f64) -> f64 {
        let most = match self {
            Self::Any => return theta,
            Self::Positive => -LEAST.ln(),
            Self::Between(..) => 0.5 * ((1.0 - MARGIN) / MARGIN).ln(),
        };
        theta.clamp(-most, most)
    }

    /// Number of θ.
    pub fn weight(self, theta: f64) -> f64 {
        let theta = self.held(theta);
        match self {
            Self::Any => theta,
            Self::Positive => theta.exp(),
            Self::Between(least, most) => least + 0.5 * (most - least) * (1.0 + theta.tanh()),
        }
    }

    /// dw/dθ.
    pub fn slope(self, theta: f64) -> f64 {
        let theta = self.held(theta);
        match self {
            Self::Any => 1.0,
            Self::Positive => theta.exp(),
            Self::Between(least, most) => 0.5 * (most - least) / theta.cosh().powi(2),
        }
    }
}

/// The numbers of a weight block that have a range, one by one or ten of a body; all others may be anything.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bounds {
    ranges: Vec<(usize, Range)>,
    /// Where the inertial numbers of bodies begin, which are bodies that can be; θ are their log-Cholesky numbers.
    bodies: Vec<(usize, LogCholesky)>,
}

/// No number has a range.
pub static NONE: Bounds = Bounds { ranges: Vec::new(), bodies: Vec::new() };

impl Bounds {
    /// Ranges of numbers by their positions in the weight block, each named once.
    pub fn new(mut ranges: Vec<(usize, Range)>) -> Self {
        ranges.retain(|(_, range)| *range != Range::Any);
        Self { ranges, bodies: Vec::new() }
    }

    /// The same where ten numbers from each of these positions on are a body.
    #[must_use]
    pub fn with_bodies(self, bodies: Vec<(usize, LogCholesky)>) -> Self {
        Self { bodies, ..self }
    }

    /// Whether every number may be anything, and so θ is the weight block itself.
    pub fn is_empty(&self) -> bool {
        self.ranges.is_empty() && self.bodies.is_empty()
    }

    /// θ of a weight block; of numbers out of range or at a bound that of the nearest that θ reaches, of a body that cannot be 0.
    pub fn free(&self, weights: &[f64]) -> Vec<f64> {
        let chart =
            |chart: &LogCholesky, own: [f64; INERTIAL]| chart.numbers(&Inertia(own)).unwrap_or_default();
        self.each_body(self.each(weights, Range::free), chart)
    }

    /// The weight block of θ, every number in its range.
    pub fn weights(&self, theta: &[f64]) -> Vec<f64> {
        self.each_body(self.each(theta, Range::weight), |chart, own| chart.inertia(&own).0)
    }

    fn each_body(
        &self,
        mut numbers: Vec<f64>,
        change: impl Fn(&LogCholesky, [f64; INERTIAL]) -> [f64; INERTIAL],
    ) -> Vec<f64> {
        for (position, chart) in &self.bodies {
            if let Some(own) = numbers.get_mut(*position..).and_then(|rest| rest.first_chunk_mut()) {
                *own = change(chart, *own);
            }
        }
        numbers
    }

    /// dw/dθ of the ten numbers of every learned body, with the position of the first.
    pub fn body_slopes(&self, theta: &[f64]) -> impl Iterator<Item = (usize, [[f64; INERTIAL]; INERTIAL])> {
        self.bodies.iter().filter_map(|(position, chart)| {
            let own = theta.get(*position..)?.first_chunk()?;
            Some((*position, chart.slopes(own)))
        })
    }

    /// dw/dθ of every number that has a range of its own; 1 of all others.
    pub fn slopes(&self, theta: &[f64]) -> Vec<f64> {
        let mut slopes = vec![1.0; theta.len()];
        self.slopes_at(theta).for_each(|(position, slope)| slopes[position] = slope);
        slopes
    }

    /// The weight block nearest to these weights that has a θ.
    pub fn within(&self, weights: Vec<f64>) -> Vec<f64> {
        if self.is_empty() { weights } else { self.weights(&self.free(&weights)) }
    }

    /// Positions and dw/dθ of the numbers that have a range.
    pub fn slopes_at(&self, theta: &[f64]) -> impl Iterator<Item = (usize, f64)> {
        let ranges = self.ranges.iter();
        ranges.filter_map(|(position, range)| Some((*position, range.slope(*theta.get(*position)?))))
    }

    fn each(&self, numbers: &[f64], change: impl Fn(Range, f64) -> f64) -> Vec<f64> {
        let mut numbers = numbers.to_vec();
        for (position, range) in &self.ranges {
            if let Some(number) = numbers.get_mut(*position) {
                *number = change(*range, *number);
            }
        }
        numbers
    }
}
