//! The scenarios of the firmware loop.

use super::adapting::Adaptive;
use super::follow::{PlanArgs, Planned, planned};
use super::gravity::{Floats, OnAnother, floating};
use super::mpc::{MpcArgs, deciding, deciding_on};
use super::plant::{Plant, Predicting, no_graphs, on_plant};
use super::recorded::Recorded;
use super::remote::Target;
use super::track::Following;
use super::world::World;
use super::{Report, Trace, TrackArgs};
use clap::ValueEnum;
use leastaction::cli::{Failure, Output};
use leastaction::models::{chip_file, meant};
use leastaction_core::energy::trigonometric::{ACROBOT, CARTPOLE, PENDULUM};
use leastaction_core::plan::PlanFile;
use leastaction_firmware_sim::control::{Controller, Trajectory};
use leastaction_firmware_sim::observer::OtherStep;
use leastaction_firmware_sim::scenario::{
    GravityConfig, MpcConfig, Predict, Setup, SwingUpConfig, TrackConfig, predict, run_on,
};
use leastaction_firmware_sim::{
    self as firmware_sim, Firmware, InPlace, Program, SetupError, Summary, Tick, Timeline,
};
use leastaction_ground_truth::Mechanism;
use leastaction_models::Model;
use leastaction_replica::{OfSize, Replica, SystemOf};
use serde::Serialize;
use std::fmt;
use std::path::Path;

/// Scenario of the loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scenario {
    /// Step the model beside the mechanism under the same force, without feedback.
    Predict,
    /// Follow a reference by inverse dynamics and feedback, every coordinate actuated.
    Track,
    /// Float, held by the model's gravity alone, and be pushed.
    Gravity,
    /// Swing the pole up and hold it (pendulum, cartpole).
    SwingUp,
    /// Follow a plan, and hold its end.
    Follow,
    /// Decide at every tick how to come to a goal, and hold it there.
    Mpc,
}

impl fmt::Display for Scenario {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Predict => "predict",
            Self::Track => "track",
            Self::Gravity => "gravity",
            Self::SwingUp => "swing-up",
            Self::Follow => "follow",
            Self::Mpc => "mpc",
        })
    }
}

/// A run in the loop.
#[derive(Clone, Copy)]
pub struct Request<'a> {
    /// The model.
    pub model: &'a Model,
    /// Plant that the loop acts on.
    pub plant: Plant<'a>,
    /// Scenario.
    pub scenario: Scenario,
    /// Seed of all noise.
    pub seed: u64,
    /// Length of the run, s.
    pub seconds: Option<f32>,
    /// Time between ticks, s.
    pub tick: Option<f32>,
    /// Friction and devices.
    pub world: &'a World,
    /// Options for following a motion.
    pub motion: &'a TrackArgs,
    /// Options for floating.
    pub floats: &'a Floats,
    /// Options for plans.
    pub follows: &'a PlanArgs,
    /// Options for decisions at every tick.
    pub decides: &'a MpcArgs,
    /// The plans to follow or to choose from, which were made for the model.
    pub plans: &'a [PlanFile<'a>],
    /// The configuration whose `[data]` says how to read a motion's log.
    pub config: Option<&'a Path>,
    /// Processor that runs the controller; `None`: this machine.
    pub on: Option<&'a Target>,
    /// Model whose numbers follow the mechanism; `None`: they stay those of the file.
    pub adaptive: Option<&'a Adaptive<'a>>,
}

impl Request<'_> {
    /// Overrides the scenario's setup with the options. The firmware steps the model with the order that it was trained
    /// with. Prints a warning if the tick is not the model's step.
    ///
    /// # Errors
    /// [`Failure`] if the options of the devices do not fit.
    pub(super) fn adapt<const N: usize>(&self, setup: &mut Setup<N>) -> Result<(), Failure> {
        setup.seed = self.seed;
        setup.seconds = self.seconds.unwrap_or(setup.seconds);
        setup.tick = self.tick.unwrap_or(setup.tick);
        let order = self.model.facts.trained_step.map(|step| step.order);
        setup.observer.order = order.unwrap_or(setup.observer.order);
        self.world.adapt(setup, (self.plant, self.model))?;
        setup.observer.other_step = OtherStep::Accepted;
        if let Err(other) = setup.observer.require_step(setup.tick, self.model.facts.trained_step) {
            Output::default().note(&format!("warning: the model is less accurate than it could be: {other}"));
        }
        Ok(())
    }
}

