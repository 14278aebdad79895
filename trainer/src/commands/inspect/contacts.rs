//! Dry friction and end stops of the coordinates.

use leastaction_models::{DryNumbers, StopNumbers};
use serde::Serialize;
use std::fmt;

/// Dry friction of a coordinate, −(coulomb (1 + asymmetry t) + load (√(τ² + smoothing²) − smoothing)) t, t = tanh(v/width), or the law of these
/// levels that sticks.
#[derive(Serialize)]
pub(super) struct DryFrictionReport {
    /// Constant part, N or N m.
    coulomb: f64,
    asymmetry: f64,
    load: f64,
    /// Smoothing of the load, N or N m.
    smoothing: f64,
    /// Width, m/s or rad/s.
    width: f64,
    /// Friction at rest over friction in motion; absent if friction does not stick.
    #[serde(skip_serializing_if = "Option::is_none")]
    breakaway: Option<f64>,
}

impl From<DryNumbers> for DryFrictionReport {
    fn from(of: DryNumbers) -> Self {
        let DryNumbers { constant: coulomb, asymmetry, load, smoothing, width, breakaway } = of;
        Self { coulomb, asymmetry, load, smoothing, width, breakaway }
    }
}

/// Writes the asymmetry of a number that differs by direction.
fn by_direction(f: &mut fmt::Formatter, asymmetry: f64) -> fmt::Result {
    match asymmetry {
        0.0 => Ok(()),
        _ => write!(f, " ({:+.1}% forwards, {:+.1}% backwards)", 100.0 * asymmetry, -100.0 * asymmetry),
    }
}

impl fmt::Display for DryFrictionReport {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { coulomb, asymmetry, load, smoothing, width, breakaway } = self;
        write!(f, "{coulomb:.4} N or N m")?;
        by_direction(f, *asymmetry)?;
        if *load != 0.0 {
            write!(f, " and {load:.4} of the load beyond {smoothing:.4} N or N m")?;
        }
        match breakaway {
            None => write!(f, ", changing sign over {width:.4} m/s or rad/s"),
            Some(1.0) => write!(f, ", sticking at rest"),
            Some(breakaway) => write!(f, ", sticking at rest, where it is {breakaway:.4} times as large"),
        }
    }
}

/// End stops of a coordinate.
#[derive(Serialize)]
pub(super) struct StopReport {
    coordinate: usize,
    /// Lower and upper position, m or rad.
    lower: f64,
    upper: f64,
    /// Speed after over speed before a strike.
    restitution: f64,
}

impl StopReport {
    /// Stops of the coordinates that have some.
    pub(super) fn of(stops: Vec<Option<StopNumbers>>) -> Vec<Self> {
        let report = |(coordinate, stops): (usize, Option<StopNumbers>)| {
            let StopNumbers { lower, upper, restitution } = stops?;
            Some(Self { coordinate, lower, upper, restitution })
        };
        stops.into_iter().enumerate().filter_map(report).collect()
    }
}

impl fmt::Display for StopReport {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { coordinate, lower, upper, restitution } = self;
        write!(f, "q{coordinate}: {lower:.4} … {upper:.4} m or rad, restitution {restitution:.4}")
    }
}
