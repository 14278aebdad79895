//! Numbers with a range, as the optimisers see them: free parameters θ from which the numbers follow. Everywhere else, weight blocks hold
//! the numbers themselves.
//!
//! A number above 0 is w = e^θ, so that a step of θ changes it in proportion to its size. The damping of
//! Levenberg–Marquardt and the steps of Adam are the same for every θ; this change of variables makes them suitable for
//! numbers from 10⁻³ to 10³, whatever their unit. (ln(1 + e^θ) has this property only below 1; from there on it is
//! linear.) If a Gauss–Newton step goes too far up, it is rejected and damped like any other. Downwards, for a residual
//! that is linear in w, it takes δθ = (w* − w)/w > −1. A number between a and b is w = a + ½(b − a)(1 + tanh θ).
//!
//! θ is limited so that the number stays a little away from its bound in double precision: at the bound its derivative
//! would be 0, and nothing could move it any more. See [`LEAST`] and [`MARGIN`].

use crate::tree::{INERTIAL, Inertia, LogCholesky};
use serde::{Deserialize, Serialize};

/// Smallest value of a number above 0; the largest is its reciprocal.
pub const LEAST: f64 = 1e-12;
/// Distance that a number between two bounds keeps from both, as a fraction of the interval.
pub const MARGIN: f64 = 1e-4;

/// Range of a number of a weight block.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Range {
    /// Any value: θ = w.
    Any,
    /// Above 0: w = e^θ.
    Positive,
    /// Between two bounds, the lower first: w = a + ½(b − a)(1 + tanh θ).
    Between(f64, f64),
}

impl Range {
    /// Returns the θ of a number, which is always finite; a number out of range or at a bound has the θ of the nearest number inside.
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

    /// θ, limited to values whose numbers keep their distance from the bounds.
    fn held(self, theta: f64) -> f64 {
        let most = match self {
            Self::Any => return theta,
            Self::Positive => -LEAST.ln(),
            Self::Between(..) => 0.5 * ((1.0 - MARGIN) / MARGIN).ln(),
        };
        theta.clamp(-most, most)
    }

    /// Returns the number for θ.
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

/// The restricted numbers of a weight block: single numbers with a range, and the ten inertial numbers of each body,
/// which are kept physically consistent together. All other numbers may take any value.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bounds {
    ranges: Vec<(usize, Range)>,
    /// Positions of the first inertial number of every body that is kept physically consistent; its θ are log-Cholesky parameters.
    bodies: Vec<(usize, LogCholesky)>,
}

/// Bounds without any range.
pub static NONE: Bounds = Bounds { ranges: Vec::new(), bodies: Vec::new() };

impl Bounds {
    /// Creates bounds from ranges and their positions in the weight block, each position given once.
    pub fn new(mut ranges: Vec<(usize, Range)>) -> Self {
        ranges.retain(|(_, range)| *range != Range::Any);
        Self { ranges, bodies: Vec::new() }
    }

    /// Returns these bounds, with the ten numbers that start at each of these positions treated as a body.
    #[must_use]
    pub fn with_bodies(self, bodies: Vec<(usize, LogCholesky)>) -> Self {
        Self { bodies, ..self }
    }

    /// Whether every number may take any value, so that θ is the weight block itself.
    pub fn is_empty(&self) -> bool {
        self.ranges.is_empty() && self.bodies.is_empty()
    }

    /// Whether the number at this position must be above 0.
    pub fn is_positive(&self, position: usize) -> bool {
        self.ranges.contains(&(position, Range::Positive))
    }

    /// Returns the θ of a weight block. Numbers out of range or at a bound have the θ of the nearest number inside; a physically
    /// inconsistent body has θ = 0.
    pub fn free(&self, weights: &[f64]) -> Vec<f64> {
        let chart =
            |chart: &LogCholesky, own: [f64; INERTIAL]| chart.numbers(&Inertia(own)).unwrap_or_default();
        self.each_body(self.each(weights, Range::free), chart)
    }

    /// Returns the weight block for θ, with every number in its range.
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

    /// dw/dθ of the ten numbers of every learned body, with the position of the first number.
    pub fn body_slopes(&self, theta: &[f64]) -> impl Iterator<Item = (usize, [[f64; INERTIAL]; INERTIAL])> {
        self.bodies.iter().filter_map(|(position, chart)| {
            let own = theta.get(*position..)?.first_chunk()?;
            Some((*position, chart.slopes(own)))
        })
    }

    /// dw/dθ of every number that has a range of its own; 1 for all others.
    pub fn slopes(&self, theta: &[f64]) -> Vec<f64> {
        let mut slopes = vec![1.0; theta.len()];
        self.slopes_at(theta).for_each(|(position, slope)| slopes[position] = slope);
        slopes
    }

    /// Returns the weight block nearest to these weights that some θ reaches.
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
