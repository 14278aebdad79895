//! Progress of training on stderr: a bar on a terminal, lines elsewhere.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use leastaction::cli::Output;
use leastaction_learning::run::{Monitor, Row, Run};
use std::io::{IsTerminal, stderr};
use std::time::{Duration, Instant};

/// Time between lines.
const PAUSE: Duration = Duration::from_secs(2);

/// Shows the rows of a run.
pub enum Progress {
    /// Warnings alone.
    Quiet,
    /// A bar that is redrawn in place.
    Bar(ProgressBar),
    /// A line every few seconds.
    Lines {
        /// Time of the last line.
        last: Option<Instant>,
        /// Number of iterations of all stages.
        iterations: u64,
    },
}

impl Progress {
    /// The display that suits stderr.
    pub fn new(output: Output, run: &Run) -> Self {
        let iterations = run.plan().iterations();
        if output.quiet {
            Self::Quiet
        } else if stderr().is_terminal() {
            Self::Bar(bar(iterations, run.iteration()))
        } else {
            Self::Lines { last: None, iterations }
        }
    }

    /// Leaves the last state of the bar on the screen.
    pub fn finish(&self) {
        if let Self::Bar(bar) = self {
            bar.abandon();
        }
    }
}

fn bar(iterations: u64, done: u64) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(iterations), ProgressDrawTarget::stderr());
    let template = "{bar:24} {pos}/{len} {msg} {per_sec} {elapsed}";
    let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    bar.set_style(style.progress_chars("=> "));
    bar.set_position(done);
    bar.reset_eta();
    bar
}

/// On a terminal, the time since it was made, which runs while logs are read and choices made; else nothing.
pub fn waiting(output: Output) -> ProgressBar {
    if output.quiet || !stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new_spinner().with_message("reading, choosing and first fits");
    bar.enable_steady_tick(Duration::from_millis(200));
    bar.set_style(
        ProgressStyle::with_template("{msg} {elapsed}").unwrap_or_else(|_| ProgressStyle::default_spinner()),
    );
    bar
}

impl Monitor for Progress {
    fn row(&mut self, row: &Row) {
        match self {
            Self::Quiet => {}
            Self::Bar(bar) => {
                // Further starts take iterations that were not planned.
                bar.set_length(bar.length().unwrap_or_default().max(row.iteration));
                bar.set_position(row.iteration);
                bar.set_message(losses(row));
            }
            Self::Lines { last, iterations } => {
                if last.is_none_or(|last| last.elapsed() >= PAUSE) {
                    *last = Some(Instant::now());
                    let rate = row.iteration as f64 / row.seconds.max(1e-9);
                    let of = (*iterations).max(row.iteration);
                    Output::default().note(&format!("{}/{of} {} {rate:.1}/s", row.iteration, losses(row)));
                }
            }
        }
    }

    fn warning(&mut self, message: &str) {
        let print = || Output::default().note(&format!("warning: {message}"));
        match self {
            Self::Bar(bar) => bar.suspend(print),
            _ => print(),
        }
    }
}

fn losses(row: &Row) -> String {
    let validation = row.validation.map_or(String::new(), |loss| format!(", validation {loss:.2e}"));
    format!("{}: train {:.2e}{validation}", row.stage, row.train)
}
