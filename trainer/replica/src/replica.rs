use crate::adaptation::Adapt;
use crate::coordinates::{Beginning, motion};
use crate::particles::{ParticleEvaluator, ParticleMotion};
use crate::sizes::AnySystem;
use crate::watch::watch;
use crate::{
    Actuators, Adaptation, AdapterSettings, Control, Evaluator, Motion, ParticleSystem, ReplicaError,
    StateVisitor, Step, SystemOf, Visitor, Watch,
};
use leastaction_core::discrete::Newton;
use leastaction_core::model::{
    ActuatorBytes, CoordinateRange, ModelError, Outside, TrainedStep, TrainingRange,
};
use leastaction_core::observer::Tuning;

/// A model as on the chip: evaluated and stepped in single precision by core itself, whatever its size.
pub struct Replica<'f> {
    system: AnySystem<'f>,
    trained_step: Option<TrainedStep>,
    range: Option<TrainingRange<'f>>,
    actuator: Option<ActuatorBytes<'f>>,
}

impl<'f> Replica<'f> {
    pub(crate) fn new(
        system: AnySystem<'f>,
        trained_step: Option<TrainedStep>,
        range: Option<TrainingRange<'f>>,
        actuator: Option<ActuatorBytes<'f>>,
    ) -> Self {
        Self { system, trained_step, range, actuator }
    }

    pub(crate) fn system(&self) -> &AnySystem<'f> {
        &self.system
    }

    /// Number of coordinates n.
    pub fn n(&self) -> usize {
        self.visit(Size)
    }

    /// Step that the model was trained with, if any.
    pub fn trained_step(&self) -> Option<TrainedStep> {
        self.trained_step
    }

    /// Passes the system itself to a visitor, with its size as a type: for loops that are written for core's types.
    pub fn visit<'c, V: Visitor<'c>>(&'c self, visitor: V) -> V::Output {
        self.system.visit(visitor)
    }

    /// Passes the system to a visitor with the sizes of its position and of its state as types.
    pub fn visit_states<'c, V: StateVisitor<'c>>(&'c self, visitor: V) -> V::Output {
        self.system.visit_states(visitor)
    }

    /// Creates an evaluator of energies and accelerations.
    ///
    /// # Errors
    /// [`ReplicaError::Constraint`] for invalid rods; never for a file that was read.
    pub fn evaluator(&self) -> Result<Box<dyn Evaluator + '_>, ReplicaError> {
        self.visit(Evaluate)
    }

    /// Begins a motion at a position and a velocity.
    ///
    /// # Errors
    /// [`ReplicaError::Length`]; an error if a number is not finite or positions are off their rods.
    pub fn motion_at(&self, step: Step, q: &[f32], v: &[f32]) -> Result<Box<dyn Motion + '_>, ReplicaError> {
        self.visit(Begin { step, beginning: Beginning::At { q, v } })
    }

    /// Begins a motion at the second of two positions one step apart, with the control between them. No velocity is needed.
    ///
    /// # Errors
    /// See [`Replica::motion_at`]; also an error if the step between the positions cannot be solved.
    pub fn motion_between(
        &self,
        step: Step,
        q: [&[f32]; 2],
        control: Control,
    ) -> Result<Box<dyn Motion + '_>, ReplicaError> {
        self.visit(Begin { step, beginning: Beginning::Between { q, control } })
    }

    /// Continues a motion from the numbers that [`Motion::saved`] returned, with the same bits if the step is the same.
    ///
    /// # Errors
    /// An error if the numbers are not finite, or not those of a motion of this model.
    pub fn motion_resumed(&self, step: Step, saved: &[f32]) -> Result<Box<dyn Motion + '_>, ReplicaError> {
        self.visit(Begin { step, beginning: Beginning::Resumed(saved) })
    }

    /// Creates the observer of the firmware, which steps the model within the limits of `newton`; `angle` says for every coordinate whether
    /// its encoder loses whole turns.
    ///
    /// # Errors
    /// [`ReplicaError::Length`]; [`ReplicaError::OfGraph`].
    pub fn watch(
        &self,
        (step, newton): (Step, Newton<f32>),
        angle: &[bool],
        tuning: Tuning<f32>,
    ) -> Result<Box<dyn Watch + '_>, ReplicaError> {
        self.visit(Observe { step, newton, angle, tuning })
    }

    /// Creates the adapter of the firmware.
    ///
    /// # Errors
    /// [`ReplicaError::Length`], [`ReplicaError::Settings`], [`ReplicaError::Unfit`]; [`ReplicaError::OfGraph`].
    pub fn adaptation(&self, settings: &AdapterSettings) -> Result<Box<dyn Adaptation + '_>, ReplicaError> {
        self.visit(Adapt(settings))
    }

    /// Creates the file's converter of commands to forces, for steps of h seconds.
    ///
    /// # Errors
    /// [`ReplicaError::Model`] if the actuator has a different number of coordinates, or its delay is more than
    /// 65,535 steps.
    pub fn actuators(&self, h: f32) -> Result<Actuators, ReplicaError> {
        Actuators::new(self.actuator, self.n(), h)
    }

    /// First quantity of a state and control that lies outside the training data; `None` if there is none, or if the file does not state
    /// the range of the data.
    ///
    /// # Errors
    /// [`ReplicaError::Length`]; [`ReplicaError::Model`] if the range has a different number of coordinates.
    pub fn outside(&self, q: &[f32], v: &[f32], u: &[f32]) -> Result<Option<Outside>, ReplicaError> {
        let n = self.n();
        for (what, x) in [("q", q), ("v", v), ("u", u)] {
            ReplicaError::check_length(what, n, x.len())?;
        }
        let Some(range) = self.range else { return Ok(None) };
        if range.n() != n {
            let what = "coordinates of the training range";
            return Err(ModelError::Shape { what, found: range.n(), compiled: n }.into());
        }
        let (each, _) = range.bytes().as_chunks::<{ CoordinateRange::BYTES }>();
        for (coordinate, (((range, q), v), u)) in each.iter().zip(q).zip(v).zip(u).enumerate() {
            let outside = TrainingRange::new(range)?.outside(&[*q], &[*v], &[*u])?;
            if let Some(Outside { quantity, .. }) = outside {
                return Ok(Some(Outside { coordinate, quantity }));
            }
        }
        Ok(None)
    }
}

