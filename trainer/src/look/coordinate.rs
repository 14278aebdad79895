//! How strongly logs excite a coordinate.

use super::Seen;
use leastaction_learning::data::survey::{Clock, Guess, MotionSurvey, time_unit};
use leastaction_learning::data::unit;
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;

/// A coordinate in all files, in the units of its column.
#[derive(Serialize)]
pub struct Coordinate {
    /// Its column.
    pub column: String,
    /// Root mean square of its velocity (1/s).
    pub speed: f64,
    /// Part of the time in which it moves, 0 to 1.
    pub moving: f64,
    /// How often it turned back, which is what tells friction from other forces.
    pub reversals: usize,
    /// Jumps by 2π.
    pub turns: usize,
    /// Jumps by 360.
    pub turns_of_360: usize,
    /// Single samples apart from their neighbours.
    pub outliers: usize,
    /// The first of them.
    pub first_outlier: Option<FirstOutlier>,
}

/// Where a sample lies apart from its neighbours.
#[derive(Serialize)]
pub struct FirstOutlier {
    /// The file.
    pub file: PathBuf,
    /// In the file, from 0.
    pub sample: usize,
    /// Its stamp (s).
    pub time: f64,
    /// How far it is from where its neighbours would have it.
    pub off: f64,
}

impl Coordinate {
    /// Every coordinate that moved long enough in some file.
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
