use super::setup::CART_AND_POLE;
use super::{Setup, Start};
use crate::angle::difference;
use crate::devices::{Devices, EncoderConfig};
use crate::error::{SetupError, require};
use crate::mechanism::{Mechanism, require_quadratic};
use crate::observer::{Integrator, ObserverConfig, Order};
use crate::plant::Plant;
use crate::summary::{Goal, Recorder, Summary};
use crate::tick::{Mode, Tick};
use core::f32::consts::{PI, TAU};
use leastaction_core::continuous::ContinuousState;
use leastaction_core::discrete::{Control, Report, State, StepError};
use leastaction_core::scalar::Scalar;

/// A force on every coordinate, u_i = amplitude · sin(2πft), held over each tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Excitation<const N: usize> {
    /// Amplitude, N or N m; limited by the actuators.
    pub amplitude: [f32; N],
    /// Frequency f, Hz.
    pub frequency: [f32; N],
}

impl<const N: usize> Excitation<N> {
    /// The force of the tick at time t, s.
    pub fn at(&self, t: f32) -> [f32; N] {
        core::array::from_fn(|i| self.amplitude[i] * Scalar::sin_cos(TAU * self.frequency[i] * t).0)
    }

    fn validate(&self) -> Result<(), SetupError> {
        self.amplitude
            .iter()
            .chain(&self.frequency)
            .try_for_each(|x| require("excitation", *x, x.is_finite(), "finite"))
    }
}

/// A comparison: the model is stepped beside the plant under the same force, without feedback. There is no encoder,
/// no clock and no delay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Predict<const N: usize> {
    /// The loop; of its devices, only the limits and the flags of angles are used.
    pub setup: Setup<N>,
    /// Force on plant and model.
    pub excitation: Excitation<N>,
}

impl<const N: usize> Predict<N> {
    /// Creates a run of 5 s in ticks of 10 ms at order 4; errors must stay within 0.01 rad or m throughout.
    const fn new(
        encoders: [EncoderConfig; N],
        limit: [f32; N],
        start: Start<N>,
        excitation: Excitation<N>,
    ) -> Self {
        let devices = Devices::new(encoders, limit);
        let goal = Goal { tolerance: [0.01; N], hold: f32::INFINITY, bounds: [f32::INFINITY; N] };
        let setup = Setup {
            seconds: 5.0,
            observer: ObserverConfig { order: Order::Four, ..ObserverConfig::new() },
            ..Setup::new(start, devices, goal)
        };
        Self { setup, excitation }
    }

    fn validate(&self) -> Result<(), SetupError> {
        self.setup.validate()?;
        self.excitation.validate()
    }
}

impl Predict<1> {
    /// The pendulum from any angle, excited by 2 N m at 0.5 Hz.
    pub const fn pendulum() -> Self {
        let start = Start { q: [PI], q_spread: [2.0], v_spread: [1.0] };
        Self::new([EncoderConfig::rotary()], [2.0], start, Excitation { amplitude: [2.0], frequency: [0.5] })
    }
}

impl Predict<2> {
    /// The cart-pole with the pole at any angle below the horizontal, excited by 2 N on the cart at 0.5 Hz.
    pub const fn cartpole() -> Self {
        let start = Start { q: [0.0, PI], q_spread: [0.5, 1.5], v_spread: [0.05, 1.0] };
        let excitation = Excitation { amplitude: [2.0, 0.0], frequency: [0.5; 2] };
        Self::new(CART_AND_POLE, [10.0, 0.0], start, excitation)
    }

    /// The acrobot from hanging, where it is not chaotic, excited by 2 N m on the second joint at 0.5 Hz.
    pub const fn acrobot() -> Self {
        let start = Start { q: [0.0; 2], q_spread: [1.0; 2], v_spread: [0.5; 2] };
        let excitation = Excitation { amplitude: [0.0, 2.0], frequency: [0.5; 2] };
        Self::new([EncoderConfig::rotary(); 2], [0.0, 2.0], start, excitation)
    }
}

/// The model's side of the comparison.
struct Forecast<'a, M, const N: usize> {
    model: &'a M,
    integrator: Integrator<f32>,
    state: Option<State<f32, N>>,
    position: [f32; N],
    velocity: [f32; N],
    newton: Report<f32>,
    mode: Mode,
}

impl<'a, M: Mechanism<N>, const N: usize> Forecast<'a, M, N> {
    fn new(model: &'a M, setup: &Setup<N>, q0: [f32; N]) -> Self {
        Self {
            model,
            integrator: Integrator::new(setup.observer.order, setup.tick, setup.observer.newton),
            state: None,
            position: q0,
            velocity: [0.0; N],
            newton: Report { iterations: 0, residual: 0.0 },
            mode: Mode::Wait,
        }
    }

    /// Takes one tick under a force. The first tick starts the model with the plant's position q₁; no velocity is
    /// needed.
    fn advance(&mut self, u: &[f32; N], q1: &[f32; N]) -> Result<(), StepError<f32>> {
        self.mode = Mode::Safe;
        let u = Control::held(*u);
        let state = match self.state {
            None => self.integrator.start(self.model.system(), [&self.position, q1], &u)?,
            Some(mut state) => {
                self.newton = self.integrator.step(self.model.system(), &mut state, &u)?;
                state
            }
        };
        self.velocity = self.model.velocity(&state.q(), &state.p())?;
        (self.position, self.state, self.mode) = (state.q(), Some(state), Mode::Open);
        Ok(())
    }

    fn tick(
        &self,
        index: u32,
        h: f32,
        truth: &ContinuousState<f32, N>,
        u: [f32; N],
        angle: &[bool; N],
    ) -> Tick<N> {
        Tick {
            index,
            time: index as f32 * h,
            q: truth.q,
            v: truth.v,
            measured: truth.q.map(Some),
            q_estimate: self.position,
            v_estimate: self.velocity,
            reference: self.position,
            error: difference(&truth.q, &self.position, angle),
            commanded: u,
            applied: u,
            newton: self.newton,
            lateness: 0.0,
            missed: false,
            mode: self.mode,
        }
    }
}

/// Steps the model beside the plant under the same force, from the plant's first two positions.
///
/// The error of a tick is the plant's position minus the model's; the measured position is the true one. If a step is refused, the model
/// stays where it was.
///
/// # Errors
/// Numbers out of range, a step that the model was not trained for, and a kinetic energy that is not quadratic in v.
pub fn predict<P: Mechanism<N>, M: Mechanism<N>, const N: usize>(
    plant: &P,
    model: &M,
    config: &Predict<N>,
    mut sink: impl FnMut(&Tick<N>),
) -> Result<Summary<N>, SetupError> {
    config.validate()?;
    let setup = &config.setup;
    setup.observer.check_step(setup.tick, model.trained_step())?;
    require_quadratic(model, &setup.start.q)?;
    let angle = setup.devices.angles();
    let mut plant = Plant::new(plant, setup.start.draw(setup.seed), setup.substeps);
    let mut forecast = Forecast::new(model, setup, plant.state().q);
    let mut recorder = Recorder::new(setup.goal, angle);
    for index in 0..setup.ticks() {
        let u = setup.devices.actuator.saturate(&config.excitation.at(index as f32 * setup.tick));
        let tick = forecast.tick(index, setup.tick, plant.state(), u, &angle);
        recorder.record(&tick);
        sink(&tick);
        let moved = plant.advance(setup.tick, |_| u);
        let stepped = forecast.advance(&u, &plant.state().q);
        recorder.errors(stepped.is_err().into(), moved.is_err().into());
    }
    Ok(recorder.finish())
}
