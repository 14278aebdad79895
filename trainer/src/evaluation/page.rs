//! Report on a model along a log, as one HTML page.

use crate::cli::{Failure, FileKind, replaceable};
use leastaction_learning::atomic;
use leastaction_learning::data::Dataset;
use leastaction_learning::evaluate::horizons::Predictor;
use leastaction_learning::report::{Fit, Page};
use leastaction_learning::torque_numbers::TorqueNumbers;
use leastaction_learning::windows::{
    Calibration, Integrator, Setting, WindowLogs, WindowLoss, WindowModel, WindowSettings,
};
use leastaction_models::Model;
use std::ffi::OsStr;
use std::path::Path;
use std::sync::Arc;

/// Whether a path names a page; refuses to replace other files.
pub fn is_page(path: &Path) -> Result<bool, Failure> {
    let is_page =
        path.extension().and_then(OsStr::to_str).is_some_and(|end| end.eq_ignore_ascii_case("html"));
    if is_page {
        replaceable(path, FileKind::Page)?;
    }
    Ok(is_page)
}

/// Length of the windows for residuals, s, if the logs are long enough.
const WINDOW: f64 = 1.0;

/// Writes the page on a model from `file` along these logs, compared with another model if given.
pub fn write(
    path: &Path,
    ((file, model), beside): ((&Path, &Model), Option<(&Path, &Model)>),
    (data, log): (&Path, &Dataset),
    torques: Option<&TorqueNumbers>,
) -> Result<(), Failure> {
    let failed =
        |error: &dyn std::fmt::Display| Failure::Work(format!("the page on {}: {error}", file.display()));
    let Model { architecture, weights, facts, .. } = model;
    let logs = Arc::new(WindowLogs::new(log));
    let other = beside.map(|(file, model)| (file.display().to_string(), predictor(model, &logs)));
    let report = Page {
        title: format!("{} on {}", file.display(), data.display()),
        facts: vec![
            ("model", format!("{}, {} numbers; {}", architecture.name(), weights.len(), facts.provenance)),
            (
                "log",
                format!(
                    "{}: {} trajectories, {} samples, one every {} s",
                    data.display(),
                    log.trajectories.len(),
                    log.samples(),
                    log.h
                ),
            ),
            ("encoders", "zero offsets of these logs are not known, and taken to be 0".to_owned()),
            ("program", format!("leastaction {}", env!("CARGO_PKG_VERSION"))),
        ],
        fit: fit(model, &logs),
        predictor: predictor(model, &logs),
        beside: other,
        torques,
    };
    let page = report.html().map_err(|error| failed(&error))?;
    atomic::write(path, page.as_bytes()).map_err(|error| Failure::file(path, error))
}

fn predictor<'a>(model: &'a Model, logs: &'a WindowLogs) -> Predictor<'a> {
    Predictor { model, zeros: &[], logs }
}

/// Residuals over windows; `None` if no log has room for a window, or if the model has rods.
fn fit(model: &Model, logs: &Arc<WindowLogs>) -> Option<Fit> {
    let longest = (0..logs.count()).map(|log| logs.samples(log)).max()?;
    let steps =
        ((WINDOW / logs.h).round() as usize).clamp(1, longest.checked_sub(1).filter(|steps| *steps > 0)?);
    let own = WindowModel::new(&model.architecture).ok()?;
    let (integrator, order, _) =
        Integrator::of_trained(model.facts.trained_step, &own.system, (logs.h, logs.h));
    let settings = WindowSettings {
        steps,
        stride: steps,
        integrator,
        longest_step: logs.h,
        order,
        calibration: Calibration { lag: Setting::Known(model.facts.actuator.lag), ..Calibration::default() },
    };
    let loss = WindowLoss::new(own, logs, 0..logs.count(), settings).ok()?;
    let actuator = &model.facts.actuator;
    let gains = (0..logs.n).map(|i| actuator.gain(i));
    let offsets = (0..logs.n).map(|i| actuator.offset(i));
    let shared: Vec<f64> =
        model.weights.iter().copied().chain(gains).chain(offsets).chain([actuator.delay]).collect();
    Some(Fit::new(&loss, &shared, steps as f64 * logs.h, None))
}
