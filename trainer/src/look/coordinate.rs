//! Excitation of the coordinates in logs.

use super::Seen;
use leastaction_learning::data::survey::{Clock, Guess, MotionSurvey, time_unit};
use leastaction_learning::data::unit;
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;

/// Motion of a coordinate in all files, in the units of its column.
#[derive(Serialize)]
pub struct Coordinate {
    /// Column.
    pub column: String,
    /// Root mean square of the velocity (1/s).
    pub speed: f64,
    /// Fraction of time in motion, 0 to 1.
    pub moving: f64,
    /// Number of reversals, which separate friction from other forces.
    pub reversals: usize,
    /// Number of jumps by 2π.
    pub turns: usize,
    /// Number of jumps by 360.
    pub turns_of_360: usize,
    /// Number of outliers: single samples off the curve through their neighbours.
    pub outliers: usize,
    /// First outlier.
    pub first_outlier: Option<FirstOutlier>,
}

/// Place of an outlier.
#[derive(Serialize)]
pub struct FirstOutlier {
    /// The file.
    pub file: PathBuf,
    /// Index of the sample in the file, from 0.
    pub sample: usize,
    /// Stamp (s).
    pub time: f64,
    /// Deviation from the curve through the neighbours.
    pub off: f64,
}

impl Coordinate {
    /// All coordinates that moved long enough in some file.
    pub(super) fn all(seen: &[Seen], guess: &Guess) -> Vec<Self> {
        let Some(t) = &guess.t else { return Vec::new() };
        guess.q.iter().filter_map(|column| Self::of(column, t, seen)).collect()
    }

    fn of(column: &str, t: &str, seen: &[Seen]) -> Option<Self> {
        let motions: Vec<(&Seen, MotionSurvey)> =
            seen.iter().filter_map(|seen| Some((seen, motion(seen, column, t)?))).collect();
        let samples: usize = motions.iter().map(|(_, motion)| motion.samples).sum();
        let mean = |of: fn(&MotionSurvey) -> f64| {
            let weighted = motions.iter().map(|(_, motion)| motion.samples as f64 * of(motion));
            weighted.sum::<f64>() / samples as f64
        };
        let sum = |of: fn(&MotionSurvey) -> usize| motions.iter().map(|(_, motion)| of(motion)).sum();
        let first = motions.iter().find_map(|(seen, motion)| Some((seen, motion.outliers.first()?)));
        (samples > 0).then(|| Self {
            column: column.to_owned(),
            speed: mean(|motion| motion.speed * motion.speed).sqrt(),
            moving: mean(|motion| motion.moving),
            reversals: sum(|motion| motion.reversals),
            turns: sum(|motion| motion.turns),
            turns_of_360: sum(|motion| motion.turns_of_360),
            outliers: sum(|motion| motion.outliers.len()),
            first_outlier: first.map(|(seen, outlier)| FirstOutlier {
                file: seen.file.clone(),
                sample: outlier.sample,
                time: outlier.time,
                off: outlier.off,
            }),
        })
    }

    pub(super) fn line(&self, f: &mut fmt::Formatter, width: usize) -> fmt::Result {
        let Self { column, speed, reversals, outliers, .. } = self;
        let moving = format!("{:.0}%", 100.0 * self.moving);
        let turns = self.turns + self.turns_of_360;
        writeln!(f, "{column:width$}  {speed:>9.3e}  {moving:>6}  {reversals:9}  {turns:5}  {outliers:8}")
    }
}

fn motion(seen: &Seen, column: &str, t: &str) -> Option<MotionSurvey> {
    let (stamps, q) = (seen.log.column(t)?, seen.log.column(column)?);
    let of_topic = seen.log.topic.as_ref().map(|_| 1.0);
    let second = of_topic.or_else(|| unit(time_unit(Clock::of(stamps)?.median)))?;
    let stamps: Vec<f64> = stamps.iter().map(|t| second * t).collect();
    MotionSurvey::of(&stamps, q)
}
