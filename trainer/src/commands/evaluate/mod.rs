//! `leastaction evaluate`.

mod long_term;
mod on_chip;
mod page;
mod report;

use super::chip;
use super::inspect::{load_part, of_part};
use super::notes::tell;
use super::system::{Kind, System};
use clap::Args;
use leastaction::cli::arguments::{control, order, positive, seed};
use leastaction::cli::{Done, Failure, Output, refuse};
use leastaction_core::discrete::Order;
use leastaction_core::forces::ControlKind;
use leastaction_core::model::ModelError;
use leastaction_learning::architecture::Architecture;
use leastaction_learning::checkpoint::Trained;
use leastaction_learning::config::{Config, DataConfig, TrainingConfig};
use leastaction_learning::data::{Dataset, control_name};
use leastaction_learning::evaluate::{
    Beginning, acceleration_mse, energy_mse, finished, inertia_mse, one_step_mse, rollout,
};
use leastaction_learning::ground_truth::Mechanism;
use leastaction_learning::model_file::{HostModel, Precision, decode, encode_in};
use leastaction_learning::torque_numbers::torque_numbers;
use leastaction_learning::torques::{TorqueErrors, torque_errors};
use leastaction_learning::windows::Calibrated;
use long_term::{Request, Scalable};
pub use report::Torques;
use report::{Acceleration, Report, Steps};
use std::path::{Path, PathBuf};

/// Measure a model on logged motion.
///
/// Accelerations, where the log has v and a; positions one step ahead, from the two before; and over whole trajectories from the
/// second sample on, with its velocity where the log has v, else that of the first two positions, under the logged control, held or
/// linear between samples. What cannot be computed is counted, and left out of the errors. Angles of the log may be wrapped into one
/// turn.
///
/// The same steps on the chip: in single precision, by the code that runs there, to the last bit. A graph is stepped by RATTLE, and
/// keeps its rods.
///
/// With --system n-pendulum, n-body, rod-pendulum, n-spring or hybrid also predictions from random starts by the learned
/// accelerations (weights as shipped, else in double precision; on the rods, where there are some), in ModLaNet's measures and beside
/// those of the exact accelerations in single precision: A_q = |q' - q| / samples, angles not wrapped; A_E likewise, of the exact
/// energy of the predicted state; and the time until the position is 0.1 m or rad off.
///
/// Example: leastaction evaluate m.postcard --data log.npz
///
/// Example: leastaction evaluate run --config robot.toml --data test.csv -o page.html
///
/// Example: leastaction evaluate m.postcard --data triple.npz --tree triple --system n-pendulum -o prediction
#[derive(Args)]
pub struct Evaluate {
    /// The model file, or the folder of a run.
    model: PathBuf,
    /// The log, .npz or .csv; *, ? and ** stand for several.
    #[arg(long, value_name = "FILE", required_unless_present = "config")]
    data: Option<PathBuf>,
    /// Take names and units of columns, step and control of the log from [data] of this configuration; without --data the log too.
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    /// Order of the steps, 2 or 4 [default: that of the model, else 4].
    #[arg(long, value_parser = order)]
    order: Option<u8>,
    /// What u does between samples, held or linear [default: what the log says, else that of the model, else held].
    #[arg(long, value_name = "KIND", value_parser = control)]
    control: Option<ControlKind>,
    /// Of a model of several trees or graphs the one that the log is of [default: the one that was trained].
    #[arg(long, visible_alias = "graph", value_name = "NAME")]
    tree: Option<String>,
    /// Also compare with this exact mechanism: inertia and, over motion without force, energy; predictions of systems of any size.
    #[arg(long)]
    system: Option<System>,
    /// Predictions from so many random starts [default: 100].
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..), requires = "system")]
    starts: Option<u32>,
    /// Predictions over so many seconds [default: 30].
    #[arg(long, value_parser = positive, requires = "system")]
    seconds: Option<f64>,
    /// Another model, a file or the folder of a run, to be shown beside this one on the page: a simpler one, to see what this is worth.
    #[arg(long, value_name = "MODEL", requires = "output")]
    beside: Option<PathBuf>,
    /// Of the random starts [default: 0].
    #[arg(long, value_parser = seed, requires = "system")]
    seed: Option<u64>,
    /// A page, .html, on what the model is worth on the log; with --system a folder for the errors of predictions over time:
    /// prediction.csv and prediction.svg.
    #[arg(short, long, value_name = "PAGE.html|FOLDER")]
    output: Option<PathBuf>,
}

