use super::run::run_in_place;
use super::{Setup, Start};
use crate::devices::{Devices, Drive, EncoderConfig};
use crate::error::SetupError;
use crate::summary::{Goal, Summary};
use crate::tick::{Mode, Tick};
use crate::{Mechanism, Program, Task, Timeline};
use leastaction_core::linear::add_scaled;
use leastaction_core::plan::{Plan, PlanHeader};
use leastaction_core::scalar::{Scalar, max_abs};

/// Speed up to which a plan's end counts as rest, rad/s or m/s.
const REST: f32 = 0.01;
/// Duration for which an end at rest must be held, s.
const HOLD: f32 = 1.0;
/// Duration of a run beyond a plan that ends at rest, s: for the observer's first samples, and for settling before the hold.
const BEYOND: f32 = 2.0;
/// Duration of a run beyond a plan that ends in motion, s.
const JUST_BEYOND: f32 = 0.25;
/// Largest |error| over the hold, rad or m.
const TOLERANCE: f32 = 0.1;
/// Spread of the start about the plan's, rad or m.
pub(super) const SPREAD: f32 = 0.02;

/// A mechanism that follows a plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FollowConfig<const N: usize> {
    /// Loop, devices, goal. The tick must be the plan's.
    pub setup: Setup<N>,
    /// Conversion between the plan's commands and forces: that of the actuators in the plan's model.
    pub drive: Drive<N>,
}

impl<const N: usize> FollowConfig<N> {
    /// Creates a run along a plan whose commands are forces: from within 0.02 rad or m of its start, at rest in brakes, with actuators of the
    /// plan's limits. If the plan ends at rest, the run lasts 2 s longer than the plan, and errors must stay within 0.1 rad or m over the last
    /// second; otherwise the run ends soon after the plan, at whose end the error must be within 0.1 rad or m.
    pub fn new<const M: usize>(plan: &Plan<N, M>, encoders: [EncoderConfig; N]) -> Self {
        let header = plan.file().header();
        let beyond = if rests(plan) { BEYOND } else { JUST_BEYOND };
        let seconds = plan.seconds() + beyond;
        let goal = Goal { tolerance: [TOLERANCE; N], hold: HOLD, bounds: [f32::INFINITY; N] };
        let start = Start { q_spread: [SPREAD; N], ..Start::at_rest(plan.reference(0).q) };
        let devices = Devices::new(encoders, limits(header));
        let setup = Setup { tick: header.h, seconds, brakes: true, ..Setup::new(start, devices, goal) };
        Self { setup, drive: Drive::ideal() }
    }

    /// Program of the firmware.
    pub fn program(&self) -> Program<N> {
        self.setup.program(Task::Follow { drive: self.drive })
    }
}

/// Whether a plan ends at rest.
fn rests<const N: usize, const M: usize>(plan: &Plan<N, M>) -> bool {
    max_abs(&plan.reference(u32::MAX).v) <= REST
}

/// Largest magnitudes of the commands that a plan allows; 0 for coordinates that are not driven.
pub(super) fn limits<const N: usize>(header: &PlanHeader) -> [f32; N] {
    let mut limits = [0.0; N];
    for (coordinate, [least, most]) in header.driven.iter().zip(header.limits) {
        if let Some(limit) = limits.get_mut(usize::from(*coordinate)) {
            *limit = Scalar::max(least.abs(), most.abs());
        }
    }
    limits
}

/// Measures of a followed plan, from the ticks of its run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Followed<'p, const N: usize> {
    header: PlanHeader<'p>,
    start: [[f32; N]; 2],
    drives: [Drive<N>; 2],
    delay: f32,
    tolerance: [f32; N],
    /// Whether the plan ends at rest, so that its end can be held.
    pub rests: bool,
    /// Time when the first command took effect, s; `None` if there was none.
    pub begun: Option<f32>,
    /// Position minus that of the plan's start, then velocity minus its velocity, at the tick of the first command.
    pub off_start: [[f32; N]; 2],
    /// Largest |error| from the first command's effect to the plan's end, rad or m.
    pub deviation: [f32; N],
    /// Error at the plan's end, rad or m; `None` if the run ended before.
    pub end: Option<[f32; N]>,
    /// Largest |error| from the plan's end on, rad or m.
    pub held: [f32; N],
    /// Largest share of the plan's limit in the command of each coordinate; 0 for those that are not driven.
    pub share: [f32; N],
}

