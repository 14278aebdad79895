//! Excitation of the coordinates in logs.

use super::Seen;
use leastaction_learning::data::survey::{Guess, MotionSurvey, time_unit};
use leastaction_learning::data::unit;
use serde::Serialize;
use std::fmt;
use std::ops::Range;
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
        let of = |seen| motions(seen, column, t).into_iter().map(move |motion| (seen, motion));
        let motions: Vec<(&Seen, MotionSurvey)> = seen.iter().flat_map(of).collect();
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

/// The motion of a column in every trajectory of a file; samples are counted in the whole file.
fn motions(seen: &Seen, column: &str, t: &str) -> Vec<MotionSurvey> {
    let (Some(stamps), Some(q)) = (seen.log.column(t), seen.log.column(column)) else { return Vec::new() };
    let known = seen.log.is_in_seconds().then_some(1.0);
    let of_clock = || unit(time_unit(seen.clock(t)?.median));
    let Some(second) = known.or_else(of_clock) else { return Vec::new() };
    let stamps: Vec<f64> = stamps.iter().map(|t| second * t).collect();
    let motion = |rows: Range<usize>| {
        let mut motion = MotionSurvey::of(&stamps[rows.clone()], &q[rows.clone()])?;
        motion.outliers.iter_mut().for_each(|outlier| outlier.sample += rows.start);
        Some(motion)
    };
    seen.log.pieces().into_iter().filter_map(motion).collect()
}