/// Runs the loop and records its trace.
pub fn run(request: &Request, trace: &mut Trace) -> Result<Report, Failure> {
    let of_controllers = [("--on", request.on.is_some()), ("--adapt", request.adaptive.is_some())];
    if let (Scenario::Predict, Some((option, _))) =
        (request.scenario, of_controllers.iter().find(|(_, is_given)| *is_given))
    {
        return Err(Failure::Input(format!(
            "predict has no controller; leave out {option}, or take track or swing-up"
        )));
    }
    request.world.check(request)?;
    let is_followed = request.scenario == Scenario::Track && matches!(request.plant, Plant::Model { .. });
    request.motion.check(is_followed, request.config)?;
    request.floats.check(request.scenario)?;
    let file = chip_file(request.model).map_err(Failure::Input)?;
    let model = meant(&file, request.model).map_err(Failure::Input)?;
    match (request.plant, request.scenario) {
        (Plant::Exact(mechanism), _) => beside_exact(request, &model, mechanism, trace),
        (Plant::Model { model: plant, .. }, Scenario::Predict) => {
            on_plant(request, &model, plant, (Predicting, trace))
        }
        (Plant::Model { model: plant, .. }, Scenario::Track) => {
            on_plant(request, &model, plant, (Following, trace))
        }
        (Plant::Model { model: plant, .. }, Scenario::Gravity) => {
            on_plant(request, &model, plant, (OnAnother, trace))
        }
        (Plant::Model { model: plant, .. }, Scenario::Follow) => {
            on_plant(request, &model, plant, (Planned, trace))
        }
        (Plant::Model { model: plant, .. }, Scenario::Mpc) => deciding_on(request, &model, plant, trace),
        (Plant::Model { .. }, scenario) => Err(Failure::Input(format!(
            "{scenario} knows what to do with the exact mechanisms alone; leave out --plant, or take another scenario"
        ))),
    }
}

fn beside_exact(
    request: &Request,
    model: &Replica,
    mechanism: Mechanism,
    trace: &mut Trace,
) -> Result<Report, Failure> {
    let (found, needed) = (model.n(), mechanism.coordinates().len());
    if found != needed {
        let system = mechanism.name();
        return Err(Failure::Input(format!(
            "the model has {found} coordinates, the {system} has {needed}; choose another --system"
        )));
    }
    match mechanism {
        Mechanism::Pendulum => pendulum(request, model.of_size().ok_or_else(no_graphs)?, trace),
        Mechanism::Cartpole | Mechanism::Acrobot => {
            two_coordinates(request, mechanism, model.of_size().ok_or_else(no_graphs)?, trace)
        }
    }
}

fn pendulum(request: &Request, model: &SystemOf<1>, trace: &mut Trace) -> Result<Report, Failure> {
    let waves = request.world.changes.waves(Mechanism::Pendulum, &PENDULUM)?;
    let systems = request.world.systems(&waves)?;
    let systems = systems.each();
    let plant = systems.timeline();
    match request.scenario {
        Scenario::Predict => {
            let mut config = Predict::<1>::pendulum();
            request.adapt(&mut config.setup)?;
            reported(request, predict(plant.at(0.0), model, &config, |tick| trace.push(tick)))
        }
        Scenario::Track => {
            let mut config = TrackConfig::<1>::pendulum();
            request.adapt(&mut config.setup)?;
            following(request, (plant, model), &config, trace)
        }
        Scenario::Gravity => floating(request, (plant, model), GravityConfig::<1>::pendulum(), trace),
        Scenario::Follow => planned(request, (plant, model), trace),
        Scenario::Mpc => deciding::<_, _, 1, 2>(request, (plant, model), MpcConfig::<1>::pendulum(), trace),
        Scenario::SwingUp => {
            let mut config = SwingUpConfig::<1>::pendulum();
            request.adapt(&mut config.setup)?;
            let program = config.program();
            closed_loop(
                request,
                (plant, model),
                (&config.setup, [0.0]),
                (&program, program.start(model)),
                |tick| trace.push(tick),
            )
        }
    }
}

