//! `leastaction export`.

mod accuracy;
mod description;
mod fmu;

use accuracy::{Accuracy, Compared};
use clap::{Args, ValueEnum};
use description::Description;
use fmu::{Fmi, Fmu};
use leastaction::cli::{Done, Failure, FileKind, Output, replaceable};
use leastaction::models::encoded;
use leastaction_cost::processor::Processor;
use leastaction_learning::atomic;
use leastaction_learning::checkpoint::Trained;
use leastaction_models::file::{self, Precision};
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;

/// Make a model file of a training run.
///
/// The file has the best weights of the run, in single precision, and the facts that a chip needs about them. --rust also writes a Rust
/// module that holds the file as a constant, makes its stepper, and only needs `leastaction-core`. With --constants the module holds the
/// model as constants of the program instead of a file, which saves about 6 KB of code, since neither reader nor checksum is needed. (This
/// does not support trees, graphs, and laws of force with networks.)
///
/// With --weights f16 the weights take half the flash, and the program reports the loss: the model's errors on the log that it learned
/// from, with the weights as trained and as shipped. A chip computes in single precision in either case.
///
/// With --urdf or --mjcf the description of an arm is written as well, with the identified inertias of its moving bodies, its rotors
/// (armature), viscous and Coulomb friction. The description's own text is edited where it can be, so names of meshes stay as they are: write
/// the file beside it.
///
/// With --fmu a functional mock-up unit is written, for co-simulation and model exchange with FMI 3.0 or 2.0 (OpenModelica, Simulink, FMPy).
/// It holds the model file, and a library for this machine that computes as a chip does. Not for graphs. In place of the run a model
/// file may be named, if nothing else is to be made.
///
/// Example: leastaction export run -o model.postcard --rust model.rs
///
/// Example: leastaction export run -o model.postcard --weights f16
///
/// Example: leastaction export model.postcard --fmu model.fmu
///
/// Example: leastaction export run -o model.postcard --urdf identified.urdf --mjcf identified.xml
#[derive(Args)]
pub struct Export {
    /// The folder of the run, or, for --fmu, a model file.
    run: PathBuf,
    /// The model file to write.
    #[arg(short, long, value_name = "FILE", required_unless_present = "fmu")]
    output: Option<PathBuf>,
    /// A Rust source file to write as well.
    #[arg(long, value_name = "FILE")]
    rust: Option<PathBuf>,
    /// Write the Rust source as constants, without the file and its reader.
    #[arg(long, requires = "rust")]
    constants: bool,
    /// A robot description (URDF) to write as well, with the identified numbers.
    #[arg(long, value_name = "FILE")]
    urdf: Option<PathBuf>,
    /// A model of MuJoCo (MJCF) to write as well, with the identified numbers.
    #[arg(long, value_name = "FILE")]
    mjcf: Option<PathBuf>,
    /// A functional mock-up unit (FMU) to write.
    #[arg(long, value_name = "FILE")]
    fmu: Option<PathBuf>,
    /// Version of FMI of the unit: 3 (3.0) or 2 (2.0).
    #[arg(long, value_enum, requires = "fmu", default_value_t = Fmi::Three, hide_possible_values = true)]
    fmi: Fmi,
    /// The library of units [default: the one that was built with this command].
    #[arg(long, value_name = "FILE", requires = "fmu")]
    library: Option<PathBuf>,
    /// Storage format of the weights in the file.
    #[arg(long, value_enum, default_value_t = Weights::F32)]
    weights: Weights,
    /// The log to measure errors on, read as the run's own logs were [default: the one that the run learned from].
    #[arg(long, value_name = "FILE")]
    data: Option<PathBuf>,
}

/// Storage format of weights in a file.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Weights {
    /// Two bytes each, 11 bits of which count.
    F16,
    /// Four bytes each.
    F32,
}

impl Weights {
    fn precision(self) -> Precision {
        match self {
            Self::F16 => Precision::Half,
            Self::F32 => Precision::Single,
        }
    }
}

