//! Charts as SVG files: loss curves, phase portraits, time series and log-log plots.
//!
//! The files need nothing else: no script, no font file, no style sheet. Colours are those of Okabe and Ito, which
//! the colour-blind tell apart; there are seven, then they repeat. A label stands in the legend once. A file is replaced
//! in one step or not at all. Curves are thinned to what the eye can see, so millions of points are no burden on the file. Values that an axis cannot show interrupt a curve: those that are not
//! finite (or beyond 10³⁰⁰), and zero and negative ones on a logarithmic axis. A chart of nothing says so.

mod axis;
mod charts;
mod curve;
mod figure;
mod series;
#[cfg(test)]
mod tests;

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

pub use charts::{
    Panel, Phase, Vertical, curves_svg, log_log, loss_curve, phase_portrait, stacked, stacked_svg,
    time_series,
};
pub use series::{Angle, Series, Stroke};

/// The drawing library failed.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("cannot draw the chart: {reason}")]
pub struct NotDrawn {
    /// What it said.
    pub reason: String,
}

impl NotDrawn {
    fn of(self, file: &Path) -> PlotError {
        PlotError::Draw { file: file.to_owned(), reason: self.reason }
    }
}

/// A chart that could not be made.
#[derive(Debug, Error)]
pub enum PlotError {
    /// The file could not be written.
    #[error("{}: {error}", file.display())]
    Write {
        /// The file.
        file: PathBuf,
        /// What the operating system said.
        error: io::Error,
    },
    /// The drawing library failed.
    #[error("{}: cannot draw the chart: {reason}", file.display())]
    Draw {
        /// The file that was to be written.
        file: PathBuf,
        /// What the library said.
        reason: String,
    },
}
