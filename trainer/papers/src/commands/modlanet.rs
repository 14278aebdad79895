//! `leastaction-papers modlanet`.

use super::compared::Compared;
use super::selection::{Selection, cases, given, number_or};
use clap::builder::PossibleValue;
use clap::{Args, ValueEnum};
use leastaction::cli::{Done, Failure, Output};
use leastaction_core::energy::modular::PairInput;
use leastaction_learning::data::modlanet;
use leastaction_papers::MODLANET;
use leastaction_papers::modlanet::{Baseline, Case, ModlanetData, Options, tasks};
use std::path::PathBuf;

/// ModLaNet (Lu et al., ICML 2022): pendulums and bodies from accelerations, extended to more of them.
///
/// Runs every case that the options leave open and prints its errors beside the paper's. Predictions are judged by the paper's measures,
/// which are not mean squares: the Frobenius norm of the errors over the number of comparisons, averaged over 100 starts. Pendulums are
/// chaotic: the errors of exact physics in single precision are printed beside. With -o also writes a page with pictures.
///
/// The models that the paper compares with (HNN, LNN and MLP, and light ones of about ModLaNet's size) are trained by their authors'
/// recipes: Adam with 10,000 epochs for pendulums, 3,000 for bodies, which would take hours for some. A row is marked if its training ran
/// out of time or diverged.
///
/// Example: leastaction-papers modlanet --case double-pendulum --json
#[derive(Args)]
pub struct Modlanet {
    /// Only this experiment.
    #[arg(long)]
    case: Option<Case>,
    /// A data set in the layout of the ModLaNet authors (x, v, ac, test_x, …) instead of a generated one, of two pendulums or
    /// three bodies; needs --case.
    #[arg(long, value_name = "FILE", requires = "case")]
    data: Option<PathBuf>,
    /// Input of the bodies' pair potential, from two positions.
    #[arg(long, default_value = "inverse-distance")]
    pair: Pair,
    /// Maximum number of Levenberg-Marquardt iterations; by default as many as the case needs, or 60 with --quick.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    iterations: Option<u32>,
    /// Largest number of samples in dataset-size: 1,000,000, or 40,000 with --quick.
    #[arg(long, value_parser = clap::value_parser!(u32).range(10_000..))]
    samples: Option<u32>,
    /// Number of starts of the predictions: 100, or 10 with --quick; 0 for none.
    #[arg(long)]
    starts: Option<u32>,
    #[command(flatten)]
    compared: Compared,
    #[command(flatten)]
    selection: Selection,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Pair {
    /// Reciprocal of the distance: 1/|a - b|.
    InverseDistance,
    /// Distance: |a - b|.
    Distance,
    /// Difference: a - b.
    Difference,
    /// Both positions (the authors' choice).
    Concat,
}

impl Modlanet {
    /// Learns and prints.
    pub fn run(self, output: Output) -> Done {
        let seeds = self.selection.seeds as usize;
        let data = self.data_set()?;
        let baselines = (self.baselines(), self.compared.limits(self.selection.quick));
        let tasks =
            tasks(&cases(self.case), &self.options(), baselines, seeds, data.as_ref(), &self.arguments());
        self.selection.run(&MODLANET, tasks, output)
    }

    /// Data of the file, if one is given and belongs to the case's system.
    fn data_set(&self) -> Result<Option<ModlanetData>, Failure> {
        let (Some(file), Some(case)) = (&self.data, self.case) else { return Ok(None) };
        let refused = |reason: &str| Failure::Input(format!("{}: {reason}", file.display()));
        let system =
            case.system().ok_or_else(|| refused("this case generates its data; leave out --data"))?;
        let set = modlanet::read(file).map_err(|error| Failure::Input(error.to_string()))?;
        let (found, needed) = (set.train.q.width(), system.coordinates());
        if found != needed {
            return Err(refused(&format!("the data has {found} coordinates, the case needs {needed}")));
        }
        Ok(Some(ModlanetData { file: file.display().to_string(), set: set.into() }))
    }

    fn options(&self) -> Options {
        let seed = self.selection.seed;
        let usual = if self.selection.quick { Options::quick(seed) } else { Options::new(seed) };
        Options {
            pair: match self.pair {
                Pair::InverseDistance => PairInput::InverseDistance,
                Pair::Distance => PairInput::Distance,
                Pair::Difference => PairInput::Difference,
                Pair::Concat => PairInput::Concat,
            },
            iterations: self.iterations.map(|iterations| iterations as usize).or(usual.iterations),
            most_samples: number_or(self.samples, usual.most_samples),
            starts: number_or(self.starts, usual.starts),
            ..usual
        }
    }

    /// Models to compare with; only the light ones with --quick.
    fn baselines(&self) -> &'static [Baseline] {
        match (self.compared.are_wanted(self.case.is_none()), self.selection.quick) {
            (false, _) => &[],
            (true, true) => &Baseline::LIGHT,
            (true, false) => &Baseline::ALL,
        }
    }

    /// Command-line options other than case and seed.
    fn arguments(&self) -> String {
        let pair = self.pair.to_possible_value().filter(|_| self.pair != Pair::InverseDistance);
        [
            given("data", self.data.as_ref().map(|file| file.display())),
            given("pair", pair.as_ref().map(PossibleValue::get_name)),
            given("iterations", self.iterations),
            given("samples", self.samples),
            given("starts", self.starts),
            self.compared.arguments(),
            self.selection.arguments(),
        ]
        .concat()
    }
}
