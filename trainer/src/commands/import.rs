//! `leastaction import`.

use super::system::SymoSystem;
use clap::{Args, Subcommand, ValueEnum};
use leastaction::cli::arguments::{positive, positive_f32};
use leastaction::cli::{Done, Failure, FileKind, Output, replaceable};
use leastaction_core::discrete::Order;
use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_core::forces::ControlKind;
use leastaction_core::model::TrainedStep;
use leastaction_ground_truth::{ManyBody, Mechanism};
use leastaction_learning::atomic;
use leastaction_learning::import::{self, Imported};
use leastaction_models::file;
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};

/// Make a model file from a network trained elsewhere.
#[derive(Args)]
pub struct Import {
    #[command(subcommand)]
    source: Source,
}

#[derive(Subcommand)]
enum Source {
    Symo(Symo),
    Modlanet(Modlanet),
    Lgnn(Lgnn),
}

/// A network of the SyMo authors' program (SyMo, E2E-SyMo or L-NODE), as safetensors with their tensor names.
///
/// Weights are rounded to single precision, in which that program trains.
///
/// Example: leastaction import symo cartpole.safetensors --system cartpole -o m.postcard
#[derive(Args)]
struct Symo {
    /// The safetensors file.
    file: PathBuf,
    /// Take coordinates and step from this mechanism of the paper.
    #[arg(long, required_unless_present = "coordinates")]
    system: Option<SymoSystem>,
    /// One letter per coordinate, in the order of q: t translation, a angle.
    #[arg(long, value_name = "LETTERS", conflicts_with = "system")]
    coordinates: Option<String>,
    /// Step that the network was trained with, s [default: that of --system; none for L-NODE].
    #[arg(long, value_name = "SECONDS", value_parser = positive_f32, allow_negative_numbers = true)]
    h: Option<f32>,
    /// The model file to write.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
}

/// A network of the ModLaNet authors' program, as safetensors with their tensor names.
///
/// The file has a single set of element weights, which serves a tree of any size. Weights are rounded to single precision, in which that
/// program trains.
///
/// Example: leastaction import modlanet 3_body.safetensors --system body --count 4 -o m.postcard
#[derive(Args)]
struct Modlanet {
    /// The safetensors file.
    file: PathBuf,
    /// Kind of the elements.
    #[arg(long, value_enum, default_value = "pendulum")]
    system: Element,
    /// Number of elements in the tree, at most 32 [default: 2 pendulums, 3 bodies].
    #[arg(long)]
    count: Option<u8>,
    /// Mass to use instead of the file's, kg; it scales all energies and changes no motion.
    #[arg(long, value_name = "KG", value_parser = positive, allow_negative_numbers = true)]
    mass: Option<f64>,
    /// The model file to write.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
}

/// A network of the LGNN authors' program, trained on pendulums, as safetensors with their tensor names.
///
/// The file has a single node type, which serves a chain of any number of bobs in Cartesian coordinates, on known rods of 1 m. Weights are
/// rounded to single precision.
///
/// Example: leastaction import lgnn 3_pendulum.safetensors --count 5 -o m.postcard
#[derive(Args)]
struct Lgnn {
    /// The safetensors file.
    file: PathBuf,
    /// Number of bobs in the chain, at most 32.
    #[arg(long, default_value_t = 3)]
    count: u8,
    /// Use the drag network, which was trained (every file has one).
    #[arg(long)]
    drag: bool,
    /// The model file to write.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
}

#[derive(Clone, Copy, ValueEnum)]
enum Element {
    /// Pendulums, each hanging from the one before: angles, learned transforms, potentials without activation.
    Pendulum,
    /// Free points in the plane: tanh potentials.
    Body,
}

/// Report on the written file.
#[derive(Serialize)]
struct Report {
    model: PathBuf,
    bytes: usize,
    parameters: usize,
    coordinates: String,
    h: Option<f32>,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let (model, bytes, parameters) = (self.model.display(), self.bytes, self.parameters);
        let step = self.h.map_or("no step".to_owned(), |h| format!("order 2, step {h} s"));
        writeln!(
            f,
            "{model}: {bytes} bytes, {parameters} parameters, coordinates {}, {step}",
            self.coordinates
        )
    }
}

