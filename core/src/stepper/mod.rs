//! A model, its integrator, its actuator and its state in one value, which a firmware steps.
//!
//! `leastaction export --rust` names the type that fits its file and constructs it in `stepper()`. The parts of a [`Stepper`] ([`Model`],
//! [`Del`], [`Actuator`](crate::forces::Actuator), [`State`]) remain available to programs that need only one of them.
//!
//! One step takes one command u:
//!
//! 1. The [`Drive`] computes the force τ over the step from u and the commands before it, τ(t) = g u(t − d) + o. [`Held`] commands act from
//!    the beginning of the step; with [`Linear`] commands, u is the sample at the end of the step, and the previous command the sample at
//!    its beginning. With a delay d (whole steps and a fraction), τ depends on older commands, which the drive keeps; with a lag,
//!    T ẏ = u(t − d) − y and τ = g y + o, it depends on y at the beginning of the step, which the drive keeps too.
//! 2. [`Del::step`] advances the state under τ.
//!
//! Graphs, whose particles may be held by rods, are stepped by RATTLE in a [`ParticleStepper`] with the same calls.
//!
//! The kind of control, the actuator and the number of kept commands are part of the stepper's type, so an image has
//! code and memory only for what its file needs. A file that needs something else is refused when it is loaded.

mod drive;
mod particles;

pub use drive::{Actuated, Actuation, Direct, Drive, Held, Kept, Kind, Lagged, Linear};
pub use particles::{ParticleMemory, ParticleStepper, particle_numbers};

use crate::discrete::{Del, Newton, Path, Report, State, StepError};
use crate::forces::{Forces, System};
use crate::lagrangian::Lagrangian;
use crate::model::{Model, ModelError, TrainedStep};

/// A model `M` in N coordinates, stepped along paths of type `P` under the commands of a drive `D`.
///
/// Before the start, the position is NaN and steps are refused with [`StepError::NotFinite`]; all commands before the
/// first are 0. An error leaves the stepper unchanged.
///
/// ```
/// # use leastaction_core::discrete::Galerkin;
/// # use leastaction_core::model::InertiaNetworkModel;
/// # use leastaction_core::stepper::{Direct, Drive, Held, Stepper};
/// # fn run(file: &'static [u8]) -> Result<(), Box<dyn core::error::Error>> {
/// // What `leastaction export --rust` writes for a cart-pole of order 4, its commands held:
/// type Model = InertiaNetworkModel<'static, 2, 32, 2>;
/// type CartPole = Stepper<Model, Galerkin, Drive<Held, Direct, 2, 0>, 2>;
///
/// let mut stepper = CartPole::new(Model::load(file)?)?;
/// stepper.start([0.0, 0.1], [0.0, 0.0])?;
/// let report = stepper.step([0.25, 0.0])?;
/// assert!(report.iterations <= 4);
/// let (q, v) = (stepper.q(), stepper.v()?);
/// # let _ = (q, v);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Stepper<M, P, D, const N: usize> {
    model: M,
    del: Del<f32, P>,
    drive: D,
    state: State<f32, N>,
}

impl<'a, L, F, P, K, A, const N: usize, const PAST: usize>
    Stepper<Model<'a, System<L, F>>, P, Drive<K, A, N, PAST>, N>
