use super::{Push, Setup};
use crate::angle::difference;
use crate::control::{Controller, Target, Trajectory};
use crate::devices::{Actuator, Arrival, Clock, Encoders};
use crate::error::SetupError;
use crate::firmware::{Firmware, Outcome};
use crate::plant::Plant;
use crate::summary::{Recorder, Summary};
use crate::tick::{Mode, Tick};
use crate::{InPlace, Mechanism, Processor, Timeline};
use core::convert::Infallible;
use core::fmt;
use leastaction_core::linear::add_scaled;

/// The world as the firmware sees it.
struct World<'a, P, const N: usize> {
    plant: Plant<'a, P, N>,
    encoders: Encoders<N>,
    actuator: Actuator<N>,
    clock: Clock,
    push: Push<N>,
    /// Push of this run, push of this tick, and push from elsewhere.
    pushes: [[f32; N]; 3],
    /// Force of the actuators without a command; the brakes hold the mechanism as long as the force is still this
    /// one. `None` without brakes, or after they opened.
    braked: Option<[f32; N]>,
    h: f32,
    errors: u32,
}

impl<'a, P: Mechanism<N>, const N: usize> World<'a, P, N> {
    fn new(plant: Timeline<'a, P>, setup: &Setup<N>) -> Self {
        let actuator = Actuator::new(setup.devices.actuator);
        Self {
            plant: Plant::new(plant, setup.start.draw(setup.seed), setup.substeps),
            encoders: Encoders::new(setup.devices.encoders, setup.seed),
            braked: setup.brakes.then(|| actuator.force()),
            actuator,
            clock: Clock::new(setup.devices.clock, setup.seed),
            push: setup.push,
            pushes: [setup.push.draw(setup.seed), [0.0; N], [0.0; N]],
            h: setup.tick,
            errors: 0,
        }
    }

    /// Begins the tick at time t (s). The plant changes at the beginning of the tick that is nearest to the time of its change.
    fn begin(&mut self, t: f32) {
        self.plant.change(t + 0.5 * self.h);
        let [of_run, _, from_elsewhere] = self.pushes;
        self.pushes[1] =
            if self.push.acts(t) { add_scaled(&of_run, 1.0, &from_elsewhere) } else { from_elsewhere };
    }

    /// Lets a fraction of a tick pass under the acting forces.
    fn pass(&mut self, fraction: f32) {
        let force = self.actuator.force();
        self.braked = self.braked.filter(|braked| *braked == force);
        if self.braked.is_some() {
            // A lagging force changes meanwhile.
            self.actuator.pass(fraction);
            return;
        }
        let (actuator, push) = (&mut self.actuator, &self.pushes[1]);
        let force = |part: f32| add_scaled(&actuator.pass(part * fraction), 1.0, push);
        let moved = self.plant.advance(fraction * self.h, force);
        self.errors += u32::from(moved.is_err());
    }

    /// Takes the command of a tick that came late by `lateness`, and lets the rest of the tick pass; returns the force that acts from then
    /// on.
    fn act(&mut self, command: Option<[f32; N]>, lateness: f32) -> [f32; N] {
        let effect = lateness.max(self.actuator.rest());
        self.pass(effect - lateness);
        let applied = self.actuator.advance(command);
        self.pass(1.0 - effect);
        applied
    }
}

/// A run of a processor in its world, tick by tick: [`run_on`] takes all ticks of its setup, a program with a screen takes them as time passes.
pub struct Run<'a, P, R, T, const N: usize> {
    world: World<'a, P, N>,
    processor: R,
    trajectory: T,
    /// Delay from a command to its effect as far as the firmware knows, s.
    delay: f32,
    recorder: Recorder<N>,
    angle: [bool; N],
    /// Number of ticks of the run so far.
    ticks: u32,
    /// Number of ticks since the firmware last ran.
    elapsed: u32,
    /// Time when the first command takes effect, s; `None` before.
    begun: Option<f32>,
}

impl<'a, P: Mechanism<N>, R: Processor<N>, T: Trajectory<N>, const N: usize> Run<'a, P, R, T, N> {
    /// Creates a run of a world, whose plant may change with time, along a trajectory before its first tick, with `processor` for the firmware's part of its ticks.
    ///
    /// # Errors
    /// A setup out of range.
    pub fn new(
        plant: impl Into<Timeline<'a, P>>,
        processor: R,
        setup: &Setup<N>,
        trajectory: T,
    ) -> Result<Self, SetupError> {
        setup.validate()?;
        let angle = setup.devices.angles();
        Ok(Self {
            world: World::new(plant.into(), setup),
            processor,
            trajectory,
            delay: setup.observer.lateness() * setup.tick,
            recorder: Recorder::new(setup.goal, angle),
            angle,
            ticks: 0,
            elapsed: 0,
            begun: None,
        })
    }

    /// Takes the next tick. A run may go on beyond the length of its setup.
    ///
    /// # Errors
    /// The processor's error if it did not run the tick.
    pub fn tick(&mut self) -> Result<Tick<N>, R::Error> {
        let tick = self.take(self.ticks)?;
        self.recorder.record(&tick);
        self.ticks = self.ticks.saturating_add(1);
        Ok(tick)
    }

