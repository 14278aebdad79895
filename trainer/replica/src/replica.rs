use crate::coordinates::{Beginning, motion};
use crate::particles::{ParticleEvaluator, ParticleMotion};
use crate::sizes::AnySystem;
use crate::watch::watch;
use crate::{
    Actuators, Control, Evaluator, Motion, ParticleSystem, ReplicaError, Step, SystemOf, Visitor, Watch,
};
use leastaction_core::discrete::Newton;
use leastaction_core::model::{
    ActuatorBytes, CoordinateRange, ModelError, Outside, TrainedStep, TrainingRange,
};
use leastaction_core::observer::Tuning;

/// A model as the chip has it: evaluated and stepped in single precision by core itself, whatever its size.
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

    /// The step that the model was trained with, where it was.
    pub fn trained_step(&self) -> Option<TrainedStep> {
        self.trained_step
    }

    /// Hands the system itself to a visitor, its size being a type: for loops that are written for core's types.
    pub fn visit<'c, V: Visitor<'c>>(&'c self, visitor: V) -> V::Output {
        self.system.visit(visitor)
    }

    /// Evaluates energies and accelerations.
    ///
    /// # Errors
    /// [`ReplicaError::Constraint`] for rods that cannot be; none of a file that was read.
    pub fn evaluator(&self) -> Result<Box<dyn Evaluator + '_>, ReplicaError> {
        self.visit(Evaluate)
    }

    /// The motion from a position and a velocity.
    ///
    /// # Errors
    /// [`ReplicaError::Length`]; where a number is not finite, or positions are off their rods.
    pub fn motion_at(&self, step: Step, q: &[f32], v: &[f32]) -> Result<Box<dyn Motion + '_>, ReplicaError> {
        self.visit(Begin { step, beginning: Beginning::At { q, v } })
    }

    /// The motion from two positions one step apart and the control between them; it begins at the second. No velocity is
    /// needed.
    ///
    /// # Errors
    /// As [`Replica::motion_at`]; where the step between them cannot be solved.
    pub fn motion_between(
        &self,
        step: Step,
        q: [&[f32]; 2],
        control: Control,
    ) -> Result<Box<dyn Motion + '_>, ReplicaError> {
        self.visit(Begin { step, beginning: Beginning::Between { q, control } })
    }

    /// The observer of the firmware, which steps the model within Newton's bounds; `angle` says of every coordinate whether its encoder
    /// forgets whole turns.
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

    /// From commands to forces in steps of h seconds, as the file has it.
    ///
    /// # Errors
    /// [`ReplicaError::Model`] where the actuator is of another number of coordinates, or its delay is more than 65,535 steps.
    pub fn actuators(&self, h: f32) -> Result<Actuators, ReplicaError> {
        Actuators::new(self.actuator, self.n(), h)
    }

    /// What of a state and control lies outside of the training data, if anything; `None` also where the file does not say
    /// what they covered.
    ///
    /// # Errors
    /// [`ReplicaError::Length`]; [`ReplicaError::Model`] where the range is of another number of coordinates.
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

/// Counts coordinates.
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

/// Makes evaluators.
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

/// Begins motions.
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

/// Makes observers.
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
