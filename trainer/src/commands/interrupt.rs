//! Handling of Ctrl-C: the first requests a stop, the second ends the program at once.

use leastaction::cli::Failure;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

static STOP: AtomicBool = AtomicBool::new(false);
static HANDLED: OnceLock<Result<(), String>> = OnceLock::new();

/// Exit code of a program that Ctrl-C ended.
const INTERRUPTED: i32 = 130;

/// A flag that Ctrl-C (or SIGTERM) sets, the same at every call.
pub fn flag() -> Result<&'static AtomicBool, Failure> {
    let handler = || {
        if STOP.swap(true, Ordering::Relaxed) {
            std::process::exit(INTERRUPTED);
        }
    };
    // A process has one handler.
    let handled = HANDLED.get_or_init(|| ctrlc::set_handler(handler).map_err(|error| error.to_string()));
    match handled {
        Ok(()) => Ok(&STOP),
        Err(error) => Err(Failure::Work(format!("Ctrl-C cannot be handled: {error}"))),
    }
}
