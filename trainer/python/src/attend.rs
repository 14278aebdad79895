//! Searches on another thread, while that of Python calls back and watches for Ctrl-C.

use crate::planning::refused;
use leastaction_planning::PlanError;
use pyo3::call::PyCallArgs;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

/// Time between checks for Ctrl-C.
const PAUSE: Duration = Duration::from_millis(50);

/// Runs `search` without the interpreter's lock, with a flag that asks it to stop and a function that calls `callback`. Returns what was
/// found, and whether Ctrl-C stopped the search. An exception of `callback` stops it and is raised, and so is Ctrl-C if nothing was found.
pub fn attended<R: Send, T: Send + for<'py> PyCallArgs<'py>>(
    py: Python<'_>,
    callback: Option<&Py<PyAny>>,
    search: impl FnOnce(&AtomicBool, &(dyn Fn(T) + Sync)) -> Result<R, PlanError> + Send,
) -> PyResult<(R, bool)> {
    let (found, raised) = py.detach(|| listening(callback, search));
    match raised {
        None => Ok((found.map_err(refused)?, false)),
        Some(error) if error.is_instance_of::<PyKeyboardInterrupt>(py) => {
            found.map(|found| (found, true)).map_err(|_| error)
        }
        Some(error) => Err(error),
    }
}

/// Runs `search` on another thread. Returns its result, and the exception that stopped it.
fn listening<R: Send, T: Send + for<'py> PyCallArgs<'py>>(
    callback: Option<&Py<PyAny>>,
    search: impl FnOnce(&AtomicBool, &(dyn Fn(T) + Sync)) -> R + Send,
) -> (R, Option<PyErr>) {
    let (stop, silent) = (AtomicBool::new(false), callback.is_none());
    let (sender, receiver) = channel();
    std::thread::scope(|scope| {
        let stop = &stop;
        let searching = scope.spawn(move || {
            search(stop, &|message| {
                if !silent {
                    // Nobody listens any more after an exception, which also stops the search.
                    let _ = sender.send(message);
                }
            })
        });
        let raised = heard(&receiver, stop, callback);
        (searching.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)), raised)
    })
}

/// Passes on messages until their sender is gone. The first exception stops the search, and no message is passed on after it.
fn heard<T: for<'py> PyCallArgs<'py>>(
    receiver: &Receiver<T>,
    stop: &AtomicBool,
    callback: Option<&Py<PyAny>>,
) -> Option<PyErr> {
    loop {
        let message = match receiver.recv_timeout(PAUSE) {
            Ok(message) => Some(message),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => return None,
        };
        let called = Python::attach(|py| {
            py.check_signals()?;
            let Some((message, callback)) = message.zip(callback) else { return Ok(()) };
            callback.call1(py, message).map(|_| ())
        });
        if let Err(error) = called {
            stop.store(true, Ordering::Relaxed);
            return Some(error);
        }
    }
}