    /// Pushes the mechanism from the next tick on, beside the push of the setup and until it is pushed otherwise: a force on every
    /// coordinate, N or N m, unknown to the firmware. With brakes, nothing moves until they open.
    pub fn push(&mut self, force: [f32; N]) {
        self.world.pushes[2] = force;
    }

    /// Summary of the ticks so far.
    pub fn summary(&self) -> Summary<N> {
        let mut recorder = self.recorder.clone();
        recorder.errors(0, self.world.errors);
        recorder.finish()
    }

    /// The processor.
    pub fn processor(&self) -> &R {
        &self.processor
    }

    /// One tick of world and firmware.
    fn take(&mut self, index: u32) -> Result<Tick<N>, R::Error> {
        let (arrival, true_state) = (self.world.clock.tick(), *self.world.plant.state());
        let time = index as f32 * self.world.h;
        self.world.begin(time);
        self.world.pass(arrival.lateness);
        let measured = self.world.encoders.sample(&self.world.plant.state().q);
        let measured = if arrival.missed { [None; N] } else { measured };
        let outcome = self.run(time, &arrival, &measured)?;
        let command = (!arrival.missed).then_some(outcome.command.u);
        let applied = self.world.act(command, arrival.lateness);
        let reference = self.trajectory.at(self.on_trajectory(time)).q;
        Ok(Tick {
            index,
            time,
            q: true_state.q,
            v: true_state.v,
            measured,
            q_estimate: outcome.estimate.q,
            v_estimate: outcome.estimate.v,
            reference,
            error: difference(&true_state.q, &reference, &self.angle),
            commanded: outcome.command.u,
            applied,
            newton: outcome.newton,
            lateness: arrival.lateness * self.world.h,
            missed: arrival.missed,
            mode: outcome.command.mode,
        })
    }

    /// The trajectory's own time at a time of the run, s.
    fn on_trajectory(&self, time: f32) -> f32 {
        if !self.trajectory.begins_with_command() {
            return time;
        }
        self.begun.map_or(f32::NEG_INFINITY, |begun| time - begun)
    }

    /// Runs the firmware's part of a tick.
    fn run(
        &mut self,
        time: f32,
        arrival: &Arrival,
        measured: &[Option<f32>; N],
    ) -> Result<Outcome<N>, R::Error> {
        self.elapsed += 1;
        if arrival.missed {
            return Ok(*self.processor.last());
        }
        let effect = time + self.delay;
        let target = Target::of(&self.trajectory, self.on_trajectory(effect), self.world.h);
        let outcome = self.processor.run(self.elapsed, measured, &target)?;
        self.elapsed = 0;
        if outcome.command.mode != Mode::Wait {
            self.begun.get_or_insert(effect);
        }
        self.recorder.errors(outcome.errors, 0);
        Ok(outcome)
    }
}

/// Reason why a run on a processor did not reach its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RunError<E> {
    /// The run cannot begin.
    Setup(SetupError),
    /// The processor did not run a tick; the sink has seen all ticks before it.
    Processor {
        /// Index of the tick.
        tick: u32,
        /// Error of the processor.
        error: E,
    },
}

impl<E: fmt::Display> fmt::Display for RunError<E> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Setup(error) => error.fmt(f),
            Self::Processor { tick, error } => write!(f, "tick {tick} was not run: {error}"),
        }
    }
}

impl<E: core::error::Error> core::error::Error for RunError<E> {}

/// A firmware in place always runs, so only its setup can fail.
impl From<RunError<Infallible>> for SetupError {
    fn from(error: RunError<Infallible>) -> Self {
        match error {
            RunError::Setup(error) => error,
            RunError::Processor { error, .. } => match error {},
        }
    }
}

/// Runs a world, whose plant may change with time, along a trajectory, with `processor` for the firmware's part of its ticks.
///
/// # Errors
/// A setup out of range, and the first tick that the processor does not run.
pub fn run_on<'a, P: Mechanism<N> + 'a, R: Processor<N>, const N: usize>(
    plant: impl Into<Timeline<'a, P>>,
    processor: R,
    setup: &Setup<N>,
    trajectory: impl Trajectory<N>,
    mut sink: impl FnMut(&Tick<N>),
) -> Result<Summary<N>, RunError<R::Error>> {
    let mut run = Run::new(plant, processor, setup, trajectory).map_err(RunError::Setup)?;
    for index in 0..setup.ticks() {
        let tick = run.tick().map_err(|error| RunError::Processor { tick: index, error })?;
        sink(&tick);
    }
    Ok(run.summary())
}

/// Runs a world with a firmware over a model, which always runs.
pub(super) fn run_in_place<'a, P, M, C, const N: usize>(
    plant: impl Into<Timeline<'a, P>>,
    (model, firmware): (&M, Firmware<C, N>),
    setup: &Setup<N>,
    trajectory: impl Trajectory<N>,
    sink: impl FnMut(&Tick<N>),
) -> Result<Summary<N>, SetupError>
where
    P: Mechanism<N> + 'a,
    M: Mechanism<N>,
    C: Controller<N>,
{
    Ok(run_on(plant, InPlace { model, firmware }, setup, trajectory, sink)?)
}
