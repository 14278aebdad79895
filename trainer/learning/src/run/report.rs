//! The report on a run over windows.

use super::doubt::{ran_away, unexplained};
use super::plan::Plan;
use super::stages::Windowed;
use crate::checkpoint::State;
use crate::config::{TrainingConfig, TrainingLoss};
use crate::evaluate::horizons::Predictor;
use crate::report::{Fit, Page, ReportError};
use crate::torques::SplitErrors;
use crate::windows::{self, Calibrated, CalibrationLayout, Certainty, WindowLogs};
use leastaction_models::config::Origin;
use leastaction_models::{Facts, Model};

/// The page on the best weights of a run; `None` if nothing was learned over windows.
pub(super) fn html(plan: &Plan, state: &State) -> Result<Option<String>, ReportError> {
    let Some(windows) = &plan.windows else { return Ok(None) };
    let Windowed { logs, settings, layout, .. } = windows;
    let Ok(loss) = windows.loss(&plan.architecture) else { return Ok(None) };
    let shared = shared(state, *layout);
    let length = settings.steps as f64 * logs.h;
    let calibrated = layout.read(shared);
    let model = model(plan, shared, (*layout, &calibrated));
    let simple = Simple::of(plan, state.alone.as_deref(), (*layout, &calibrated));
    let torques = plan.torques().filter(|_| plan.config.training.loss == Some(TrainingLoss::Torque));
    let torques = torques.map(|report| &report.numbers);
    let learned = torques.is_none().then_some(&plan.architecture);
    let report = Page {
        title: format!("Learned from {}", plan.config.data.file),
        facts: facts(plan, windows, (state, &model)),
        predictor: Predictor { model: &model, zeros: &calibrated.zeros, logs },
        beside: simple.as_ref().map(|simple| (simple.name.to_owned(), simple.predictor(logs))),
        fit: Some(Fit::new(&loss, starts(plan, state, windows), length, learned)),
        torques,
    };
    report.html().map(Some)
}

/// The best parameters that all windows share.
fn shared(state: &State, layout: CalibrationLayout) -> &[f64] {
    let weights = &state.best.weights;
    weights.get(..layout.end()).unwrap_or(weights)
}

/// The best parameters, with the start states of the windows that are shown if the last stage has found them.
fn starts<'s>(plan: &Plan, state: &'s State, windows: &Windowed) -> &'s [f64] {
    let has_starts = windows.ends_with_shown && state.stage + 1 == plan.stages.len();
    if has_starts { &state.best.weights } else { shared(state, windows.layout) }
}

/// The model with the drives of its logs.
fn model(plan: &Plan, shared: &[f64], (layout, calibrated): (CalibrationLayout, &Calibrated)) -> Model {
    let weights = shared.get(..layout.start).unwrap_or(shared).to_vec();
    let facts = Facts { actuator: calibrated.actuator.clone(), ..Facts::new(plan.trained_step, "") };
    Model::new(plan.architecture.clone(), weights).with_facts(facts)
}

/// The best model of a run over windows with the zero offsets of its logs; `None` for another loss.
pub(super) fn calibrated(plan: &Plan, state: &State) -> Option<(Model, Vec<Vec<f64>>)> {
    let layout = plan.calibration()?;
    let shared = shared(state, layout);
    let calibrated = layout.read(shared);
    Some((model(plan, shared, (layout, &calibrated)), calibrated.zeros))
}

/// Precision of the best numbers of a run over windows; `None` for another loss.
pub(super) fn certainty(plan: &Plan, state: &State) -> Option<Certainty> {
    let windows = plan.windows.as_ref()?;
    let loss = windows.loss(&plan.architecture).ok()?;
    let weights = loss.settled(starts(plan, state, windows));
    windows::certainty(&loss, &weights, &plan.architecture.ranges())
}

/// The simpler physical model from which a run began.
struct Simple {
    name: &'static str,
    model: Model,
    zeros: Vec<Vec<f64>>,
}

impl Simple {
    /// The model before correcting networks were added, or the model that a network started from, with the sensors and
    /// drives of the same logs; `None` if there is neither.
    fn of(
        plan: &Plan,
        alone: Option<&[f64]>,
        (layout, calibrated): (CalibrationLayout, &Calibrated),
    ) -> Option<Self> {
        if let Some(shared) = alone {
            let Calibrated { actuator, zeros } = layout.read(shared);
            let model = Model::new(plan.architecture.clone(), shared.get(..layout.start)?.to_vec());
            let facts = Facts { actuator, ..Facts::new(plan.trained_step, "") };
            return Some(Self { name: "without networks", model: model.with_facts(facts), zeros });
        }
        let Origin(model) = plan.origin.as_ref()?;
        let facts = Facts { trained_step: plan.trained_step, ..model.facts.clone() };
        let model = model.clone().with_facts(facts);
        Some(Self { name: "the model it started from", model, zeros: calibrated.zeros.clone() })
    }

    fn predictor<'a>(&'a self, logs: &'a WindowLogs) -> Predictor<'a> {
        Predictor { model: &self.model, zeros: &self.zeros, logs }
    }
}

