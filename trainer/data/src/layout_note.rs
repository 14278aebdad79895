//! Notes on the layout of a file: lines and cells that are not samples.

use std::fmt;

/// Part of a file that was not read as samples usually are.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum LayoutNote {
    /// A line of units under the header was left out.
    UnitsLine {
        /// Line, from 1.
        line: u64,
        /// Cells of the line.
        units: String,
    },
    /// The header comes again, as where logs were put together; a trajectory begins there.
    HeaderAgain {
        /// First line where it does.
        line: u64,
        /// Number of such lines.
        times: usize,
    },
    /// The last line was cut off, and left out.
    CutOff {
        /// Line, from 1.
        line: u64,
    },
    /// A column has blank cells: it has a clock of its own, of the rows where it has numbers.
    Blanks {
        /// Name of the column.
        column: String,
        /// Number of its numbers.
        numbers: usize,
        /// Number of rows.
        rows: usize,
    },
    /// A velocity without any number; velocities were left out.
    NoVelocity {
        /// Name of the column.
        column: String,
    },
}

impl fmt::Display for LayoutNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnitsLine { line, units } => write!(
                f,
                "line {line} has no numbers ({units}): taken for units and left out; units are given under [data.columns]"
            ),
            Self::HeaderAgain { line, times } => {
                let plural = if *times == 1 { "time" } else { "times" };
                write!(
                    f,
                    "the header comes again {times} {plural}, first in line {line}: a trajectory begins there"
                )
            }
            Self::CutOff { line } => write!(f, "line {line}, the last one, was cut off: left out"),
            Self::Blanks { column, numbers, rows } => {
                write!(f, "{column} has numbers in {numbers} of {rows} rows: read at those, as another clock")
            }
            Self::NoVelocity { column } => {
                write!(f, "{column} has no number that is finite: velocities are left out")
            }
        }
    }
}
