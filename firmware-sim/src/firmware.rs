use crate::Mechanism;
use crate::angle::difference;
use crate::control::{Command, Controller, Target};
use crate::devices::{ActuatorConfig, Drive};
use crate::observer::{Observer, ObserverConfig};
use crate::tick::Mode;
use crate::wire::{ReportWire, StateWire, array};
use leastaction_core::continuous::ContinuousState;
use leastaction_core::discrete::{Control, Report, StepError};
use leastaction_core::linear;
use leastaction_core::observer::Commands;
use leastaction_core::scalar::all_finite;
use serde::{Deserialize, Serialize};

/// Outcome of a tick in the firmware.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome<const N: usize> {
    /// Estimated position and velocity now.
    #[serde(with = "StateWire")]
    pub estimate: ContinuousState<f32, N>,
    /// Readings that were predicted for the encoders before the samples were used, zeros included; rad or m, not
    /// wrapped.
    #[serde(with = "array")]
    pub predicted: [f32; N],
    /// Learned zeros of the encoders, by which they read too much; rad or m.
    #[serde(with = "array")]
    pub zeros: [f32; N],
    /// Force and mode.
    pub command: Command<N>,
    /// Report of the model's last step.
    #[serde(with = "ReportWire")]
    pub newton: Report<f32>,
    /// Number of failed steps of the model, or of commands computed from it, in this tick.
    pub errors: u32,
}

impl<const N: usize> Outcome<N> {
    /// Outcome before anything was measured.
    pub const fn waiting() -> Self {
        let zero = [0.0; N];
        Self {
            estimate: ContinuousState { q: zero, v: zero },
            predicted: zero,
            zeros: zero,
            command: Command { u: zero, mode: Mode::Wait },
            newton: Report { iterations: 0, residual: 0.0 },
            errors: 0,
        }
    }
}

/// Elapsed ticks at the beginning of a log: longer than any patience.
pub(crate) const FIRST_TICK: u32 = u32::MAX;
/// Maximum number of ticks that the firmware simulates when it wakes: beyond any patience and any delay.
const MOST_ELAPSED: u32 = 256;

/// The program on the microcontroller: an observer, a controller, and its own record of the commands under way.
///
/// It steps the model ahead over the commands that are already decided, so the controller sees the state that its force will meet. If a
/// step of the model fails, it holds the last good state, commands no force in that tick, and counts the error.
///
/// The model is no part of it: every tick takes the model, whose numbers may have changed since the one before.
#[derive(Clone, Debug, PartialEq)]
pub struct Firmware<C, const N: usize> {
    controller: C,
    observer: Observer<f32, N>,
    actuator: ActuatorConfig<N>,
    line: Commands<f32, N>,
    force: Control<f32, N>,
    last: Outcome<N>,
}

impl<C, const N: usize> Firmware<C, N> {
    /// Creates a program with ticks of h seconds for actuators with the given limits, gains and offsets (the delay is that of `observer`,
    /// not of `actuator`); `angle` marks the encoders that forget whole turns.
    pub fn new(
        controller: C,
        h: f32,
        angle: [bool; N],
        observer: &ObserverConfig,
        actuator: ActuatorConfig<N>,
    ) -> Self {
        let (line, observer) = (observer.commands(&actuator.drive), observer.observer(h, angle));
        Self { controller, observer, actuator, line, force: Control::none(), last: Outcome::waiting() }
    }

    /// The last outcome.
    pub fn last(&self) -> &Outcome<N> {
        &self.last
    }

    /// The controller.
    pub fn controller(&self) -> &C {
        &self.controller
    }

    /// The force of the step that begins with the last tick.
    pub const fn force(&self) -> &Control<f32, N> {
        &self.force
    }

    /// Conversion between commands and forces.
    pub const fn drive(&self) -> &Drive<N> {
        &self.actuator.drive
    }

    /// Positions that encoders read in the last tick, without their zeros and whole turns as in the estimate; `None` if a reading is missing,
    /// or the estimate is not trusted.
    pub fn read(&self, measured: &[Option<f32>; N]) -> Option<[f32; N]> {
        let Outcome { estimate, zeros, .. } = &self.last;
        let mut q = *zeros;
        for (q, measured) in q.iter_mut().zip(measured) {
            *q = (*measured)? - *q;
        }
        let away = difference(&q, &estimate.q, self.observer.angle());
        self.observer.trusted().then(|| linear::add_scaled(&estimate.q, 1.0, &away))
    }

