//! The scenario `mpc`: upright by a decision at every tick.

use super::scenario::closed_loop;
use super::{Report, Request, Trace};
use leastaction::cli::Failure;
use leastaction_firmware_sim::Mechanism;
use leastaction_firmware_sim::control::{Coordinates, States, blank_nodes};
use leastaction_firmware_sim::scenario::{Decided, MpcConfig};
use serde::Serialize;

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

/// Runs the loop, here or on a board; D is 2N. A model that learned its own step is stepped by it alone.
pub(super) fn deciding<P: Mechanism<N>, M: Mechanism<N>, const N: usize, const D: usize>(
    request: &Request,
    (plant, model): (&P, &M),
    config: MpcConfig<N>,
    trace: &mut Trace,
) -> Result<Report, Failure>
where
    Coordinates<N>: States<D>,
{
    let trained = request.model.facts.trained_step.map(|step| step.h);
    let mut config = config.with_tick(request.tick.or(trained).unwrap_or(config.setup.tick));
    if trained.is_some() {
        config.settings.stride = 1;
    }
    request.adapt(&mut config.setup)?;
    let (program, mut decided) = (config.program(), Decided::default());
    let mut nodes = blank_nodes();
    let firmware = (&program, program.mpc(model, None, &mut nodes));
    let goal = (&config.setup, config.settings.goal);
    let mut report = closed_loop(request, plant, goal, firmware, |tick| {
        decided.update(tick);
        trace.push(tick);
    })?;
    let Decided { decided, followed, floated } = decided;
    report.decided = Some(DecidedReport { decided, followed, floated });
    Ok(report)
}
