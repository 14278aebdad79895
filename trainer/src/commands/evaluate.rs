//! `leastaction evaluate`.

use super::system::{Kind, System};
use clap::Args;
use leastaction::cli::arguments::{control, order, positive, seed};
use leastaction::cli::{Done, Failure, FileKind, Output, refuse, replaceable};
use leastaction::evaluation::{
    Evaluation, LogReading, LongTermRequest, Scalable, is_page, write_joint_bag, write_page,
};
use leastaction::models::of_file_or_run;
use leastaction_core::forces::ControlKind;
use leastaction_ground_truth::Mechanism;
use leastaction_models::Model;
use std::path::{Path, PathBuf};

/// Measure a model on logged motion.
///
/// Errors are those of accelerations, if the log has v and a; of positions one step ahead, from the two before; and of positions over whole
/// trajectories, from the second sample on, with its velocity if the log has v, else that of the first two positions, under the logged
/// control, held or linear between samples. Samples that cannot be computed are counted and left out of the errors. Angles in the log may
/// be wrapped into one turn.
///
/// The steps are also done as on the chip: in single precision, by the code that runs there, to the last bit. A graph is stepped by RATTLE,
/// on its rods.
///
/// With --system n-pendulum, n-body, rod-pendulum, n-spring or hybrid, the model also predicts from random starts by its learned
/// accelerations (with the weights as shipped, else in double precision; on the rods, if there are any). The errors are ModLaNet's, beside
/// those of the exact accelerations in single precision: A_q = |q' - q| / samples, angles not wrapped; A_E likewise for the exact energy of
/// the predicted state; and the time until the position is off by 0.1 m or rad.
///
/// Example: leastaction evaluate m.postcard --data log.npz
///
/// Example: leastaction evaluate run --config robot.toml --data test.csv -o page.html
///
/// Example: leastaction evaluate run --data new.csv --mcap compared.mcap
///
/// Example: leastaction evaluate m.postcard --data triple.npz --tree triple --system n-pendulum -o prediction
#[derive(Args)]
pub struct Evaluate {
    /// The model file, or the folder of a training run.
    model: PathBuf,
    /// The log, .npz, .csv, .mat, .mcap, .db3, or the folder of a bag or of a data set of LeRobot; *, ? and ** match several files. With a run it is read as the run's own logs were, unless it has
    /// leastaction's own names alone.
    #[arg(long, value_name = "FILE", required_unless_present = "config")]
    data: Option<PathBuf>,
    /// A configuration whose [data] gives names and units of columns, step and control of the log, and without --data the log itself.
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    /// Order of the steps, 2 or 4 [default: the model's, else 4].
    #[arg(long, value_parser = order)]
    order: Option<u8>,
    /// Behaviour of u between samples, held or linear [default: as the log says, else as for the model, else held].
    #[arg(long, value_name = "KIND", value_parser = control)]
    control: Option<ControlKind>,
    /// The tree or graph that the log belongs to, for a model of several [default: the one that was trained].
    #[arg(long, visible_alias = "graph", value_name = "NAME")]
    tree: Option<String>,
    /// Also compare with this exact mechanism: inertia and, for motion without force, energy; for systems of any size, predictions.
    #[arg(long)]
    system: Option<System>,
    /// Number of random starts for predictions [default: 100].
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..), requires = "system")]
    starts: Option<u32>,
    /// Length of the predictions, s [default: 30].
    #[arg(long, value_parser = positive, requires = "system")]
    seconds: Option<f64>,
    /// Another model, a file or the folder of a run, to compare with on the page: for instance a simpler one.
    #[arg(long, value_name = "MODEL", requires = "output")]
    beside: Option<PathBuf>,
    /// Seed of the random starts [default: 0].
    #[arg(long, value_parser = seed, requires = "system")]
    seed: Option<u64>,
    /// A page, .html, that reports how good the model is on the log; with --system a folder for the errors of predictions over time:
    /// prediction.csv and prediction.svg.
    #[arg(short, long, value_name = "PAGE.html|FOLDER")]
    output: Option<PathBuf>,
    /// A bag of ROS 2 with the topics /measured, /predicted and /residual, to be shown by Foxglove, PlotJuggler or Rerun. Predictions are
    /// over windows of 1 s, one after the other.
    #[arg(long, value_name = "FILE.mcap")]
    mcap: Option<PathBuf>,
}

impl Evaluate {
    /// Reads the model and the log, and measures.
    pub fn run(self, output: Output) -> Done {
        let page = self.page()?;
        self.mcap.iter().try_for_each(|path| replaceable(path, FileKind::Bag))?;
        let model = self.load(&self.model)?;
        let beside = self.beside(page, &model)?;
        let reading = self.log()?;
        let (order, control) = (self.order, self.control);
        let evaluation = Evaluation { file: &self.model, model: &model, order, control };
        let tell = &mut |sentence: String| output.note(&format!("note: {sentence}"));
        let log = evaluation.read(&reading, tell)?;
        let system = self.system.map(|system| self.exact(system, &model)).transpose()?;
        let symo = match system {
            Some(Exact::Symo(mechanism)) => Some(mechanism),
            _ => None,
        };
        let mut report = evaluation.measure(&log, symo, tell)?;
        if let Some(Exact::Scalable(system)) = system {
            let folder = self.output.as_deref().filter(|_| page.is_none());
            report.prediction = Some(self.request(&model, system).run(folder)?);
        }
        if let Some(path) = &self.mcap {
            write_joint_bag(path, (&self.model, &model), &log, tell)?;
            output.note(&format!("bag in {}", path.display()));
        }
        if let Some(path) = page {
            let beside = self.beside.as_deref().zip(beside.as_ref());
            let numbers = report.torques.as_ref().and_then(|torques| torques.torque_numbers.as_ref());
            write_page(path, ((&self.model, &model), beside), (&log.file, &log.data), numbers)?;
            output.note(&format!("page in {}", path.display()));
        }
        output.report(&report)
    }

    /// The requested page; a folder only makes sense with --system.
    fn page(&self) -> Result<Option<&Path>, Failure> {
        let Some(path) = self.output.as_deref() else { return Ok(None) };
        match is_page(path)? {
            true => Ok(Some(path)),
            false if self.system.is_some() => Ok(None),
            false => {
                Err(Failure::input(path, "name a page, as page.html; a folder is written with --system"))
            }
        }
    }

    fn load(&self, path: &Path) -> Result<Model, Failure> {
        of_file_or_run(path, self.tree.as_deref())
    }

    /// The model to compare with on the page.
    fn beside(&self, page: Option<&Path>, model: &Model) -> Result<Option<Model>, Failure> {
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

    /// The log, and the settings for reading it.
    fn log(&self) -> Result<LogReading, Failure> {
        LogReading::new(self.config.as_deref(), self.data.clone().map(Into::into), &self.model)
    }

    /// The exact mechanism of a system, with as many coordinates as the model.
    fn exact(&self, system: System, model: &Model) -> Result<Exact, Failure> {
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
                let plane = model.architecture.family.graph().is_some_and(|graph| graph.dimension() == 2);
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

    fn request<'a>(&self, model: &'a Model, system: Scalable) -> LongTermRequest<'a> {
        LongTermRequest {
            model,
            system,
            starts: self.starts.unwrap_or(100) as usize,
            seconds: self.seconds.unwrap_or(30.0),
            seed: self.seed.unwrap_or(0),
        }
    }
}

/// An exact mechanism with as many coordinates as the model.
enum Exact {
    Symo(Mechanism),
    Scalable(Scalable),
}