    /// Runs over a model `elapsed` ticks after the last run, on the samples that arrived, towards a target.
    pub fn run<M: Mechanism<N>>(
        &mut self,
        model: &M,
        elapsed: u32,
        measured: &[Option<f32>; N],
        target: &Target<N>,
    ) -> Outcome<N>
    where
        C: Controller<N>,
    {
        let mut outcome = Outcome { errors: 0, ..self.last };
        let estimated = self.estimate(model, elapsed, measured, &mut outcome);
        self.controller.read(elapsed, measured);
        let command = estimated.and_then(|()| self.command(model, target));
        if command.is_err() {
            outcome.errors += 1;
        }
        self.give(outcome, command.unwrap_or(Command { u: [0.0; N], mode: Mode::Safe }))
    }

    /// Runs over a model on the samples and the command of a log; the logged command replaces the controller's. At the first tick of a log, the
    /// same command is assumed for all ticks before.
    pub fn replay<M: Mechanism<N>>(
        &mut self,
        model: &M,
        elapsed: u32,
        measured: &[Option<f32>; N],
        u: [f32; N],
    ) -> Outcome<N> {
        let mut outcome = Outcome { errors: 0, ..self.last };
        let estimated = self.estimate(model, elapsed, measured, &mut outcome);
        outcome.errors += u32::from(estimated.is_err());
        if elapsed == FIRST_TICK {
            self.line.take_past(u);
        }
        let mode = match estimated {
            Err(_) => Mode::Safe,
            Ok(()) if self.observer.trusted() => Mode::Open,
            Ok(()) => Mode::Wait,
        };
        self.give(outcome, Command { u, mode })
    }

    fn give(&mut self, outcome: Outcome<N>, command: Command<N>) -> Outcome<N> {
        let outcome = Outcome { command, ..outcome };
        self.force = self.line.advance(Some(command.u));
        self.last = outcome;
        outcome
    }

    /// Predicts over the elapsed ticks and corrects; returns the first error after trying everything.
    fn estimate<M: Mechanism<N>>(
        &mut self,
        model: &M,
        elapsed: u32,
        measured: &[Option<f32>; N],
        outcome: &mut Outcome<N>,
    ) -> Result<(), StepError<f32>> {
        let (system, mut result) = (model.system(), Ok(()));
        self.observer.wake(elapsed.saturating_sub(1));
        // Ticks beyond the observer's patience and the line's delay make no difference.
        for tick in 0..elapsed.min(MOST_ELAPSED) {
            if tick > 0 {
                self.force = self.line.advance(None);
            }
            match self.observer.predict(system, &self.force) {
                Ok(report) => outcome.newton = report.unwrap_or(outcome.newton),
                Err(error) => result = result.and(Err(error)),
            }
        }
        outcome.predicted = self.predicted(measured);
        let corrected = self.observer.correct(system, measured);
        outcome.zeros = self.observer.zeros();
        if let Some(estimate) = self.observer.estimate(system)? {
            outcome.estimate = estimate;
        }
        result.and(corrected)
    }

    /// Predicted readings of the encoders; without an estimate yet, the readings themselves.
    fn predicted(&self, measured: &[Option<f32>; N]) -> [f32; N] {
        match self.observer.state() {
            Some(state) => linear::add_scaled(&state.q(), 1.0, &self.observer.zeros()),
            None => measured.map(Option::unwrap_or_default),
        }
    }

    fn command<M: Mechanism<N>>(
        &mut self,
        model: &M,
        target: &Target<N>,
    ) -> Result<Command<N>, StepError<f32>>
    where
        C: Controller<N>,
    {
        let state = match self.observer.ahead(model.system(), &self.line)? {
            Some(state) if self.observer.trusted() => state,
            _ => return Ok(Outcome::waiting().command),
        };
        let Command { u, mode } = self.controller.command(model, target, &state)?;
        if !all_finite(&u) {
            return Err(StepError::NotFinite);
        }
        Ok(Command { u: self.actuator.saturate(&self.actuator.drive.command(&u)), mode })
    }
}
