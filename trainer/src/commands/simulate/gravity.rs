//! The scenario `gravity`: floating, held by the model's gravity alone, and a push.

use super::plant::{OnPlant, Systems, encoders};
use super::reference::strongest;
use super::scenario::closed_loop;
use super::track::{MEMORY, samples};
use super::world::replace;
use super::{Report, Request, Scenario, Trace};
use clap::Args;
use leastaction::cli::Failure;
use leastaction::cli::arguments::{finite, not_negative};
use leastaction_firmware_sim::scenario::{Floating, GravityConfig, Setup};
use leastaction_firmware_sim::{Mechanism, Timeline};
use serde::Serialize;

/// Options for floating and the push.
#[derive(Args, Default)]
#[command(next_help_heading = "Floating (gravity)")]
pub struct Floats {
    /// Start position, rad or m, one value per coordinate or one for all, also for follow and mpc [default: that of the plan; the middle of the
    /// training data, else 0].
    #[arg(long, value_name = "Q,…", value_delimiter = ',', allow_negative_numbers = true, value_parser = finite)]
    at: Vec<f64>,
    /// Largest force of the push from 2.0 to 2.2 s, N m or N, one value per coordinate or one for all [default: a tenth of the limits].
    #[arg(long, value_name = "F,…", value_delimiter = ',', allow_negative_numbers = true, value_parser = not_negative)]
    push: Vec<f64>,
    /// Drag added by the firmware, as deceleration per speed, 1/s; with 0 only friction acts [default: 1].
    #[arg(long, value_name = "D", allow_negative_numbers = true, value_parser = not_negative)]
    drag: Option<f64>,
}

impl Floats {
    /// Refuses these options for other scenarios; following a plan and deciding know the start.
    pub fn check(&self, scenario: Scenario) -> Result<(), Failure> {
        let pushed = !self.push.is_empty() || self.drag.is_some();
        match scenario {
            Scenario::Gravity => Ok(()),
            Scenario::Follow | Scenario::Mpc if !pushed => Ok(()),
            _ if !pushed && self.at.is_empty() => Ok(()),
            _ => Err(Failure::Input(
                "--at is of --scenario gravity, follow and mpc, --push and --drag are of gravity".to_owned(),
            )),
        }
    }

    /// Overrides the start of a scenario.
    pub(super) fn start_at<const N: usize>(&self, setup: &mut Setup<N>) -> Result<(), Failure> {
        replace("--at", &self.at, &mut setup.start.q)
    }

    /// Overrides the scenario's settings with those of the command line.
    fn adapt<const N: usize>(&self, config: &mut GravityConfig<N>) -> Result<(), Failure> {
        let setup = &mut config.setup;
        self.start_at(setup)?;
        replace("--push", &self.push, &mut setup.push.most)?;
        config.drag = self.drag.map_or(config.drag, |drag| drag as f32);
        Ok(())
    }
}

/// Result of floating.
#[derive(Clone, Debug, Serialize)]
pub struct FloatingReport {
    /// Mean velocity before the push, rad/s or m/s.
    pub drift: Vec<f32>,
    /// Largest distance from the position of the push, rad or m.
    pub peak: Vec<f32>,
    /// Time from the end of the push to rest, s.
    pub rest_after: Option<f32>,
}

/// Runs the loop, here or on a board.
pub(super) fn floating<P: Mechanism<N>, M: Mechanism<N>, const N: usize>(
    request: &Request,
    (plant, model): (Timeline<P>, &M),
    mut config: GravityConfig<N>,
    trace: &mut Trace,
) -> Result<Report, Failure> {
    request.adapt(&mut config.setup)?;
    request.floats.adapt(&mut config)?;
    let (program, mut floating) = (config.program(), Floating::new(&config.setup));
    let firmware = (&program, program.follow(model));
    let mut report =
        closed_loop(request, (plant, model), (&config.setup, config.setup.start.q), firmware, |tick| {
            floating.update(tick);
            trace.push(tick);
        })?;
    report.success &= floating.rests();
    let Floating { drift, peak, rest_after, .. } = floating;
    report.floating = Some(FloatingReport { drift: drift.to_vec(), peak: peak.to_vec(), rest_after });
    Ok(report)
}

/// Task of floating on the plant of another model file.
pub struct OnAnother;

impl OnPlant for OnAnother {
    fn run<const N: usize>(
        self,
        request: &Request,
        systems: Systems<N>,
        trace: &mut Trace,
    ) -> Result<Report, Failure> {
        floating(request, systems, config(request)?, trace)
    }
}

/// The default configuration: starts in the middle of the training data, at 1,000 ticks per second.
fn config<const N: usize>(request: &Request) -> Result<GravityConfig<N>, Failure> {
    let range = &request.model.facts.range;
    let limit = request.world.limit()?.or_else(|| strongest(range)).ok_or_else(|| {
        let reason =
            "the model's file does not say what forces its training data had; name the largest with --limit";
        Failure::Input(reason.to_owned())
    })?;
    let middle =
        std::array::from_fn(|i| range.get(i).map_or(0.0, |range| 0.5 * (range.q.least + range.q.most)));
    let mut config = GravityConfig::new(encoders(request), limit, (middle, limit.map(|limit| 0.1 * limit)));
    config.setup.tick = request.tick.unwrap_or(1e-3);
    config.setup.observer.memory = samples(MEMORY, config.setup.tick);
    Ok(config)
}