/// Report on the written files.
#[derive(Serialize)]
struct Report {
    model: Option<PathBuf>,
    bytes: usize,
    parameters: usize,
    weight_bits: u8,
    provenance: String,
    rust: Option<PathBuf>,
    descriptions: Vec<Description>,
    fmu: Option<Fmu>,
    accuracy: Option<Accuracy>,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { model, bytes, parameters, weight_bits, .. } = self;
        let name = model.as_ref().map_or("the model".to_owned(), |file| file.display().to_string());
        writeln!(f, "{name}: {bytes} bytes, {parameters} parameters of {weight_bits} bits")?;
        writeln!(f, "{}", self.provenance)?;
        self.rust.iter().try_for_each(|file| writeln!(f, "{}: the same as Rust source", file.display()))?;
        self.descriptions.iter().try_for_each(|description| write!(f, "{description}"))?;
        self.fmu.iter().try_for_each(|unit| write!(f, "{unit}"))?;
        self.accuracy.iter().try_for_each(|accuracy| write!(f, "{accuracy}"))
    }
}

impl Export {
    /// Writes the files.
    pub fn run(self, output: Output) -> Done {
        if self.run.is_file() {
            return self.of_model_file(output);
        }
        let precision = self.weights.precision();
        self.check()?;
        let (trained, bytes) = encoded(&self.run, precision)?;
        let accuracy = self.accuracy(&trained, &bytes, output)?;
        let descriptions = self.descriptions(&trained, output)?;
        let source = self.rust.as_ref().map(|_| self.source(&bytes)).transpose()?;
        let shipped = file::decode(&bytes).map_err(|error| Failure::file(&self.run, error))?;
        let fmu = self.unit(&shipped, &bytes, output)?;
        if let Some(file) = &self.output {
            atomic::write(file, &bytes).map_err(|error| Failure::file(file, error))?;
        }
        if let (Some(file), Some(source)) = (&self.rust, source) {
            atomic::write(file, source.as_bytes()).map_err(|error| Failure::file(file, error))?;
        }
        descriptions.iter().try_for_each(Description::write)?;
        fmu.iter().try_for_each(Fmu::write)?;
        let model = self.output.clone();
        output.report(&Report {
            model: self.output,
            bytes: bytes.len(),
            parameters: trained.best.weights.len(),
            weight_bits: precision.bits(),
            provenance: trained.provenance,
            rust: self.rust,
            descriptions,
            fmu,
            accuracy,
        })?;
        let is_predicted = Processor::CortexM4f.predict(&shipped).is_some();
        let target = if is_predicted { " --target cortex-m4f" } else { "" };
        model.iter().for_each(|file| output.next(&format!("inspect {}{target}", file.display())));
        Ok(())
    }

    /// The Rust module.
    fn source(&self, bytes: &[u8]) -> Result<String, Failure> {
        if self.constants {
            file::rust_constants(bytes).map_err(|error| Failure::Input(error.to_string()))
        } else {
            file::rust_source(bytes).map_err(|error| Failure::input(&self.run, error))
        }
    }

    /// Refuses to overwrite other files.
    fn check(&self) -> Done {
        let options = [
            ("--output", &self.output),
            ("--rust", &self.rust),
            ("--urdf", &self.urdf),
            ("--mjcf", &self.mjcf),
            ("--fmu", &self.fmu),
        ];
        let named: Vec<(&str, &PathBuf)> =
            options.into_iter().filter_map(|(option, file)| Some((option, file.as_ref()?))).collect();
        for (k, (option, file)) in named.iter().enumerate() {
            if let Some((other, _)) = named[..k].iter().find(|(_, other)| other == file) {
                return Err(Failure::input(
                    file,
                    format!("{other} and {option} name the same file; name two"),
                ));
            }
        }
        self.output.iter().try_for_each(|file| replaceable(file, FileKind::Model))?;
        self.rust.iter().try_for_each(|file| replaceable(file, FileKind::RustModule))
    }

    /// The loss of accuracy by rounding, if weights were rounded to half precision or a log is given.
    fn accuracy(&self, trained: &Trained, bytes: &[u8], output: Output) -> Result<Option<Accuracy>, Failure> {
        if self.weights == Weights::F32 && self.data.is_none() {
            return Ok(None);
        }
        let shipped = file::decode(bytes).map_err(|error| Failure::input(&self.run, error))?;
        let compared = Compared { trained: trained.model(), shipped };
        compared.measure((&self.run, self.data.as_deref()), self.weights.precision(), output)
    }
}
