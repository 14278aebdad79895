//! The scenario `mpc`: to a goal by a decision at every tick.

use super::follow::{drive, sized};
use super::over_time::OverTime;
use super::plant::{encoders, no_graphs, of_plant};
use super::scenario::closed_loop;
use super::world::{for_all, replace};
use super::{Report, Request, Scenario, Trace};
use clap::Args;
use leastaction::cli::Failure;
use leastaction::cli::arguments::finite;
use leastaction_firmware_sim::control::{Coordinates, States, blank_nodes};
use leastaction_firmware_sim::scenario::{Decided, MpcConfig};
use leastaction_firmware_sim::{Mechanism, Timeline};
use leastaction_models::Model;
use leastaction_replica::{OfSize, Replica, StateVisitor, SystemOf};
use serde::Serialize;

/// Options for decisions at every tick.
#[derive(Args, Default)]
#[command(next_help_heading = "Deciding (mpc)")]
pub struct MpcArgs {
    /// Goal posture, rad or m, one value per coordinate or one for all [default: the first plan's end; upright].
    #[arg(long, value_name = "Q,…", value_delimiter = ',', allow_negative_numbers = true, value_parser = finite)]
    goal: Vec<f64>,
}

impl MpcArgs {
    /// Refuses these options for other scenarios.
    pub fn check(&self, scenario: Scenario) -> Result<(), Failure> {
        if scenario == Scenario::Mpc || self.goal.is_empty() {
            return Ok(());
        }
        Err(Failure::Input("--goal is of --scenario mpc".to_owned()))
    }
}

/// Ways in which the commands of a run were found, in numbers of ticks.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct DecidedReport {
    /// Decisions.
    pub decided: u32,
    /// Commands of the last motion, where no motion could be computed.
    pub followed: u32,
    /// Commands against gravity, where there was no last motion either.
    pub floated: u32,
}

/// Runs the loop, here or on a board, from a configuration that the options change; D is 2N. A model that learned its own step is stepped
/// by it alone.
pub(super) fn deciding<P: Mechanism<N>, M: Mechanism<N>, const N: usize, const D: usize>(
    request: &Request,
    (plant, model): (Timeline<P>, &M),
    mut config: MpcConfig<N>,
    trace: &mut Trace,
) -> Result<Report, Failure>
where
    Coordinates<N>: States<D>,
{
    let plans = sized(request.plans)?;
    if let Some(plan) = plans.first() {
        config = config.with_plans(plan, drive(request, plan.file().header().h)?);
    }
    let trained = request.model.facts.trained_step;
    config = match request.tick {
        Some(tick) => config.with_tick(tick),
        None if plans.is_empty() => config.with_trained(trained),
        None => config,
    };
    if trained.is_some() {
        config.settings.stride = 1;
    }
    replace("--goal", &request.decides.goal, &mut config.settings.goal)?;
    request.adapt(&mut config.setup)?;
    request.floats.start_at(&mut config.setup)?;
    request.follows.adapt(&mut config.setup)?;
    let (program, mut decided) = (config.program(), Decided::default());
    let mut nodes = blank_nodes();
    let firmware = (&program, program.mpc(model, &plans, &mut nodes));
    let goal = (&config.setup, config.settings.goal);
    let mut report = closed_loop(request, (plant, model), goal, firmware, |tick| {
        decided.update(tick);
        trace.push(tick);
    })?;
    let Decided { decided, followed, floated } = decided;
    report.decided = Some(DecidedReport { decided, followed, floated });
    Ok(report)
}

/// Runs the loop on the plant of another model file with the same coordinates.
pub(super) fn deciding_on(
    request: &Request,
    model: &Replica,
    plant: &Model,
    trace: &mut Trace,
) -> Result<Report, Failure> {
    of_plant(request, plant, |plants| model.visit_states(OnPlant { request, plants, trace }))
}

/// Decisions whose sizes become types.
struct OnPlant<'r, 'c> {
    request: &'r Request<'r>,
    plants: &'r OverTime<Replica<'c>>,
    trace: &'r mut Trace,
}

impl<'c> StateVisitor<'c> for OnPlant<'_, '_> {
    type Output = Result<Report, Failure>;

    fn states<const N: usize, const D: usize>(self, model: &'c SystemOf<'c, N>) -> Self::Output
    where
        for<'f> Replica<'f>: OfSize<N>,
        Coordinates<N>: States<D>,
    {
        let Self { request, plants, trace } = self;
        let plants = plants.map(|plant| OfSize::<N>::of_size(plant).ok_or_else(no_graphs))?;
        let limit = request.world.limit()?;
        let Some(limit) = limit.or_else(|| (!request.plans.is_empty()).then_some([0.0; N])) else {
            let reason = "mpc needs the drives' limits: name them with --limit, 0 for a coordinate without a drive, or \
                          a --plan for the model";
            return Err(Failure::Input(reason.to_owned()));
        };
        if request.decides.goal.is_empty() && request.plans.is_empty() {
            let reason = "mpc needs a goal: name a posture with --goal, or a --plan that ends there";
            return Err(Failure::Input(reason.to_owned()));
        }
        let start = sized(request.plans)?.first().map_or([0.0; N], |plan| plan.reference(0).q);
        let goal = for_all("--goal", &request.decides.goal, 0.0)?;
        deciding(
            request,
            (plants.timeline(), model),
            MpcConfig::new(start, goal, encoders(request), limit),
            trace,
        )
    }

    fn graph(self) -> Self::Output {
        Err(no_graphs())
    }
}
