use super::{Command, Controller, Setpoint, Target, Trajectory};
use crate::Mechanism;
use crate::Program;
use crate::devices::Drive;
use crate::error::SetupError;
use crate::observer::same_step;
use crate::tick::Mode;
use leastaction_core::continuous::{ContinuousState, inverse_dynamics};
use leastaction_core::discrete::StepError;
use leastaction_core::linear::add_scaled;
use leastaction_core::plan::Plan;

/// Follows a [plan](leastaction_core::plan): u = ū − K(x − x̄) within the plan's limits, from the first command on.
///
/// The plan's ticks are counted from the tick in which the estimate is first trusted; missed ticks count, and so do ticks without a trusted
/// estimate after that, in which nothing is commanded. A command is that of the estimate where it takes effect, so a delay moves the motion
/// as a whole. Where the model's numbers follow the machine, ū is that of the numbers in use: it changes by what inverse dynamics along the
/// planned motion ask for more than those of the learned model. From the plan's end on its last record is held. A mechanism that is not at the plan's start is not refused: the law is a
/// feedback, and brings it to the plan from as far as its gains and limits reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Follow<'p, const N: usize> {
    plan: Plan<'p, N, N>,
    drive: Drive<N>,
    angle: [bool; N],
    /// Tick, s.
    h: f32,
    begun: Option<Begun<N>>,
}

/// Count of ticks since the first command, and whole turns (rad) by which the estimate was then off the plan.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Begun<const N: usize> {
    tick: u32,
    turns: [f32; N],
}

impl<'p, const N: usize> Follow<'p, N> {
    /// Creates the controller of a program; `drive` is the conversion between the plan's commands and forces.
    ///
    /// # Errors
    /// [`SetupError::PlanTick`] and [`SetupError::PlanAngle`].
    pub(crate) fn new(
        plan: Plan<'p, N, N>,
        drive: Drive<N>,
        program: &Program<N>,
    ) -> Result<Self, SetupError> {
        check_plan(&plan, program)?;
        Ok(Self { plan, drive, angle: program.angle, h: program.tick, begun: None })
    }

    /// Command that the numbers in use ask for beside the planned one, in the middle of a tick of the plan; `None` for a model that stays what
    /// it is.
    fn added<M: Mechanism<N>>(&self, model: &M, tick: u32) -> Option<Result<[f32; N], StepError<f32>>> {
        let [q, v, a] = self.plan.motion((tick as f32 + 0.5) * self.h);
        let force = |system| inverse_dynamics(system, &q, &v, &a);
        let of_file = model.of_file()?;
        let more = force(model.system()).and_then(|used| Ok(add_scaled(&used, -1.0, &force(of_file)?)));
        Some(more.map(|more| core::array::from_fn(|i| more[i] / self.drive.gain[i])))
    }

    /// Begins the plan, if it has not begun. Encoders of angles forget whole turns, of which the plan knows the right ones.
    fn begun(&mut self, q: &[f32; N]) -> Begun<N> {
        let turns = || self.plan.turns(q, &self.angle);
        *self.begun.get_or_insert_with(|| Begun { tick: 0, turns: turns() })
    }
}

/// Checks that a plan has the tick and the angles of a program.
pub(super) fn check_plan<const N: usize, const M: usize>(
    plan: &Plan<N, M>,
    program: &Program<N>,
) -> Result<(), SetupError> {
    let (header, tick, angle) = (plan.file().header(), program.tick, program.angle);
    if !same_step(tick, header.h) {
        return Err(SetupError::PlanTick { planned: header.h, tick });
    }
    let turns = header.angles.iter().map(|angle| *angle == 1);
    match turns.zip(angle).position(|(turns, angle)| turns && !angle) {
        Some(coordinate) => Err(SetupError::PlanAngle { coordinate: coordinate as u8 }),
        None => Ok(()),
    }
}

impl<const N: usize> Controller<N> for Follow<'_, N> {
    fn read(&mut self, elapsed: u32, _: &[Option<f32>; N]) {
        if let Some(Begun { tick, .. }) = &mut self.begun {
            *tick = tick.saturating_add(elapsed);
        }
    }

    fn command<M: Mechanism<N>>(
        &mut self,
        model: &M,
        _: &Target<N>,
        state: &ContinuousState<f32, N>,
    ) -> Result<Command<N>, StepError<f32>> {
        let Begun { tick, turns } = self.begun(&state.q);
        let q = core::array::from_fn(|i| state.q[i] - turns[i]);
        let command = match self.added(model, tick) {
            None => self.plan.force(tick, &q, &state.v),
            Some(added) => self.plan.force_with(tick, &q, &state.v, &added?),
        };
        let command = command.map_err(|_| StepError::NotFinite)?;
        let mode = if tick < self.plan.ticks() { Mode::Track } else { Mode::Hold };
        Ok(Command { u: self.drive.force(&command), mode })
    }
}

/// The planned motion, which begins when the first command takes effect.
impl<const N: usize, const M: usize> Trajectory<N> for Plan<'_, N, M> {
    fn at(&self, t: f32) -> Setpoint<N> {
        let [q, v, a] = self.motion(t);
        Setpoint { q, v, a }
    }

    fn begins_with_command(&self) -> bool {
        true
    }
}
