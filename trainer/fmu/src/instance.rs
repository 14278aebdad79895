mod values;

use crate::unit::Moved;
use crate::{FmuError, Interface, Phase, State, Unit};

/// A running unit. Every call that returns an error leaves it unchanged.
pub struct Instance {
    unit: Unit,
    state: State,
}

/// Largest number of steps of the model in a communication step.
const MAX_STEPS: f64 = 1e9;

/// Largest deviation of a time from a multiple of the model's step, in steps: what sums of decimal numbers are rounded by.
const TIME_TOLERANCE: f64 = 1e-3;

impl Instance {
    /// Creates an instance, whose description has this token.
    ///
    /// # Errors
    /// [`FmuError::Token`] if the description belongs to another model.
    pub fn new(unit: Unit, interface: Interface, token: &str) -> Result<Self, FmuError> {
        let expected = unit.token();
        if token != expected {
            return Err(FmuError::Token { expected, found: token.to_owned() });
        }
        let state = State::new(&unit, interface);
        Ok(Self { unit, state })
    }

    /// Number of continuous states, 2n.
    pub fn states(&self) -> usize {
        2 * self.unit.n()
    }

    /// Time, s.
    pub fn time(&self) -> f64 {
        self.state.time
    }

    /// Sets the time at the start of the simulation, s.
    ///
    /// # Errors
    /// [`FmuError::Order`], [`FmuError::NotFinite`].
    pub fn set_start(&mut self, start: f64) -> Result<(), FmuError> {
        self.during("a start time", &[Phase::Instantiated])?;
        finite("the start time", start)?;
        (self.state.start, self.state.time) = (start, start);
        Ok(())
    }

    /// Begins the initialisation.
    ///
    /// # Errors
    /// [`FmuError::Order`].
    pub fn enter_initialization(&mut self) -> Result<(), FmuError> {
        self.during("the beginning of the initialisation", &[Phase::Instantiated])?;
        self.state.phase = Phase::Initialization;
        Ok(())
    }

    /// Ends the initialisation, from which on the start values count.
    ///
    /// # Errors
    /// [`FmuError::Order`]; [`FmuError::Core`] if the motion cannot begin at the start values.
    pub fn exit_initialization(&mut self) -> Result<(), FmuError> {
        self.during("the end of the initialisation", &[Phase::Initialization])?;
        if self.state.interface == Interface::ModelExchange {
            self.state.phase = Phase::Event;
            return Ok(());
        }
        let State { h, q, v, .. } = &self.state;
        let begun = self.unit.begin(*h, q, v)?;
        self.take(begun);
        self.state.phase = Phase::Step;
        Ok(())
    }

    fn take(&mut self, Moved { q, v, saved }: Moved) {
        (self.state.q, self.state.v, self.state.motion) = (q, v, saved);
    }

    /// Enters the event mode of model exchange, in which nothing happens.
    ///
    /// # Errors
    /// [`FmuError::OtherInterface`], [`FmuError::Order`].
    pub fn enter_event_mode(&mut self) -> Result<(), FmuError> {
        self.of("the event mode", Interface::ModelExchange)?;
        self.during("the event mode", &[Phase::ContinuousTime, Phase::Event])?;
        self.state.phase = Phase::Event;
        Ok(())
    }

    /// Looks for a change of discrete states, of which there are none.
    ///
    /// # Errors
    /// [`FmuError::OtherInterface`], [`FmuError::Order`].
    pub fn update_discrete_states(&self) -> Result<(), FmuError> {
        self.of("the update of discrete states", Interface::ModelExchange)?;
        self.during("the update of discrete states", &[Phase::Event])
    }

    /// Enters the continuous-time mode of model exchange.
    ///
    /// # Errors
    /// [`FmuError::OtherInterface`], [`FmuError::Order`].
    pub fn enter_continuous_time_mode(&mut self) -> Result<(), FmuError> {
        self.of("the continuous-time mode", Interface::ModelExchange)?;
        self.during("the continuous-time mode", &[Phase::Event])?;
        self.state.phase = Phase::ContinuousTime;
        Ok(())
    }

