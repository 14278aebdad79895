//! The scenario `follow`: the firmware follows a plan.

use super::plant::{OnPlant, Systems, encoders};
use super::scenario::{closed_loop, misused};
use super::track::{MEMORY, samples};
use super::world::{known_actuator, replace};
use super::{Report, Request, Scenario, Trace};
use clap::Args;
use leastaction::cli::Failure;
use leastaction::cli::arguments::{not_negative, positive};
use leastaction_core::model::fingerprint;
use leastaction_core::plan::{Plan, PlanFile};
use leastaction_firmware_sim::control::MAX_PLANS;
use leastaction_firmware_sim::devices::Drive;
use leastaction_firmware_sim::scenario::{FollowConfig, Followed, Setup};
use leastaction_firmware_sim::{Mechanism, SetupError, Timeline};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Options for plans.
#[derive(Args, Default)]
#[command(next_help_heading = "Plans (follow, mpc)")]
pub struct PlanArgs {
    /// The plan, which `leastaction plan` made for this model; mpc chooses from several, each after a --plan of its own.
    #[arg(long, value_name = "PLAN")]
    pub(super) plan: Vec<PathBuf>,
    /// Spread of the start, rad or m, one value per coordinate or one for all [default: 0.02; mpc: that of the mechanism].
    #[arg(long, value_name = "Q,…", value_delimiter = ',', allow_negative_numbers = true, value_parser = not_negative)]
    spread: Vec<f64>,
    /// Largest error at the end, rad or m, one value per coordinate or one for all [default: 0.1].
    #[arg(long, value_name = "Q,…", value_delimiter = ',', allow_negative_numbers = true, value_parser = positive)]
    tolerance: Vec<f64>,
}

impl PlanArgs {
    /// Arguments for the plan of a file.
    pub fn along(plan: PathBuf) -> Self {
        Self { plan: vec![plan], ..Self::default() }
    }

    /// Refuses these options for scenarios that have no use for them, and a number of plans that the scenario does not take.
    pub fn check(&self, scenario: Scenario) -> Result<(), Failure> {
        let given = !self.plan.is_empty() || !self.spread.is_empty() || !self.tolerance.is_empty();
        let reason = match (scenario, self.plan.len()) {
            (Scenario::Follow, 0) => {
                "follow needs a plan for the model, as `leastaction plan` makes it: name its file with --plan"
                    .to_owned()
            }
            (Scenario::Follow, 2..) => "follow takes one plan; name one, or take mpc".to_owned(),
            (Scenario::Mpc, found) if found > MAX_PLANS => {
                format!("mpc takes at most {MAX_PLANS} plans, but --plan names {found}")
            }
            (Scenario::Follow | Scenario::Mpc, _) => return Ok(()),
            _ if given => "--plan, --spread and --tolerance are of --scenario follow and mpc".to_owned(),
            _ => return Ok(()),
        };
        Err(Failure::Input(reason))
    }

    /// The files of the plans in memory.
    pub fn read(&self) -> Result<Vec<PlanBytes>, Failure> {
        self.plan.iter().map(|path| PlanBytes::read(path)).collect()
    }

    /// Overrides spread and tolerance of a setup with those of the command line.
    pub(super) fn adapt<const N: usize>(&self, setup: &mut Setup<N>) -> Result<(), Failure> {
        replace("--spread", &self.spread, &mut setup.start.q_spread)?;
        replace("--tolerance", &self.tolerance, &mut setup.goal.tolerance)
    }
}

/// The plans of files, which must be ones for the model whose file has these bytes.
///
/// # Errors
/// [`Failure::Input`] if one is not.
pub fn of_model<'p>(plans: &'p [PlanBytes], model: &[u8]) -> Result<Vec<PlanFile<'p>>, Failure> {
    plans.iter().map(|plan| plan.of_model(model)).collect()
}

/// A plan's file in memory, at a multiple of 4.
pub struct PlanBytes {
    path: PathBuf,
    words: Vec<u32>,
    length: usize,
}

impl PlanBytes {
    fn read(path: &Path) -> Result<Self, Failure> {
        let bytes = std::fs::read(path).map_err(|error| Failure::input(path, error))?;
        let (length, mut words) = (bytes.len(), vec![0_u32; bytes.len().div_ceil(4)]);
        bytemuck::cast_slice_mut(&mut words)[..length].copy_from_slice(&bytes);
        Ok(Self { path: path.to_owned(), words, length })
    }

    /// The plan, which must be one for the model whose file has these bytes.
    ///
    /// # Errors
    /// [`Failure::Input`] if it is not.
    fn of_model(&self, model: &[u8]) -> Result<PlanFile<'_>, Failure> {
        let refused = |error: &dyn std::fmt::Display| Failure::input(&self.path, error);
        let model = fingerprint(model).map_err(|error| refused(&error))?;
        let plan = PlanFile::parse(&bytemuck::cast_slice(&self.words)[..self.length]);
        let plan = plan.map_err(|error| refused(&error))?;
        plan.check_model(model).map_err(|error| refused(&error))?;
        Ok(plan)
    }
}

/// Result of following a plan.
#[derive(Clone, Debug, Serialize)]
pub struct PlanReport {
    /// Time when the first command took effect, s.
    begun: Option<f32>,
    /// Length of the plan, s.
    seconds: f32,
    /// Position and velocity at the first command, minus those of the plan's start.
    off_start: [Vec<f32>; 2],
    /// Largest |error| along the plan.
    deviation: Vec<f32>,
    /// Largest share of the plan's limits in the commands.
    limit_share: Vec<f32>,
    /// Whether the plan ends at rest.
    rests: bool,
    /// Error at the plan's end.
    end_error: Option<Vec<f32>>,
    /// Whether that is within the tolerance.
    reached: bool,
    /// Largest |error| after the end.
    held_error: Vec<f32>,
}

