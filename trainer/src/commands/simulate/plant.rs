//! The plant of the loop: an exact mechanism, or the mechanism that another model file describes.

use super::over_time::OverTime;
use super::scenario::{misused, reported};
use super::{Report, Request, Trace};
use leastaction::cli::Failure;
use leastaction::models::{chip_file, meant};
use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_core::model::{CoordinateRange, Interval};
use leastaction_firmware_sim::devices::{Devices, Drive, EncoderConfig};
use leastaction_firmware_sim::observer::ObserverConfig;
use leastaction_firmware_sim::scenario::{Excitation, Predict, Push, Setup, Start, predict};
use leastaction_firmware_sim::{Goal, Timeline};
use leastaction_ground_truth::Mechanism;
use leastaction_models::Model;
use leastaction_replica::{OfSize, ParticleSystem, Replica, SystemOf, Visitor};
use std::path::Path;

/// The plant.
#[derive(Clone, Copy)]
pub enum Plant<'a> {
    /// A mechanism with exactly known motion.
    Exact(Mechanism),
    /// The mechanism of a model file.
    Model {
        /// The file.
        file: &'a Path,
        /// Model in the file.
        model: &'a Model,
    },
}

impl Plant<'_> {
    /// Name of the plant.
    pub fn name(&self) -> String {
        match self {
            Self::Exact(mechanism) => mechanism.name().to_owned(),
            Self::Model { file, .. } => file.display().to_string(),
        }
    }

    /// Kinds of the coordinates.
    pub fn coordinates(&self) -> Vec<Coordinate> {
        match self {
            Self::Exact(mechanism) => mechanism.coordinates().to_vec(),
            Self::Model { model, .. } => {
                model.architecture.coordinates().chars().filter_map(Coordinate::from_letter).collect()
            }
        }
    }

    /// Names of the coordinates.
    pub fn labels(&self) -> Vec<String> {
        let labels: &[&str] = match self {
            Self::Exact(Mechanism::Pendulum) => &["θ"],
            Self::Exact(Mechanism::Cartpole) => &["x", "θ"],
            Self::Exact(Mechanism::Acrobot) => &["θ1", "θ2"],
            Self::Model { model, .. } => {
                return (1..=model.architecture.n()).map(|i| format!("q{i}")).collect();
            }
        };
        labels.iter().map(|label| (*label).to_owned()).collect()
    }
}

/// A plant as a function of time, and a model.
pub type Systems<'s, const N: usize> = (Timeline<'s, SystemOf<'s, N>>, &'s SystemOf<'s, N>);

/// A task on a model and the plant of another file, generic in the number of coordinates.
pub trait OnPlant {
    /// Runs the task.
    ///
    /// # Errors
    /// [`Failure`] if options do not fit, or if the loop refuses them.
    fn run<const N: usize>(
        self,
        request: &Request,
        systems: Systems<N>,
        trace: &mut Trace,
    ) -> Result<Report, Failure>;
}

/// Runs a task on a model and the plant of another file with the same coordinates.
pub fn on_plant(
    request: &Request,
    model: &Replica,
    plant: &Model,
    (what, trace): (impl OnPlant, &mut Trace),
) -> Result<Report, Failure> {
    of_plant(request, plant, |plants| model.visit(OfAnySize { request, plants, what, trace }))
}

/// Passes the chip's form of a plant as a function of time to `run`, if it has the coordinates of the model.
pub(super) fn of_plant<T>(
    request: &Request,
    plant: &Model,
    run: impl FnOnce(&OverTime<Replica>) -> Result<T, Failure>,
) -> Result<T, Failure> {
    let [own, others] = [request.model, plant].map(|model| model.architecture.coordinates());
    if own != others {
        let message = format!("--plant has coordinates {others:?}, the model {own:?}: they must be the same");
        return Err(Failure::Input(message));
    }
    let models = request.world.changes.models(plant)?;
    let files = models.map(|model| chip_file(model).map_err(Failure::Input))?;
    run(&files.map(|file| meant(file, plant).map_err(Failure::Input))?)
}