fn facts(plan: &Plan, windows: &Windowed, (state, model): (&State, &Model)) -> Vec<(&'static str, String)> {
    let (logs, architecture) = (&windows.logs, &plan.architecture);
    let samples = logs.all_samples();
    let length = windows.settings.steps as f64 * logs.h;
    let mut facts = vec![
        (
            "model",
            format!(
                "{}, {} coordinates ({}), {} numbers, {} of them learned",
                architecture.name(),
                architecture.n(),
                architecture.coordinates(),
                plan.parameters(),
                plan.learned_parameters()
            ),
        ),
        (
            "logs",
            format!(
                "{}: {} logs, {samples} samples, {:.1} s in all, one every {} s; fingerprint {:016x}",
                plan.config.data.file,
                logs.count(),
                samples as f64 * logs.h,
                logs.h,
                plan.data_fingerprint
            ),
        ),
    ];
    match plan.torque_errors(model) {
        Some(errors) => facts.extend(of_torques(plan, state, &errors)),
        None => facts.extend(of_windows(plan, state, length)),
    }
    if state.alone.is_some() {
        let text = "the model alone, as it was learned before its networks; of logs that were held back it has seen nothing";
        facts.push(("without networks", text.to_owned()));
    }
    facts.extend(ran_away(plan, state).map(|number| ("warning", number.to_string())));
    facts.extend(unexplained(plan, state).map(|of| ("warning", of.to_string())));
    facts.push(("program", format!("leastaction {}", env!("CARGO_PKG_VERSION"))));
    facts
}

/// Facts about training on torques.
fn of_torques(plan: &Plan, state: &State, errors: &SplitErrors) -> [(&'static str, String); 2] {
    let TrainingConfig { cut_off, seed, .. } = plan.config.training;
    let seconds = plan.preparation().as_secs_f64() + state.seconds;
    let training = format!("on torques, filtered at {cut_off} Hz, seed {seed}; {seconds:.1} s");
    [("training", training), ("torques", errors.to_string())]
}

/// Facts about training over windows of `length` seconds.
fn of_windows(plan: &Plan, state: &State, length: f64) -> [(&'static str, String); 2] {
    let State { best, seconds, .. } = state;
    let training = format!(
        "over windows of {length} s, seed {}; {seconds:.1} s; best at iteration {}, loss {:.3e} (m, rad)²",
        plan.config.training.seed, best.iteration, best.train
    );
    let held_back = match best.validation {
        Some(loss) => format!(
            "positions of logs that were held back were {:.2e} (m, rad) off, over windows from the start states that fit them best; \
             then these logs were learned from as well, and all that follows is of all logs",
            loss.sqrt()
        ),
        None => "no log: all that follows is of logs that were learned from".to_owned(),
    };
    [("training", training), ("held back", held_back)]
}

#[cfg(test)]
mod tests {
    use super::super::tests::{Warned, config, data};
    use super::super::{Plan, PlanError, Run};
    use crate::config::{Config, TrainingLoss};
    use crate::windows::Integrator;
    use leastaction_core::discrete::Order;
    use std::path::Path;
    use std::sync::atomic::AtomicBool;

    fn over_windows() -> Config {
        let mut config = config();
        (config.training.loss, config.training.window) = (Some(TrainingLoss::Windows), Some(0.2));
        config
    }

    fn train(config: Config, folder: &Path) -> Run {
        let mut run = Run::begin(Plan::new(config, &data(6, true)).unwrap(), folder, true).unwrap();
        let mut said = Warned::default();
        run.train(&mut said, &AtomicBool::new(false)).unwrap();
        assert!(said.warnings.is_empty(), "{:?}", said.warnings);
        run
    }

    /// A model fitted by DEL steps from sample to sample states this step in its file; a model fitted in continuous
    /// time has no step.
    #[test]
    fn a_model_of_windows_by_del_steps_has_its_step() {
        let step = |integrator| {
            let mut config = over_windows();
            (config.training.loss, config.training.integrator) = (None, Some(integrator));
            Plan::new(config, &data(6, true)).unwrap().train().unwrap().trained_step
        };
        let own = step(Integrator::Del).unwrap();
        assert_eq!((own.order, own.h), (Order::Two, data(6, true).h as f32));
        assert_eq!(step(Integrator::RungeKutta), None);
    }

    #[test]
    fn single_steps_have_no_integrator() {
        let mut config = over_windows();
        (config.training.loss, config.training.integrator) =
            (Some(TrainingLoss::NextPosition), Some(Integrator::Del));
        assert_eq!(Plan::new(config, &data(6, true)).err(), Some(PlanError::Integrator));
    }

    #[test]
    fn a_run_over_windows_has_a_page_and_another_has_none() {
        let folder = tempfile::tempdir().unwrap();
        let page = train(over_windows(), folder.path()).report().unwrap();
        let text = std::fs::read_to_string(&page).unwrap();
        for part in [
            "<h2>Errors of predictions</h2>",
            "<h2>Measured and predicted</h2>",
            "<h2>Inertia and potential</h2>",
            "<h2>Residuals</h2>",
            "<h2>What was learned</h2>",
            "weights of networks",
            "6 logs, 54 samples",
        ] {
            assert!(text.contains(part), "{part}");
        }
        assert_eq!(text.matches("<svg").count(), text.matches("</svg>").count());
        // The page loads nothing from elsewhere.
        let links = ["<script", "<img", "<link", "src=", "url(", "@import"];
        assert!(links.iter().all(|link| !text.contains(link)));
        // A new run in this folder removes the page of the old one.
        assert_eq!(train(config(), folder.path()).report(), None);
        assert!(!page.exists());
    }
}