impl Evaluate {
    /// Reads and measures.
    pub fn run(self, output: Output) -> Done {
        let page = self.page()?;
        let model = self.load(&self.model)?;
        let beside = self.beside(page, &model)?;
        let mut config = self.log()?;
        config.control = config.control.or(model.facts.trained_step.map(|step| step.control));
        let (mut log, notes) = config.read().map_err(|error| Failure::Input(error.to_string()))?;
        tell(&notes, output);
        let file = PathBuf::from(config.file.to_string());
        self.check(&model, (&file, &log), output)?;
        self.take_control(&model, (&file, &mut log), output)?;
        prepare(&mut log, &model.architecture.coordinates(), output);
        let system = self.system.map(|system| self.exact(system, &model)).transpose()?;
        let symo = match system {
            Some(Exact::Symo(mechanism)) => Some(mechanism),
            _ => None,
        };
        if symo.is_some() && log.is_forced() {
            output.note("note: the log is forced, so that its energy changes: energy is not compared");
        }
        let failed = |error| Failure::input(&self.model, error);
        let mut report = self.measure(&model, (file.clone(), &log), symo).map_err(failed)?;
        report.chip = on_chip(&model, report.order, &log)
            .map_err(|error| output.note(&format!("note: steps on the chip are not measured: {error}")))
            .ok();
        if report.steps.is_none() {
            output.note("note: on rods, positions are stepped on the chip alone");
        }
        if let Some(Exact::Scalable(system)) = system {
            let folder = self.output.as_deref().filter(|_| page.is_none());
            report.prediction = Some(self.request(&model, system).run(folder)?);
        }
        if let Some(path) = page {
            let beside = self.beside.as_deref().zip(beside.as_ref());
            let numbers = report.torques.as_ref().and_then(|torques| torques.torque_numbers.as_ref());
            page::write(path, ((&self.model, &model), beside), (&file, &log), numbers)?;
            output.note(&format!("page in {}", path.display()));
        }
        output.report(&report)
    }

    /// The page that is asked for; a folder is of use with --system alone.
    fn page(&self) -> Result<Option<&Path>, Failure> {
        let Some(path) = self.output.as_deref() else { return Ok(None) };
        match page::is_page(path)? {
            true => Ok(Some(path)),
            false if self.system.is_some() => Ok(None),
            false => {
                Err(Failure::input(path, "name a page, as page.html; a folder is written with --system"))
            }
        }
    }

    /// The model of the file, or as `leastaction export` makes it of a run's folder.
    fn load(&self, path: &Path) -> Result<HostModel, Failure> {
        if !path.is_dir() {
            return Ok(load_part(path, self.tree.as_deref())?.0);
        }
        let refused = |error: &dyn std::fmt::Display| Failure::input(path, error);
        let trained = Trained::read(path).map_err(|error| refused(&error))?;
        let bytes =
            encode_in(Precision::Single, &trained.architecture, &trained.best.weights, &trained.facts())
                .map_err(|error| refused(&error))?;
        let model = decode(&bytes).map_err(|error| refused(&error))?;
        of_part(path, model, self.tree.as_deref())
    }

    /// The model that is shown beside this one.
    fn beside(&self, page: Option<&Path>, model: &HostModel) -> Result<Option<HostModel>, Failure> {
        let Some(path) = &self.beside else { return Ok(None) };
        if page.is_none() {
            return Err(Failure::Input("--beside is shown on a page: name one, as -o page.html".to_owned()));
        }
        let other = self.load(path)?;
        let [own, found] = [model, &other].map(|model| model.architecture.n());
        if found == own {
            return Ok(Some(other));
        }
        Err(Failure::input(path, format!("the model has {found} coordinates, the one beside it {own}")))
    }