impl Import {
    /// Reads the network, converts it and writes the model file.
    pub fn run(self, output: Output) -> Done {
        match self.source {
            Source::Symo(symo) => symo.run(output),
            Source::Modlanet(modlanet) => modlanet.run(output),
            Source::Lgnn(lgnn) => lgnn.run(output),
        }
    }
}

impl Symo {
    fn run(self, output: Output) -> Done {
        let bytes = std::fs::read(&self.file).map_err(|error| Failure::input(&self.file, error))?;
        let coordinates = self.coordinates()?;
        let imported =
            import::symo(&bytes, &coordinates).map_err(|error| Failure::input(&self.file, error))?;
        let step =
            self.h.or(self.mechanism().map(|system| system.step() as f32)).filter(|_| imported.discrete);
        let trained_step = step.map(|h| TrainedStep { order: Order::Two, h, control: ControlKind::Linear });
        Files { from: &self.file, to: self.output }.write(&imported, trained_step, "SyMo", output)
    }

    fn mechanism(&self) -> Option<Mechanism> {
        self.system.map(Mechanism::from)
    }

    fn coordinates(&self) -> Result<Vec<Coordinate>, Failure> {
        let Some(letters) = &self.coordinates else {
            return Ok(self.mechanism().map(|system| system.coordinates().to_vec()).unwrap_or_default());
        };
        let wrong = || Failure::Input(format!("--coordinates {letters}: one letter a coordinate, t or a"));
        let kinds: Option<Vec<_>> = letters.chars().map(Coordinate::from_letter).collect();
        kinds.filter(|kinds| !kinds.is_empty()).ok_or_else(wrong)
    }
}

impl Modlanet {
    fn run(self, output: Output) -> Done {
        let bytes = std::fs::read(&self.file).map_err(|error| Failure::input(&self.file, error))?;
        let imported = import::modlanet(&bytes, self.system(), self.mass)
            .map_err(|error| Failure::input(&self.file, error))?;
        Files { from: &self.file, to: self.output }.write(&imported, None, "ModLaNet", output)
    }

    fn system(&self) -> ManyBody {
        let count = |default| self.count.map_or(default, usize::from);
        match self.system {
            Element::Pendulum => ManyBody::Pendulum(count(2)),
            Element::Body => ManyBody::Bodies(count(3)),
        }
    }
}

impl Lgnn {
    fn run(self, output: Output) -> Done {
        let bytes = std::fs::read(&self.file).map_err(|error| Failure::input(&self.file, error))?;
        let imported = import::lgnn(&bytes, self.count.into(), self.drag)
            .map_err(|error| Failure::input(&self.file, error))?;
        Files { from: &self.file, to: self.output }.write(&imported, None, "LGNN", output)
    }
}

/// The files to read and to write.
struct Files<'a> {
    from: &'a Path,
    to: PathBuf,
}

impl Files<'_> {
    /// Writes the model file and reports it.
    fn write(
        self,
        imported: &Imported,
        trained_step: Option<TrainedStep>,
        program: &str,
        output: Output,
    ) -> Done {
        replaceable(&self.to, FileKind::Model)?;
        let name = self.from.file_name().unwrap_or_default().to_string_lossy();
        let provenance = format!("imported from {name} ({program})");
        let model = file::encode(&imported.architecture, &imported.weights, trained_step, &provenance)
            .map_err(|error| Failure::input(self.from, error))?;
        atomic::write(&self.to, &model).map_err(|error| Failure::file(&self.to, error))?;
        output.report(&Report {
            model: self.to,
            bytes: model.len(),
            parameters: imported.weights.len(),
            coordinates: imported.architecture.coordinates(),
            h: trained_step.map(|trained_step| trained_step.h),
        })
    }
}
