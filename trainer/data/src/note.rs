//! Notes of a reader on a log that it accepted.

use crate::layout_note::LayoutNote;
use crate::place::Place;
use std::fmt;

/// A decision of the reader about a log that it accepted; to be shown to the user.
#[derive(Debug, Clone, PartialEq)]
pub enum Note {
    /// Part of a file is not laid out as samples usually are.
    Layout(LayoutNote),
    /// The samples were resampled, because stamps were uneven or another step was wanted.
    Resampled(Resampled),
    /// Samples are missing; the trajectory was split before this place.
    Gap {
        /// First sample after the gap.
        place: Place,
        /// Id in the file.
        trajectory: i64,
        /// Number of missing samples.
        missing: u64,
        /// Id of the continuation after the gap.
        continues_as: i64,
    },
    /// Short gaps were bridged: the motion goes on across them as it does elsewhere.
    Bridged {
        /// Number of gaps.
        gaps: usize,
        /// The longest of them (s).
        longest: f64,
    },
    /// Samples were left out because their stamps are later than those of samples that follow them, or than their
    /// place between their neighbours.
    Late {
        /// Number of samples.
        samples: usize,
    },
    /// A piece between gaps with fewer than 3 samples was left out.
    Dropped {
        /// First sample of the piece.
        place: Place,
        /// Id in the file.
        trajectory: i64,
        /// Number of samples in the piece.
        samples: usize,
    },
    /// Messages of a topic lack stamps; their times of recording are used.
    Unstamped {
        /// The topic.
        topic: String,
    },
    /// Samples of the coordinates were left out because columns of another clock have no data at these times.
    Uncovered {
        /// Number of samples left out.
        samples: usize,
    },
    /// Samples in the intervals to leave out were left out.
    LeftOut {
        /// Number of samples left out.
        samples: usize,
        /// Number of pieces that the log now has.
        pieces: usize,
    },
    /// Whole turns were added to an angle to make it continuous across the seam of its range.
    Seams {
        /// Coordinate, from 0.
        coordinate: usize,
        /// Whether the coordinate was declared cyclic, not an angle, but moves like an angle.
        cyclic: bool,
        /// Number of seams in all trajectories.
        seams: usize,
        /// Ids of the trajectories with seams.
        trajectories: Vec<i64>,
    },
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Layout(layout) => layout.fmt(f),
            Self::Resampled(resampled) => resampled.fmt(f),
            Self::Gap { place, trajectory, missing, continues_as } => write!(
                f,
                "trajectory {trajectory}{place}: samples missing: {missing}; it continues as trajectory {continues_as}"
            ),
            Self::Bridged { gaps, longest } => {
                let plural = if *gaps == 1 { "" } else { "s" };
                write!(
                    f,
                    "bridged {gaps} short gap{plural} of at most {longest:.3e} s: the motion goes on across them as it does elsewhere; \
                     positions in between are interpolated"
                )
            }
            Self::Late { samples } => {
                let plural = if *samples == 1 { "" } else { "s" };
                write!(f, "left out {samples} sample{plural} with late stamps, as a busy logger writes them")
            }
            Self::Dropped { place, trajectory, samples } => write!(
                f,
                "trajectory {trajectory}{place}: left out a piece of {samples} samples between gaps; 3 are needed"
            ),
            Self::Unstamped { topic } => write!(
                f,
                "{topic} has messages without a stamp: its time is that at which the recorder got them, late and with jitter"
            ),
            Self::Uncovered { samples } => write!(
                f,
                "left out {samples} samples of the coordinates where columns of another clock have none"
            ),
            Self::LeftOut { samples, pieces } => {
                let plural = if *pieces == 1 { "piece" } else { "pieces" };
                write!(
                    f,
                    "left out {samples} samples by time, as configured; {pieces} {plural} of the log remain"
                )
            }
            Self::Seams { coordinate, cyclic, seams, trajectories } => {
                let taken = if *cyclic { ", a cyclic coordinate taken for an angle," } else { "" };
                let plural = if *seams == 1 { "" } else { "s" };
                write!(f, "q{coordinate}{taken} jumps by 2π {seams} time{plural}, in {}", few(trajectories))?;
                f.write_str("; whole turns were added there, so that it goes on across the seam")
            }
        }
    }
}

/// Result of resampling.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resampled {
    /// New step (s).
    pub h: f64,
    /// Median interval in the file (s).
    pub median: f64,
    /// Shortest interval (s).
    pub shortest: f64,
    /// Longest interval that is not a gap (s).
    pub longest: f64,
    /// Number of samples left out because their stamp repeats the one before.
    pub repeated: usize,
}

impl Resampled {
    /// Summary of several files resampled onto the same step: the median of their medians, the shortest and the longest interval. `None` if
    /// there are no files.
    #[must_use]
    pub fn together(files: &[Self]) -> Option<Self> {
        let mut medians: Vec<f64> = files.iter().map(|file| file.median).collect();
        medians.sort_unstable_by(f64::total_cmp);
        let both = |a: Self, b: Self| Self {
            shortest: a.shortest.min(b.shortest),
            longest: a.longest.max(b.longest),
            repeated: a.repeated + b.repeated,
            ..a
        };
        let all = files.iter().copied().reduce(both)?;
        Some(Self { median: *medians.get(medians.len() / 2)?, ..all })
    }
}

/// Relative differences of intervals below which a note gives them in place of the intervals, which look alike.
const SAME: f64 = 0.01;

impl fmt::Display for Resampled {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { h, median, shortest, longest, repeated } = self;
        let off = [shortest, longest]
            .map(|interval| (interval / median - 1.0).abs())
            .into_iter()
            .fold(0.0, f64::max);
        write!(f, "resampled onto a step of {h} s; the stamps are {median:.3e} s apart in the median, ")?;
        if off < SAME {
            write!(f, "all within {:.3}%", 100.0 * off)?;
        } else {
            write!(f, "{shortest:.3e} to {longest:.3e} s")?;
        }
        match repeated {
            0 => Ok(()),
            1 => f.write_str("; 1 with the time of the one before was left out"),
            _ => write!(f, "; {repeated} with the time of the one before were left out"),
        }
    }
}

/// Lists trajectories by their ids, at most the first five.
fn few(ids: &[i64]) -> String {
    const MOST: usize = 5;
    let shown: Vec<String> = ids.iter().take(MOST).map(i64::to_string).collect();
    let (plural, rest) =
        (if ids.len() == 1 { "y" } else { "ies" }, if ids.len() > MOST { ", …" } else { "" });
    let count = if ids.len() > MOST { format!("{} ", ids.len()) } else { String::new() };
    format!("{count}trajector{plural} {}{rest}", shown.join(", "))
}