    /// The log and how it is read.
    fn log(&self) -> Result<DataConfig, Failure> {
        let configured = self.config.as_deref().map(Config::read).transpose()?.map(|config| config.data);
        let named = self.data.as_ref().map(DataConfig::new);
        let mut log = match (configured, named) {
            (Some(configured), Some(named)) => DataConfig { file: named.file, ..configured },
            (Some(one), None) | (None, Some(one)) => one,
            (None, None) => return Err(Failure::Input("name the log with --data".to_owned())),
        };
        log.control = self.control.or(log.control);
        Ok(log)
    }

    fn check(&self, model: &HostModel, (file, log): (&Path, &Dataset), output: Output) -> Done {
        let n = model.architecture.n();
        if log.n != n {
            let message = match model.architecture.part() {
                None => format!("q has {} coordinates, the model {n}", log.n),
                Some((what, name)) => {
                    format!(
                        "q has {} coordinates, {what} {name:?} {n}; name the {what} of the log with --{what}",
                        log.n
                    )
                }
            };
            return Err(Failure::input(file, message));
        }
        if let Some(trained) =
            model.facts.trained_step.filter(|d| (f64::from(d.h) - log.h).abs() > 1e-6 * log.h)
        {
            output.note(&format!(
                "note: the model was trained for a step of {} s and is evaluated at {} s, where it is less accurate",
                trained.h, log.h
            ));
        }
        Ok(())
    }

    /// Decides what u does between samples, and tells where the model was trained for another thing.
    fn take_control(&self, model: &HostModel, (file, log): (&Path, &mut Dataset), output: Output) -> Done {
        let trained = model.facts.trained_step.map(|step| step.control);
        if let Some(asked) = self.control {
            log.set_control(asked).map_err(|stated| {
                let (asked, stated) = (control_name(asked), control_name(stated));
                let message =
                    format!("--control {asked}: the log says that its u is {stated} between samples");
                Failure::input(file, message)
            })?;
        }
        let kind = log.control_kind();
        log.control = Some(kind);
        if let Some(trained) = trained.filter(|trained| *trained != kind && log.control_changes()) {
            let (trained, kind) = (control_name(trained), control_name(kind));
            output.note(&format!(
                "note: the model was trained with a control that is {trained} between samples and is evaluated with one that is {kind}"
            ));
        }
        Ok(())
    }

    /// The mechanism that a system names, of the model's size.
    fn exact(&self, system: System, model: &HostModel) -> Result<Exact, Failure> {
        let (n, letters) = (model.architecture.n(), model.architecture.coordinates());
        match system.kind() {
            Kind::Symo(mechanism) => {
                if mechanism.coordinates().len() != n {
                    let name = mechanism.name();
                    return Err(Failure::Input(format!("--system {name}: the model has {n} coordinates")));
                }
                let options = [
                    (self.starts.is_some(), "--starts"),
                    (self.seconds.is_some(), "--seconds"),
                    (self.seed.is_some(), "--seed"),
                    (self.page()?.is_none() && self.output.is_some(), "--output"),
                ];
                refuse(mechanism.name(), &options)?;
                Ok(Exact::Symo(mechanism))
            }
            Kind::Modlanet(of) => {
                let bodies = system == System::NBody;
                let foreign = if bodies { "ac" } else { "t" };
                if letters.contains(|letter| foreign.contains(letter)) || bodies && n % 2 == 1 {
                    let what = if bodies { "two translations a body" } else { "one angle a pendulum" };
                    let message = format!("--system {}: the model must have {what}", of(1).name());
                    return Err(Failure::Input(message));
                }
                Ok(Exact::Scalable(Scalable::Modlanet(of(if bodies { n / 2 } else { n }))))
            }
            Kind::Lgnn(of) => {
                let system = of(n / 2);
                let plane = model.architecture.graph().is_some_and(|graph| graph.dimension() == 2);
                if !plane || 2 * system.nodes() != n {
                    let (name, nodes) = (system.name(), system.nodes());
                    let message =
                        format!("--system {name}: the model must be a graph of {nodes} nodes in the plane");
                    return Err(Failure::Input(message));
                }
                Ok(Exact::Scalable(Scalable::Lgnn(system)))
            }
        }
    }