impl PlanReport {
    fn new<const N: usize>(followed: &Followed<N>, seconds: f32) -> Self {
        let Followed { begun, off_start, deviation, rests, end, held, share, .. } = *followed;
        Self {
            begun,
            seconds,
            off_start: off_start.map(Vec::from),
            deviation: deviation.to_vec(),
            limit_share: share.to_vec(),
            rests,
            end_error: end.map(Vec::from),
            reached: followed.reached(),
            held_error: held.to_vec(),
        }
    }

    /// Sentences for a reader who sees nothing but them; `held` says whether the run succeeded.
    pub fn told(&self, held: bool) -> String {
        let list =
            |values: &[f32]| values.iter().map(|x| format!("{x:.2}")).collect::<Vec<_>>().join(" and ");
        let end = self.begun.filter(|_| self.reached).map(|begun| begun + self.seconds);
        let arrived = match end {
            Some(end) if held => format!("It was there after {end:.2} s, and stayed"),
            Some(end) => format!("It was there after {end:.2} s, but did NOT stay"),
            None => "It did NOT arrive".to_owned(),
        };
        format!(
            "The firmware's program followed the plan, at most {} off. {arrived}, at most {} off.\n",
            list(&self.deviation),
            list(&self.held_error)
        )
    }

    /// Names and values of the report's lines; `q` is the unit of positions.
    pub(super) fn lines(&self, q: &str, list: impl Fn(&[f32]) -> String) -> Vec<(String, String)> {
        let begun = match self.begun {
            Some(begun) => format!("{begun:.2} s, for {:.2} s", self.seconds),
            None => "never: the firmware did not trust its estimate".to_owned(),
        };
        let end = match (&self.end_error, self.reached) {
            (None, _) => "not in this run".to_owned(),
            (Some(end), true) => format!("reached, error {}", list(end)),
            (Some(end), false) => format!("NOT reached, error {}", list(end)),
        };
        let percent: Vec<_> = self.limit_share.iter().map(|share| format!("{:.0}%", 100.0 * share)).collect();
        let [off_q, off_v] = self.off_start.each_ref().map(|off| list(off));
        let mut lines = vec![
            ("the plan began after".to_owned(), begun),
            (
                format!("there, off its start by ({q})"),
                format!("{off_q}, at velocities off by {off_v} per s"),
            ),
            (format!("off the plan, largest ({q})"), list(&self.deviation)),
            ("command, largest of its limit".to_owned(), percent.join(", ")),
            ("the plan's end".to_owned(), end),
        ];
        if self.rests && self.end_error.is_some() {
            lines.push((format!("error after it, largest ({q})"), list(&self.held_error)));
        }
        lines
    }
}

/// Runs the loop, here or on a board.
pub(super) fn planned<P: Mechanism<N>, M: Mechanism<N>, const N: usize>(
    request: &Request,
    (plant, model): (Timeline<P>, &M),
    trace: &mut Trace,
) -> Result<Report, Failure> {
    let plans = sized(request.plans)?;
    let plan = *plans.first().ok_or(SetupError::NoPlan).map_err(misused)?;
    let config = config(request, &plan)?;
    let (program, mut followed) = (config.program(), Followed::new(&plan, &config));
    let firmware = (&program, program.follow_with(model, || Ok::<_, SetupError>(plan)));
    let mut report = closed_loop(request, (plant, model), (&config.setup, plan), firmware, |tick| {
        followed.update(tick);
        trace.push(tick);
    })?;
    report.success = followed.success(report.success);
    report.planned = Some(PlanReport::new(&followed, plan.seconds()));
    Ok(report)
}

/// The plans of files, in N coordinates.
pub(super) fn sized<'p, const N: usize>(files: &[PlanFile<'p>]) -> Result<Vec<Plan<'p, N, N>>, Failure> {
    let plans = files.iter().map(|file| Plan::at_most(*file).map_err(|error| misused(error.into())));
    plans.collect()
}

/// The default configuration for the plan, with the options of the command line.
fn config<const N: usize>(request: &Request, plan: &Plan<N, N>) -> Result<FollowConfig<N>, Failure> {
    let mut config = FollowConfig::new(plan, encoders(request));
    config.drive = drive(request, config.setup.tick)?;
    request.adapt(&mut config.setup)?;
    config.setup.observer.memory = samples(MEMORY, config.setup.tick);
    request.floats.start_at(&mut config.setup)?;
    request.follows.adapt(&mut config.setup)?;
    Ok(config)
}

/// Conversion between commands and forces in plans for the model, in ticks of h seconds.
pub(super) fn drive<const N: usize>(request: &Request, h: f32) -> Result<Drive<N>, Failure> {
    let known = known_actuator(request.model, h)?;
    Ok(known.map_or(Drive::ideal(), |known| known.drive))
}

/// Task of following a plan on the plant of another model file.
pub struct Planned;

impl OnPlant for Planned {
    fn run<const N: usize>(
        self,
        request: &Request,
        systems: Systems<N>,
        trace: &mut Trace,
    ) -> Result<Report, Failure> {
        planned(request, systems, trace)
    }
}