where
    L: Lagrangian<f32, N>,
    F: Forces<f32, N>,
    P: Path,
    K: Kind,
    A: Actuation<N>,
{
    /// Creates a stepper with the step, the order, the kind of control and the actuator of the file.
    ///
    /// # Errors
    /// [`ModelError::NoStep`] if the model was trained without steps; [`ModelError::Order`], [`ModelError::Control`],
    /// [`ModelError::Actuator`], [`ModelError::Lag`] and [`ModelError::Shape`] if the file does not match the types.
    pub fn new(model: Model<'a, System<L, F>>) -> Result<Self, ModelError> {
        let (step, sections) = (model.step()?, model.sections);
        Self::over(model, step, Drive::new(A::load(&sections, step.h)?)?)
    }

    /// Creates a stepper with steps of h seconds, whatever the model was trained with; it is less accurate than with the trained step.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] unless h is positive and finite; else the errors of [`Stepper::new`] except `NoStep`.
    pub fn with_step(model: Model<'a, System<L, F>>, h: f32) -> Result<Self, ModelError> {
        let step = TrainedStep { order: P::ORDER, h, control: K::KIND }.checked()?;
        let sections = model.sections;
        Self::over(model, step, Drive::new(A::load(&sections, h)?)?)
    }

    /// Creates a stepper with the step of the model, and the caller's drive instead of the actuator of the file.
    ///
    /// # Errors
    /// [`ModelError::NoStep`], [`ModelError::Order`] and [`ModelError::Control`] as for [`Stepper::new`].
    pub fn with_drive(
        model: Model<'a, System<L, F>>,
        drive: Drive<K, A, N, PAST>,
    ) -> Result<Self, ModelError> {
        let step = model.step()?;
        Self::over(model, step, drive)
    }

    fn over(
        model: Model<'a, System<L, F>>,
        step: TrainedStep,
        drive: Drive<K, A, N, PAST>,
    ) -> Result<Self, ModelError> {
        step.check_control(K::KIND)?;
        Ok(Self { model, del: step.del()?, drive, state: State::unknown() })
    }

    /// Replaces the bounds of Newton's method.
    #[must_use]
    pub fn with_newton(self, newton: Newton<f32>) -> Self {
        Self { del: Del::with_newton(self.del.h(), newton), ..self }
    }

    /// Starts at position q (m or rad) with velocity v (m/s or rad/s). Delayed and lagging commands stay in memory.
    ///
    /// # Errors
    /// [`StepError::NotFinite`] if the resulting state is not finite.
    pub fn start(&mut self, q: [f32; N], v: [f32; N]) -> Result<(), StepError<f32>> {
        self.state = State::new(&self.model.system.lagrangian, q, v)?;
        Ok(())
    }

    /// Starts at the second of two positions one step apart; `u` is the command of that step, as in [`Stepper::step`]. No velocity is
    /// needed.
    ///
    /// # Errors
    /// See [`Del::start`].
    pub fn start_from(&mut self, [q0, q1]: [[f32; N]; 2], u: [f32; N]) -> Result<(), StepError<f32>> {
        let (force, after) = self.drive.advanced(&u)?;
        self.state = self.del.start(&self.model.system, &q0, &q1, &force)?;
        self.drive.advance(u, after);
        Ok(())
    }

    /// Takes a command without a step: a command that was sent before the start (call this for each, oldest first)
    /// or, for linear commands, the sample at the start.
    ///
    /// # Errors
    /// [`StepError::NotFinite`] if the force of the command is not finite.
    pub fn commanded(&mut self, u: [f32; N]) -> Result<(), StepError<f32>> {
        let (_, after) = self.drive.advanced(&u)?;
        self.drive.advance(u, after);
        Ok(())
    }

    /// Takes one step under the command `u`.
    ///
    /// # Errors
    /// See [`Del::step`]. If a past command is the cause, the next step is refused for the same reason:
    /// [`Stepper::commanded`] moves past that command, and [`Stepper::start`] starts again.
    pub fn step(&mut self, u: [f32; N]) -> Result<Report<f32>, StepError<f32>> {
        let (force, after) = self.drive.advanced(&u)?;
        let report = self.del.step(&self.model.system, &mut self.state, &force)?;
        self.drive.advance(u, after);
        Ok(report)
    }

    /// Velocity v = M⁻¹p, m/s or rad/s.
    ///
    /// # Errors
    /// [`StepError::NotFinite`] before the start, [`StepError::Singular`] if M is singular.
    pub fn v(&self) -> Result<[f32; N], StepError<f32>> {
        self.state.velocity(&self.model.system.lagrangian)
    }
}

impl<M, P: Path, D, const N: usize> Stepper<M, P, D, N> {
    /// Position q, m or rad.
    pub fn q(&self) -> [f32; N] {
        self.state.q()
    }

    /// Momentum p, kg m/s or kg m²/s.
    pub fn p(&self) -> [f32; N] {
        self.state.p()
    }

    /// Step size h, s.
    pub const fn h(&self) -> f32 {
        self.del.h()
    }

    /// The model: energies, accelerations, the range of its training data.
    pub const fn model(&self) -> &M {
        &self.model
    }

    /// The discrete state.
    pub const fn state(&self) -> &State<f32, N> {
        &self.state
    }
}
