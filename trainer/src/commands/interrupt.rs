//! Handling of Ctrl-C: the first requests a stop, the second ends the program at once.

use leastaction::cli::Failure;
use std::sync::atomic::{AtomicBool, Ordering};

static STOP: AtomicBool = AtomicBool::new(false);

/// Exit code of a program that Ctrl-C ended.
const INTERRUPTED: i32 = 130;

/// A flag that Ctrl-C (or SIGTERM) sets.
pub fn flag() -> Result<&'static AtomicBool, Failure> {
    let handler = || {
        if STOP.swap(true, Ordering::Relaxed) {
            std::process::exit(INTERRUPTED);
        }
    };
    ctrlc::set_handler(handler)
        .map_err(|error| Failure::Work(format!("Ctrl-C cannot be handled: {error}")))?;
    Ok(&STOP)
}