impl<'p, const N: usize> Followed<'p, N> {
    /// Creates the measures before the first tick of a run.
    pub fn new<const M: usize>(plan: &Plan<'p, N, M>, config: &FollowConfig<N>) -> Self {
        let start = plan.reference(0);
        let FollowConfig { setup, drive } = config;
        let zero = [0.0; N];
        Self {
            header: *plan.file().header(),
            start: [start.q, start.v],
            drives: [setup.known_drive, *drive],
            delay: setup.observer.lateness() * setup.tick,
            tolerance: setup.goal.tolerance,
            rests: rests(plan),
            begun: None,
            off_start: [zero; 2],
            deviation: zero,
            end: None,
            held: zero,
            share: zero,
        }
    }

    /// Takes in a tick.
    pub fn update(&mut self, tick: &Tick<N>) {
        if tick.missed || tick.mode == Mode::Wait {
            return;
        }
        let begun = *self.begun.get_or_insert_with(|| {
            let apart = |x, start: &[f32; N]| add_scaled(x, -1.0, start);
            // Nothing was commanded yet, so the reference is still the start.
            self.off_start = [tick.error, apart(&tick.v, &self.start[1])];
            tick.time + self.delay
        });
        self.commanded(&tick.commanded);
        let past = tick.time - begun;
        if past < 0.0 {
            return;
        }
        let ended = past > self.header.seconds() - 0.5 * self.header.h;
        let largest = if ended { &mut self.held } else { &mut self.deviation };
        for (largest, error) in largest.iter_mut().zip(tick.error) {
            *largest = Scalar::max(*largest, error.abs());
        }
        if ended {
            self.end.get_or_insert(tick.error);
        }
    }

    /// Whether the error at the plan's end is within the tolerance.
    pub fn reached(&self) -> bool {
        let within = |end: [f32; N]| end.iter().zip(self.tolerance).all(|(end, most)| end.abs() <= most);
        self.end.is_some_and(within)
    }

    /// Whether the run succeeded: an end at rest must be `held` as the goal says, one in motion must be reached.
    pub fn success(&self, held: bool) -> bool {
        if self.rests { self.end.is_some() && held } else { self.reached() }
    }

    /// Takes in a command of the firmware.
    fn commanded(&mut self, command: &[f32; N]) {
        let [known, planned] = self.drives;
        let command = planned.command(&known.force(command));
        for (coordinate, limits) in self.header.driven.iter().zip(self.header.limits) {
            let coordinate = usize::from(*coordinate);
            if let (Some(largest), Some(u)) = (self.share.get_mut(coordinate), command.get(coordinate)) {
                *largest = Scalar::max(*largest, share(*u, limits));
            }
        }
    }
}

/// Share of a limit in a command; 0 for no command.
fn share(u: f32, [least, most]: &[f32; 2]) -> f32 {
    let limit = if u < 0.0 { *least } else { *most };
    if u == 0.0 { 0.0 } else { u / limit }
}

/// Follows a plan that was made for the model, by the plan's feedback about it.
///
/// # Errors
/// See [`Program::start_with`]; also a setup out of range.
pub fn follow<'a, 'p, P: Mechanism<N> + 'a, M: Mechanism<N>, const N: usize>(
    plant: impl Into<Timeline<'a, P>>,
    model: &M,
    plan: &Plan<'p, N, N>,
    config: &FollowConfig<N>,
    mut sink: impl FnMut(&Tick<N>),
) -> Result<(Summary<N>, Followed<'p, N>), SetupError> {
    config.setup.validate()?;
    let firmware = config.program().follow_with(model, || Ok::<_, SetupError>(*plan))?;
    let mut followed = Followed::new(plan, config);
    let summary = run_in_place(plant, (model, firmware), &config.setup, plan, |tick| {
        followed.update(tick);
        sink(tick);
    })?;
    Ok((Summary { success: followed.success(summary.success), ..summary }, followed))
}
