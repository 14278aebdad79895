//! Charts as SVG files: loss curves, phase portraits, time series and log-log plots; and pages that hold them ([`page`]).
//!
//! The files are self-contained: no script, no font file, no style sheet. The colours are the seven of Okabe and Ito that the colour-blind
//! can distinguish; after that they repeat. Every label appears once in the legend. A file is replaced atomically. Curves are thinned to
//! what the eye can see, so millions of points do not inflate the file. Values that an axis cannot show interrupt a curve: those that are
//! not finite (or beyond 10³⁰⁰), and zero and negative values on a logarithmic axis. A chart without data says so.

mod axis;
mod charts;
mod curve;
mod figure;
pub mod page;
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
    /// Message of the library.
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
        /// Error of the operating system.
        error: io::Error,
    },
    /// The drawing library failed.
    #[error("{}: cannot draw the chart: {reason}", file.display())]
    Draw {
        /// The file that was to be written.
        file: PathBuf,
        /// Message of the library.
        reason: String,
    },
}
