//! Doubts about a log: mixed-up units, placeholder numbers.

use std::fmt;

use crate::angles::seams;
use crate::{Dataset, Rows, Trajectory};

/// Largest plausible position, velocity, acceleration or force, in SI units. Beyond it, squares and differences lose
/// all digits in single precision.
const LARGEST: f64 = 1e12;

/// Plausible steps of a mechanism, s.
const STEPS: std::ops::Range<f64> = 1e-6..1.0;

/// Largest plausible speed, m/s or rad/s.
const FASTEST: f64 = 1e6;

/// Largest accepted ratio between velocities and differences of positions; undersampled motion reaches it.
const DISAGREEMENT: f64 = 5.0;

/// Squared correlation above which velocities and differences of positions count as having the same shape.
const ALIKE: f64 = 0.8;

/// A reason to inspect a log before a model is trained or evaluated on it.
#[derive(Debug, Clone, PartialEq)]
pub enum Doubt {
    /// An implausibly large number.
    Value {
        /// q, v, a or u.
        field: &'static str,
        /// Coordinate, from 0.
        coordinate: usize,
        /// Id of the trajectory.
        trajectory: i64,
        /// Sample in the trajectory, from 0.
        sample: usize,
        /// The number.
        value: f64,
    },
    /// An implausible step (s).
    Step(f64),
    /// Consecutive positions that are too far apart.
    Leap {
        /// Coordinate, from 0.
        coordinate: usize,
        /// Id of the trajectory.
        trajectory: i64,
        /// Later of the two samples in the trajectory, from 0.
        sample: usize,
        /// Speed between them (m/s, rad/s).
        speed: f64,
    },
    /// Velocities that differ from the differences of positions.
    Velocity {
        /// Coordinate, from 0.
        coordinate: usize,
        /// Ratio of velocities to differences.
        factor: f64,
    },
    /// An angle that jumps by 360.
    Degrees {
        /// Coordinate, from 0.
        coordinate: usize,
        /// Id of the trajectory.
        trajectory: i64,
        /// First sample after the jump in the trajectory, from 0.
        sample: usize,
    },
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Value { field, coordinate, trajectory, sample, value } => write!(
                f,
                "{field}{coordinate} is {value:e} at sample {sample} of trajectory {trajectory}, which no mechanism reaches in SI units; look for a \
                 sensor that failed there, or for a number that stands for none"
            ),
            Self::Step(h) if *h >= STEPS.end => {
                write!(
                    f,
                    "the step is {h} s, long for a mechanism; if t or h is in milliseconds, give seconds"
                )
            }
            Self::Step(h) => write!(f, "the step is {h:e} s, short for a log; give t or h in seconds"),
            Self::Leap { coordinate, trajectory, sample, speed } => write!(
                f,
                "q{coordinate} leaps at sample {sample} of trajectory {trajectory}, at {speed:.0e} m/s or rad/s; look for a sensor that \
                 failed there"
            ),
            Self::Velocity { coordinate, factor } => {
                let (times, hint) = (readable(*factor), hint(*factor));
                write!(f, "v{coordinate} is {times} times what q{coordinate} and the step say; {hint}")
            }
            Self::Degrees { coordinate, trajectory, sample } => write!(
                f,
                "q{coordinate} is an angle and jumps by 360 at sample {sample} of trajectory {trajectory}; if it is in degrees, give radians"
            ),
        }
    }
}

fn readable(factor: f64) -> String {
    match factor.abs() {
        0.01..10.0 => format!("{factor:.3}"),
        10.0..1e5 => format!("{factor:.0}"),
        _ => format!("{factor:.0e}"),
    }
}

/// Question to the user about the likely cause if velocities are wrong by this factor.
fn hint(factor: f64) -> &'static str {
    let near = |other: f64| (factor.max(1.0 / factor) / other - 1.0).abs() < 0.15;
    if near(1000.0) {
        "is t or h in milliseconds?"
    } else if near(1f64.to_degrees()) {
        "is one of them in degrees?"
    } else {
        "check the units of q, v and t"
    }
}