/// Dispatches a task by the number of coordinates.
struct OfAnySize<'r, 'c, W> {
    request: &'r Request<'r>,
    plants: &'r OverTime<Replica<'c>>,
    what: W,
    trace: &'r mut Trace,
}

impl<'c, W: OnPlant> Visitor<'c> for OfAnySize<'_, '_, W> {
    type Output = Result<Report, Failure>;

    fn coordinates<const N: usize>(self, model: &'c SystemOf<'c, N>) -> Self::Output
    where
        for<'f> Replica<'f>: OfSize<N>,
    {
        let Self { request, plants, what, trace } = self;
        let plants = plants.map(|plant| OfSize::<N>::of_size(plant).ok_or_else(no_graphs))?;
        what.run(request, (plants.timeline(), model), trace)
    }

    fn particles<const D: usize>(self, _: &'c ParticleSystem<'c, D>) -> Self::Output {
        Err(no_graphs())
    }
}

/// The failure for graphs: the loop only steps generalised coordinates.
pub fn no_graphs() -> Failure {
    Failure::Input("the scenarios take inertia networks and trees, no graphs".to_owned())
}

/// Task of stepping a model beside the plant under the same force.
pub struct Predicting;

impl OnPlant for Predicting {
    fn run<const N: usize>(
        self,
        request: &Request,
        (plant, model): Systems<N>,
        trace: &mut Trace,
    ) -> Result<Report, Failure> {
        let config = prediction(request)?;
        reported(request, predict(plant.at(0.0), model, &config, |tick| trace.push(tick)))
    }
}

/// The default encoders for the plant's coordinates.
pub fn encoders<const N: usize>(request: &Request) -> [EncoderConfig; N] {
    let kinds = request.plant.coordinates();
    std::array::from_fn(|i| match kinds.get(i) {
        Some(Coordinate::Angle) => EncoderConfig::rotary(),
        _ => EncoderConfig::linear(),
    })
}

/// The default prediction: 5 s at the model's own step, with errors up to 0.01 rad or m allowed. It starts in the
/// middle half of the training data's range, at up to half the largest speeds, under half the largest forces at 0.5 Hz.
/// If the file does not give the range, it starts within 0.5 rad or m at up to 0.5 rad/s or m/s, without force.
fn prediction<const N: usize>(request: &Request) -> Result<Predict<N>, Failure> {
    let facts = &request.model.facts;
    let ranges: [CoordinateRange; N] =
        std::array::from_fn(|i| facts.range.get(i).copied().unwrap_or(UNKNOWN));
    let half = |x: Interval| 0.5 * x.least.abs().max(x.most.abs());
    let amplitude = ranges.map(|range| half(range.u));
    let mut setup = Setup {
        seed: request.seed,
        tick: facts.trained_step.map_or(0.01, |step| step.h),
        seconds: 5.0,
        substeps: 8,
        start: Start {
            q: ranges.map(|range| 0.5 * (range.q.least + range.q.most)),
            q_spread: ranges.map(|range| 0.25 * (range.q.most - range.q.least)),
            v_spread: ranges.map(|range| half(range.v)),
        },
        devices: Devices::new(encoders(request), amplitude),
        push: Push::none(),
        brakes: false,
        known_drive: Drive::ideal(),
        observer: ObserverConfig::new(),
        goal: Goal { tolerance: [0.01; N], hold: f32::INFINITY, bounds: [f32::INFINITY; N] },
    };
    request.adapt(&mut setup)?;
    setup.validate().map_err(misused)?;
    Ok(Predict { setup, excitation: Excitation { amplitude, frequency: [0.5; N] } })
}

/// Range that is assumed if the file does not give one.
const UNKNOWN: CoordinateRange = CoordinateRange {
    q: Interval { least: -1.0, most: 1.0 },
    v: Interval { least: -1.0, most: 1.0 },
    u: Interval { least: 0.0, most: 0.0 },
    period: 0.0,
};