    /// Accepts the end of an importer's step.
    ///
    /// # Errors
    /// [`FmuError::OtherInterface`], [`FmuError::Order`].
    pub fn completed_integrator_step(&self) -> Result<(), FmuError> {
        self.of("the end of an integrator's step", Interface::ModelExchange)?;
        self.during("the end of an integrator's step", &[Phase::ContinuousTime])
    }

    /// Sets the time of model exchange, s.
    ///
    /// # Errors
    /// [`FmuError::OtherInterface`], [`FmuError::Order`], [`FmuError::NotFinite`].
    pub fn set_time(&mut self, time: f64) -> Result<(), FmuError> {
        self.of("a change of time", Interface::ModelExchange)?;
        self.during("a change of time", &[Phase::ContinuousTime, Phase::Event])?;
        finite("the time", time)?;
        self.state.time = time;
        Ok(())
    }

    /// Sets the continuous states of model exchange, q and then v.
    ///
    /// # Errors
    /// [`FmuError::OtherInterface`], [`FmuError::Order`], [`FmuError::Length`], [`FmuError::NotFinite`].
    pub fn set_continuous_states(&mut self, states: &[f64]) -> Result<(), FmuError> {
        self.of("a change of continuous states", Interface::ModelExchange)?;
        self.during("a change of continuous states", &[Phase::ContinuousTime, Phase::Event])?;
        self.check_states(states.len())?;
        let (q, v) = states.split_at(self.unit.n());
        for (what, numbers) in [("q", q), ("v", v)] {
            for (i, x) in numbers.iter().enumerate() {
                finite(&format!("{what}[{}]", i + 1), *x)?;
            }
        }
        self.state.q.copy_from_slice(q);
        self.state.v.copy_from_slice(v);
        Ok(())
    }

    /// The continuous states of model exchange, q and then v.
    ///
    /// # Errors
    /// [`FmuError::OtherInterface`].
    pub fn continuous_states(&self) -> Result<Vec<f64>, FmuError> {
        self.of("reading of continuous states", Interface::ModelExchange)?;
        Ok([self.state.q.as_slice(), &self.state.v].concat())
    }

    /// The derivatives of the continuous states, v and then v̇.
    ///
    /// # Errors
    /// [`FmuError::OtherInterface`]; [`FmuError::Core`] if the acceleration does not exist.
    pub fn derivatives(&self) -> Result<Vec<f64>, FmuError> {
        self.of("reading of derivatives", Interface::ModelExchange)?;
        Ok([self.state.v.clone(), self.acceleration()?].concat())
    }

    /// Nominal values of the continuous states.
    ///
    /// # Errors
    /// [`FmuError::OtherInterface`].
    pub fn nominals(&self) -> Result<Vec<f64>, FmuError> {
        self.of("reading of nominal values", Interface::ModelExchange)?;
        Ok(vec![1.0; self.states()])
    }

    /// Returns an error unless a list has 2n numbers.
    ///
    /// # Errors
    /// [`FmuError::Length`].
    pub fn check_states(&self, found: usize) -> Result<(), FmuError> {
        FmuError::check_length("the list of continuous states", self.states(), found)
    }

    /// Steps the model from the communication point over the communication step, s.
    ///
    /// # Errors
    /// [`FmuError::OtherInterface`], [`FmuError::Order`]; [`FmuError::Point`], [`FmuError::CommunicationStep`] and [`FmuError::Remainder`] for
    /// times that do not fit; [`FmuError::Step`] if a step cannot be solved.
    pub fn do_step(&mut self, point: f64, size: f64) -> Result<(), FmuError> {
        self.of("a step", Interface::CoSimulation)?;
        self.during("a step", &[Phase::Step])?;
        let steps = self.steps_over(point, size)?;
        let State { h, motion, u, .. } = &self.state;
        let moved = self.unit.advance((*h, motion), u, steps).map_err(|failed| self.unsolved(failed))?;
        self.take(moved);
        self.state.steps += steps;
        self.state.time = self.time_of(self.state.steps);
        Ok(())
    }