impl Dataset {
    /// Doubts about the log: at most one of each kind, and one value per field. `letters` has one letter per coordinate, as in
    /// [`Dataset::unwrap_angles`], which should be called first.
    #[must_use]
    pub fn doubts(&self, letters: &str) -> Vec<Doubt> {
        let fields = (0..4).filter_map(|field| self.trajectories.iter().find_map(|t| too_large(t, field)));
        let values: Vec<Doubt> = fields.collect();
        if values.iter().any(|value| matches!(value, Doubt::Value { field: "q", .. })) {
            // Further checks would compute with such a position.
            return values;
        }
        let step = (!STEPS.contains(&self.h)).then_some(Doubt::Step(self.h));
        // A wrong step makes every position appear to leap.
        let mut trajectories = self.trajectories.iter().filter(|_| step.is_none());
        let leap = trajectories.find_map(|trajectory| leap(trajectory, self.h));
        let velocity = (0..self.n).find_map(|i| self.velocity(i));
        let angles = letters.chars().enumerate().filter(|(_, letter)| *letter == 'a');
        let degrees = angles.flat_map(|(i, _)| self.trajectories.iter().map(move |t| (i, t)));
        let degrees = degrees.into_iter().find_map(|(i, trajectory)| degrees_of(trajectory, i));
        values.into_iter().chain([step, leap, velocity, degrees].into_iter().flatten()).collect()
    }

    /// Compares velocities with central differences of positions. A mix-up of units shows as the same shape with
    /// another size.
    fn velocity(&self, coordinate: usize) -> Option<Doubt> {
        let (mut of_both, mut of_differences, mut of_velocities) = (0.0, 0.0, 0.0);
        for trajectory in &self.trajectories {
            let q: Vec<f64> = trajectory.q.column(coordinate).collect();
            let differences = q.windows(3).map(|q| (q[2] - q[0]) / (2.0 * self.h));
            for (d, v) in differences.zip(trajectory.v.as_ref()?.column(coordinate).skip(1)) {
                of_both += d * v;
                of_differences += d * d;
                of_velocities += v * v;
            }
        }
        let factor = of_both / of_differences;
        let alike = of_both * of_both > ALIKE * of_differences * of_velocities;
        let disagree = factor.abs() > DISAGREEMENT || factor.abs() < 1.0 / DISAGREEMENT;
        (alike && disagree).then_some(Doubt::Velocity { coordinate, factor })
    }
}

/// The first implausibly large number of field number `field` of q, v, a, u.
fn too_large(trajectory: &Trajectory, field: usize) -> Option<Doubt> {
    let (field, rows) = trajectory.fields().into_iter().nth(field)?;
    let rows = rows?;
    let at = rows.as_flat().iter().position(|value| value.abs() > LARGEST)?;
    let (sample, coordinate) = (at / rows.width(), at % rows.width());
    Some(Doubt::Value { field, coordinate, trajectory: trajectory.id, sample, value: rows.as_flat()[at] })
}

fn leap(trajectory: &Trajectory, h: f64) -> Option<Doubt> {
    let pairs = |rows: &Rows| {
        let (before, after) = (rows.as_flat(), rows.as_flat().get(rows.width()..).unwrap_or_default());
        before.iter().zip(after).map(|(a, b)| (b - a).abs() / h).position(|speed| speed > FASTEST)
    };
    let at = pairs(&trajectory.q)?;
    let (n, q) = (trajectory.q.width(), trajectory.q.as_flat());
    let speed = (q[at + n] - q[at]).abs() / h;
    Some(Doubt::Leap { coordinate: at % n, trajectory: trajectory.id, sample: at / n + 1, speed })
}

fn degrees_of(trajectory: &Trajectory, coordinate: usize) -> Option<Doubt> {
    let angles: Vec<f64> = trajectory.q.column(coordinate).collect();
    let seam = seams(&angles, 360.0).iter().position(|seam| *seam != 0)?;
    Some(Doubt::Degrees { coordinate, trajectory: trajectory.id, sample: seam + 1 })
}