fn two_coordinates(
    request: &Request,
    mechanism: Mechanism,
    model: &SystemOf<2>,
    trace: &mut Trace,
) -> Result<Report, Failure> {
    let acrobot = mechanism == Mechanism::Acrobot;
    let lagrangian = if acrobot { ACROBOT } else { CARTPOLE };
    let waves = request.world.changes.waves(mechanism, &lagrangian)?;
    let systems = request.world.systems(&waves)?;
    let systems = systems.each();
    let plant = systems.timeline();
    match (request.scenario, acrobot) {
        (Scenario::Predict, _) => {
            let mut config = if acrobot { Predict::<2>::acrobot() } else { Predict::<2>::cartpole() };
            request.adapt(&mut config.setup)?;
            reported(request, predict(plant.at(0.0), model, &config, |tick| trace.push(tick)))
        }
        (Scenario::Track, _) => {
            let mut config = if acrobot { TrackConfig::<2>::acrobot() } else { TrackConfig::<2>::cartpole() };
            request.adapt(&mut config.setup)?;
            following(request, (plant, model), &config, trace)
        }
        (Scenario::Gravity, _) => {
            let config = if acrobot { GravityConfig::<2>::acrobot() } else { GravityConfig::<2>::cartpole() };
            floating(request, (plant, model), config, trace)
        }
        (Scenario::Follow, _) => planned(request, (plant, model), trace),
        (Scenario::SwingUp, false) => {
            let mut config = SwingUpConfig::<2>::cartpole();
            request.adapt(&mut config.setup)?;
            let program = config.program();
            closed_loop(
                request,
                (plant, model),
                (&config.setup, [0.0; 2]),
                (&program, program.start(model)),
                |tick| trace.push(tick),
            )
        }
        (Scenario::Mpc, false) => {
            deciding::<_, _, 2, 4>(request, (plant, model), MpcConfig::<2>::cartpole(), trace)
        }
        (Scenario::Mpc, true) => {
            deciding::<_, _, 2, 4>(request, (plant, model), MpcConfig::<2>::acrobot(), trace)
        }
        (Scenario::SwingUp, true) => {
            Err(Failure::Input("no pump swings up the acrobot; take mpc, or follow a plan".to_owned()))
        }
    }
}

/// Runs the loop along a trajectory.
pub(super) fn following<P, M, T, const N: usize>(
    request: &Request,
    (plant, model): (Timeline<P>, &M),
    config: &TrackConfig<N, T>,
    trace: &mut Trace,
) -> Result<Report, Failure>
where
    P: firmware_sim::Mechanism<N>,
    M: firmware_sim::Mechanism<N>,
    T: Trajectory<N>,
{
    config.validate().map_err(misused)?;
    let program = config.program();
    let firmware = (&program, program.follow(model));
    closed_loop(request, (plant, model), (&config.setup, &config.reference), firmware, |tick| {
        trace.push(tick)
    })
}

/// Runs a program on this machine, for which `firmware` is given, or on the requested processor.
pub(super) fn closed_loop<P, M, C, const N: usize>(
    request: &Request,
    (plant, model): (Timeline<P>, &M),
    (setup, trajectory): (&Setup<N>, impl Trajectory<N>),
    (program, firmware): (&Program<N>, Result<Firmware<C, N>, SetupError>),
    sink: impl FnMut(&Tick<N>),
) -> Result<Report, Failure>
where
    P: firmware_sim::Mechanism<N>,
    M: firmware_sim::Mechanism<N>,
    C: Controller<N>,
{
    setup.validate().map_err(misused)?;
    let firmware = firmware.map_err(misused)?;
    match (request.adaptive, request.on) {
        (Some(adaptive), on) => {
            let run = |recorded: &mut Recorded<C, N>| run_on(plant, recorded, setup, trajectory, sink);
            let ran = adaptive.run((program, firmware), on, run)?;
            let mut report = Report::new(request, &ran.summary);
            if let Some(target) = on {
                report.on_processor(target.board.name(), &ran.instructions);
            }
            report.adapted = adaptive.report();
            Ok(report)
        }
        (None, None) => {
            let summary = run_on(plant, InPlace { model, firmware }, setup, trajectory, sink);
            reported(request, summary.map_err(SetupError::from))
        }
        (None, Some(target)) => target.run(request, plant, (setup, trajectory), program, sink),
    }
}

pub(super) fn reported<const N: usize>(
    request: &Request,
    summary: Result<Summary<N>, SetupError>,
) -> Result<Report, Failure> {
    Ok(Report::new(request, &summary.map_err(misused)?))
}

/// The failure for a configuration that cannot be run.
pub(super) fn misused(error: SetupError) -> Failure {
    match error {
        SetupError::SingularInertia | SetupError::NotStabilisable | SetupError::NoSwingUp => {
            Failure::Work(error.to_string())
        }
        _ => Failure::Input(error.to_string()),
    }
}