    /// Number of the model's steps in a communication step.
    fn steps_over(&self, point: f64, size: f64) -> Result<u64, FmuError> {
        let State { start, time, steps, h, .. } = self.state;
        finite("the communication point", point)?;
        finite("the communication step", size)?;
        // Times are sums of an importer, whose rounding errors grow with the time itself.
        let tolerance = TIME_TOLERANCE * h + 8.0 * f64::EPSILON * point.abs();
        if (point - time).abs() > tolerance {
            return Err(FmuError::Point { expected: time, found: point });
        }
        if size < 0.0 || size > MAX_STEPS * h {
            return Err(FmuError::CommunicationStep(size));
        }
        let end = ((point + size - start) / h).round() as u64;
        if (self.time_of(end) - (point + size)).abs() > tolerance || (end == steps && size > tolerance) {
            return Err(FmuError::Remainder { size, h });
        }
        Ok(end.saturating_sub(steps))
    }

    /// Time after a number of steps, s.
    fn time_of(&self, steps: u64) -> f64 {
        self.state.start + steps as f64 * self.state.h
    }

    fn unsolved(&self, (taken, error): (u64, FmuError)) -> FmuError {
        match error {
            FmuError::Core(error) => FmuError::Step { time: self.time_of(self.state.steps + taken), error },
            other => other,
        }
    }

    /// Ends the simulation.
    ///
    /// # Errors
    /// [`FmuError::Order`].
    pub fn terminate(&mut self) -> Result<(), FmuError> {
        self.during("the end of the simulation", &[Phase::Step, Phase::Event, Phase::ContinuousTime])?;
        self.state.phase = Phase::Terminated;
        Ok(())
    }

    /// Returns to the state after instantiation, from any phase.
    ///
    /// # Errors
    /// None.
    pub fn reset(&mut self) -> Result<(), FmuError> {
        self.state = State::new(&self.unit, self.state.interface);
        Ok(())
    }

    /// Everything that changes, to be restored later.
    pub const fn state(&self) -> &State {
        &self.state
    }

    /// Restores a state of this or another instance of the same unit.
    ///
    /// # Errors
    /// [`FmuError::OtherState`] for a state of another unit or interface.
    pub fn restore(&mut self, state: &State) -> Result<(), FmuError> {
        let (own, n) = (&self.state, self.unit.n());
        let lists = [&state.u, &state.start_q, &state.start_v, &state.q, &state.v];
        let fits = state.fingerprint == own.fingerprint
            && state.interface == own.interface
            && state.h > 0.0
            && lists.iter().all(|list| list.len() == n);
        if !fits {
            return Err(FmuError::OtherState);
        }
        self.state = state.clone();
        Ok(())
    }

    /// Returns an error unless the phase is one of those.
    fn during(&self, call: &'static str, phases: &[Phase]) -> Result<(), FmuError> {
        let phase = self.state.phase;
        if phases.contains(&phase) { Ok(()) } else { Err(FmuError::Order { call, phase }) }
    }

    /// Returns an error unless the instance has that interface.
    fn of(&self, call: &'static str, interface: Interface) -> Result<(), FmuError> {
        let own = self.state.interface;
        let (belongs, name) = (interface.name(), own.name());
        if own == interface { Ok(()) } else { Err(FmuError::OtherInterface { call, belongs, own: name }) }
    }
}

/// Returns an error unless a number is finite in single precision.
fn finite(what: &str, value: f64) -> Result<(), FmuError> {
    let not_finite = || FmuError::NotFinite { what: what.to_owned(), value };
    if (value as f32).is_finite() { Ok(()) } else { Err(not_finite()) }
}