    fn request<'a>(&self, model: &'a HostModel, system: Scalable) -> Request<'a> {
        Request {
            model,
            system,
            starts: self.starts.unwrap_or(100) as usize,
            seconds: self.seconds.unwrap_or(30.0),
            seed: self.seed.unwrap_or(0),
        }
    }

    fn measure(
        &self,
        model: &HostModel,
        (data, log): (PathBuf, &Dataset),
        system: Option<Mechanism>,
    ) -> Result<Report, ModelError> {
        let (architecture, weights) = (&model.architecture, &model.weights);
        let order = self.order.or(model.facts.trained_step.map(|step| step.order.number())).unwrap_or(4);
        // Under a force even the true energy does not keep its first value, which the measure compares with.
        let free = system.filter(|_| !log.is_forced());
        let steps = || steps((architecture, weights), order, log, free);
        let inertia = |system| inertia_mse(architecture, weights, system, log);
        let part = |what| {
            let (_, name) = architecture.part().filter(|(of, _)| *of == what)?;
            Some(name.to_owned())
        };
        let acceleration = acceleration_mse(architecture, weights, log)?;
        Ok(Report {
            model: self.model.clone(),
            data,
            tree: part("tree"),
            graph: part("graph"),
            order,
            h: log.h,
            control: log.control_changes().then(|| control_name(log.control_kind())),
            trajectories: log.trajectories.len(),
            samples: log.samples(),
            acceleration: acceleration.map(|(solved, square)| Acceleration {
                acceleration_mse: solved.mean_square,
                acceleration_relative: solved.mean_square.map(|error| error / square),
                acceleration_unsolved: solved.unsolved,
            }),
            torques: torques(model, log),
            steps: architecture.has_steps().then(steps).transpose()?,
            chip: None,
            inertia_mse: system.map(inertia).transpose()?,
            prediction: None,
        })
    }
}

/// Steps in the chip's arithmetic; an error in words where it has not the size of the model.
fn on_chip(model: &HostModel, order: u8, log: &Dataset) -> Result<Steps, String> {
    let order = Order::from_number(order).ok_or("there is no such order")?;
    let file = chip::file(model)?;
    let measured = on_chip::steps(&chip::meant(&file, model)?, order, log);
    measured.map_err(|error| error.to_string())
}

/// Measures steps, and energies where they are to be compared with those of a mechanism.
fn steps(
    (architecture, weights): (&Architecture, &[f64]),
    order: u8,
    log: &Dataset,
    mechanism: Option<Mechanism>,
) -> Result<Steps, ModelError> {
    let one_step = one_step_mse(architecture, weights, order, log)?;
    let (runs, motions) = finished(&rollout(architecture, weights, order, (log, Beginning::Velocity))?, log);
    let energy = mechanism.filter(|_| !runs.is_empty()).map(|system| energy_mse(system, &runs, &motions));
    let steps = Steps::new(one_step, (&runs, &motions), log.trajectories.len());
    Ok(Steps { energy_mse: energy, ..steps })
}

/// Has angles go on across their seams, and tells of what is doubtful.
fn prepare(log: &mut Dataset, letters: &str, output: Output) {
    let note = |note: &dyn std::fmt::Display| output.note(&format!("note: {note}"));
    log.unwrap_angles(letters).iter().for_each(|seams| note(seams));
    log.doubts(letters).iter().for_each(|doubt| note(doubt));
}

/// An exact mechanism of the model's size.
enum Exact {
    Symo(Mechanism),
    Scalable(Scalable),
}

/// Errors of the torques of an arm, motion and torques filtered as training does by default.
pub fn torques(model: &HostModel, log: &Dataset) -> Option<Torques> {
    let calibrated = Calibrated::of_file(&model.facts.actuator, model.architecture.n()).ok();
    let of = (&model.architecture, &model.weights[..]);
    let cut_off = TrainingConfig::default().cut_off;
    let TorqueErrors { nmse, rmse, .. } = torque_errors(of, calibrated.as_ref(), log, cut_off)?;
    let torque_numbers = torque_numbers(of, calibrated.as_ref(), log, cut_off);
    Some(Torques { torque_nmse: nmse, torque_rmse: rmse, torque_numbers })
}