/// Visitor that counts coordinates.
struct Size;

impl Visitor<'_> for Size {
    type Output = usize;

    fn coordinates<const N: usize>(self, _: &SystemOf<N>) -> usize {
        N
    }

    fn particles<const D: usize>(self, particles: &ParticleSystem<D>) -> usize {
        particles.n()
    }
}

/// Visitor that creates evaluators.
struct Evaluate;

impl<'c> Visitor<'c> for Evaluate {
    type Output = Result<Box<dyn Evaluator + 'c>, ReplicaError>;

    fn coordinates<const N: usize>(self, system: &'c SystemOf<'c, N>) -> Self::Output {
        Ok(Box::new(system))
    }

    fn particles<const D: usize>(self, particles: &'c ParticleSystem<'c, D>) -> Self::Output {
        Ok(Box::new(ParticleEvaluator::new(particles)?))
    }
}

/// Visitor that begins motions.
struct Begin<'b> {
    step: Step,
    beginning: Beginning<'b>,
}

impl<'c> Visitor<'c> for Begin<'_> {
    type Output = Result<Box<dyn Motion + 'c>, ReplicaError>;

    fn coordinates<const N: usize>(self, system: &'c SystemOf<'c, N>) -> Self::Output {
        motion(system, self.step, self.beginning)
    }

    fn particles<const D: usize>(self, particles: &'c ParticleSystem<'c, D>) -> Self::Output {
        Ok(Box::new(ParticleMotion::new(particles, self.step, self.beginning)?))
    }
}

/// Visitor that creates observers.
struct Observe<'b> {
    step: Step,
    newton: Newton<f32>,
    angle: &'b [bool],
    tuning: Tuning<f32>,
}

impl<'c> Visitor<'c> for Observe<'_> {
    type Output = Result<Box<dyn Watch + 'c>, ReplicaError>;

    fn coordinates<const N: usize>(self, system: &'c SystemOf<'c, N>) -> Self::Output {
        watch(system, (self.step, self.newton), self.angle, self.tuning)
    }

    fn particles<const D: usize>(self, _: &'c ParticleSystem<'c, D>) -> Self::Output {
        Err(ReplicaError::OfGraph { what: "observer" })
    }
}
