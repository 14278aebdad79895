//! A model, its integrator, its actuator and its state as one thing, which a firmware steps.
//!
//! `leastaction export --rust` names the type that fits its file, and makes it by `stepper()`. The parts of a [`Stepper`]
//! ([`Model`], [`Del`], [`Actuator`](crate::forces::Actuator), [`State`]) remain for programs that need one of them alone.
//!
//! One step takes one command u:
//!
//! 1. The [`Drive`] makes the force τ over the step of it and of the commands before, τ(t) = g u(t − d) + o. Where commands are
//!    [`Held`], u acts from the beginning of the step; where they are [`Linear`], u is the sample at its end, and the one at its
//!    beginning is the command of the step before. A delay of whole steps and a part of one takes older commands, which are kept.
//! 2. [`Del::step`] advances the state under τ.
//!
//! Graphs, whose particles rods may hold, are stepped by RATTLE in a [`ParticleStepper`] with the same calls.
//!
//! Kind, actuator and number of commands kept are types, so that an image has code and memory for what its file says and for nothing
//! else; a file that says otherwise is refused when it is loaded.

mod drive;
mod particles;

pub use drive::{Actuated, Actuation, Direct, Drive, Held, Kind, Linear};
pub use particles::{ParticleMemory, ParticleStepper, particle_numbers};

use crate::discrete::{Del, Newton, Path, Report, State, StepError};
use crate::forces::{Forces, System};
use crate::lagrangian::Lagrangian;
use crate::model::{Model, ModelError, TrainedStep};

/// A model `M` in N coordinates that is stepped along paths of type `P` under the commands of a drive `D`.
///
/// Until it is started its position is not a number, and steps are refused as [`StepError::NotFinite`]; all commands before the first
/// are 0. On any error it is what it was.
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
    /// A stepper with the step, the order, the kind of control and the actuator of the file.
    ///
    /// # Errors
    /// [`ModelError::NoStep`] where the model was trained for none; [`ModelError::Order`], [`ModelError::Control`],
    /// [`ModelError::Actuator`] and [`ModelError::Shape`] where the types are those of another file.
    pub fn new(model: Model<'a, System<L, F>>) -> Result<Self, ModelError> {
        let (step, sections) = (model.step()?, model.sections);
        Self::over(model, step, Drive::new(A::load(&sections, step.h)?)?)
    }

    /// A stepper of a step of h seconds, whatever the model was trained with; with another it is less accurate than with its own.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] unless h is positive and finite; else those of [`Stepper::new`] but for `NoStep`.
    pub fn with_step(model: Model<'a, System<L, F>>, h: f32) -> Result<Self, ModelError> {
        let step = TrainedStep { order: P::ORDER, h, control: K::KIND }.checked()?;
        let sections = model.sections;
        Self::over(model, step, Drive::new(A::load(&sections, h)?)?)
    }

    /// A stepper with the step of the model and the caller's drive in place of the actuator of the file.
    ///
    /// # Errors
    /// [`ModelError::NoStep`], [`ModelError::Order`] and [`ModelError::Control`] as of [`Stepper::new`].
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

    /// The stepper with the caller's bounds of Newton's method.
    #[must_use]
    pub fn with_newton(self, newton: Newton<f32>) -> Self {
        Self { del: Del::with_newton(self.del.h(), newton), ..self }
    }

    /// Starts at position q (m or rad) with velocity v (m/s or rad/s). Commands on their way stay there.
    ///
    /// # Errors
    /// [`StepError::NotFinite`].
    pub fn start(&mut self, q: [f32; N], v: [f32; N]) -> Result<(), StepError<f32>> {
        self.state = State::new(&self.model.system.lagrangian, q, v)?;
        Ok(())
    }

    /// Starts at the second of two positions one step apart, `u` being the command of that step as in [`Stepper::step`]. No velocity
    /// is needed.
    ///
    /// # Errors
    /// Errors of [`Del::start`].
    pub fn start_from(&mut self, [q0, q1]: [[f32; N]; 2], u: [f32; N]) -> Result<(), StepError<f32>> {
        self.drive.check(&u)?;
        self.state = self.del.start(&self.model.system, &q0, &q1, &self.drive.force(&u))?;
        self.drive.advance(u);
        Ok(())
    }

    /// Takes a command without a step: one that was sent before the start, oldest first, or, of linear commands, the sample at the start.
    ///
    /// # Errors
    /// [`StepError::NotFinite`].
    pub fn commanded(&mut self, u: [f32; N]) -> Result<(), StepError<f32>> {
        self.drive.check(&u)?;
        self.drive.advance(u);
        Ok(())
    }

    /// One step under the command `u`.
    ///
    /// # Errors
    /// Errors of [`Del::step`]. Where the command that is refused is one of the past, the next step is refused for the same reason:
    /// [`Stepper::commanded`] goes past it, and [`Stepper::start`] begins anew.
    pub fn step(&mut self, u: [f32; N]) -> Result<Report<f32>, StepError<f32>> {
        self.drive.check(&u)?;
        let report = self.del.step(&self.model.system, &mut self.state, &self.drive.force(&u))?;
        self.drive.advance(u);
        Ok(report)
    }

    /// v = M⁻¹p, m/s or rad/s.
    ///
    /// # Errors
    /// [`StepError::NotFinite`] before the start, [`StepError::Singular`] where M is.
    pub fn v(&self) -> Result<[f32; N], StepError<f32>> {
        self.state.velocity(&self.model.system.lagrangian)
    }
}

impl<M, P: Path, D, const N: usize> Stepper<M, P, D, N> {
    /// q, m or rad.
    pub fn q(&self) -> [f32; N] {
        self.state.q()
    }

    /// p, kg m/s or kg m²/s.
    pub fn p(&self) -> [f32; N] {
        self.state.p()
    }

    /// h, s.
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
