use crate::error::{SetupError, require};
use leastaction_core::continuous::{self, ContinuousState};
use leastaction_core::discrete::StepError;
use leastaction_core::forces::{Forces, System};
use leastaction_core::lagrangian::{Energies, Lagrangian};
use leastaction_core::linear;
use leastaction_core::model::TrainedStep;
use leastaction_core::scalar::max_abs;

/// A system in N coordinates that can be simulated and controlled in f32: the common interface of plants and models.
///
/// Every [`System`] of a Lagrangian with an invertible mass matrix is a mechanism. A learned system is passed as [`Trained`], with the step
/// that its file names.
///
/// A plant may have any kinetic energy. Observers and controllers assume T = ½ vᵀM(q)v, and so p = M(q)v: programs and predictions refuse
/// models with any other kinetic energy ([`require_quadratic`]).
pub trait Mechanism<const N: usize> {
    /// Lagrangian of the mechanism.
    type Lagrangian: Lagrangian<f32, N>;
    /// The forces other than the control.
    type Forces: Forces<f32, N>;

    /// The Lagrangian with its forces.
    fn system(&self) -> &System<Self::Lagrangian, Self::Forces>;

    /// Step and order that a model was trained for, if it names them.
    fn trained_step(&self) -> Option<TrainedStep> {
        None
    }

    /// The model as it was learned, if its numbers follow the machine: plans were made for it.
    fn of_file(&self) -> Option<&System<Self::Lagrangian, Self::Forces>> {
        None
    }

    /// T(q, v) and V(q), J, including the potentials that forces store.
    fn energies(&self, q: &[f32; N], v: &[f32; N]) -> Energies<f32> {
        self.system().energies(q, v)
    }

    /// The momentum p = L_v(q, v).
    fn momentum(&self, q: &[f32; N], v: &[f32; N]) -> [f32; N] {
        self.system().lagrangian.dynamics(q, v).l_v
    }

    /// M(q)a for a kinetic energy quadratic in v: the momentum of a "velocity" a.
    fn inertial_force(&self, q: &[f32; N], a: &[f32; N]) -> [f32; N] {
        self.momentum(q, a)
    }

    /// Velocity v = M(q)⁻¹p for a kinetic energy quadratic in v.
    fn velocity(&self, q: &[f32; N], p: &[f32; N]) -> Result<[f32; N], StepError<f32>> {
        Ok(linear::solve(self.system().lagrangian.linearization(q, &[0.0; N]).l_vv, *p)?)
    }

    /// The control that produces the acceleration a.
    fn inverse_dynamics(&self, q: &[f32; N], v: &[f32; N], a: &[f32; N]) -> Result<[f32; N], StepError<f32>> {
        continuous::inverse_dynamics(self.system(), q, v, a)
    }

    /// Takes one Runge–Kutta step of h seconds under a held control.
    fn rk4_step(
        &self,
        state: &ContinuousState<f32, N>,
        u: &[f32; N],
        h: f32,
    ) -> Result<ContinuousState<f32, N>, StepError<f32>> {
        Ok(continuous::rk4_step(self.system(), state, u, h)?)
    }
}

impl<L, F, const N: usize> Mechanism<N> for System<L, F>
where
    L: Lagrangian<f32, N>,
    F: Forces<f32, N>,
{
    type Lagrangian = L;
    type Forces = F;

    fn system(&self) -> &System<L, F> {
        self
    }
}

/// A learned system with the step it was trained for, as in a model file.
///
/// A model learned through a discrete step has absorbed the error of that step, and is less accurate with another
/// step. Programs and predictions with another step or order are refused, unless
/// [`OtherStep::Accepted`](crate::observer::OtherStep) is set.
#[derive(Clone, Copy, Debug)]
pub struct Trained<'a, L, F> {
    /// The Lagrangian with its forces.
    pub system: &'a System<L, F>,
    /// Order and step in training; `None` for a model learned without steps.
    pub step: Option<TrainedStep>,
}

impl<L, F, const N: usize> Mechanism<N> for Trained<'_, L, F>
where
    L: Lagrangian<f32, N>,
    F: Forces<f32, N>,
{
    type Lagrangian = L;
    type Forces = F;

    fn system(&self) -> &System<L, F> {
        self.system
    }

    fn trained_step(&self) -> Option<TrainedStep> {
        self.step
    }
}

/// A model whose numbers follow the machine, with those in use.
#[derive(Clone, Copy, Debug)]
pub struct InUse<'a, L, F> {
    /// The model with the numbers in use.
    pub used: System<L, F>,
    /// The model as it was learned.
    pub of_file: &'a System<L, F>,
}

impl<L, F, const N: usize> Mechanism<N> for InUse<'_, L, F>
where
    L: Lagrangian<f32, N>,
    F: Forces<f32, N>,
{
    type Lagrangian = L;
    type Forces = F;

    fn system(&self) -> &System<L, F> {
        &self.used
    }

    fn of_file(&self) -> Option<&System<L, F>> {
        Some(self.of_file)
    }
}

/// Speeds at which a kinetic energy is tested, rad/s or m/s.
const SPEEDS: [f32; 3] = [0.25, 1.0, 4.0];
/// Largest accepted difference between L_v and M(q)v, as a fraction of M(q)v.
const QUADRATIC: f32 = 1e-3;

/// Checks that p = L_v(q, v) is M(q)v, as for a kinetic energy quadratic in v, at speeds of 0.25, 1 and 4 rad/s or m/s.
///
/// # Errors
/// An error if they differ by more than 0.1%, as for a graph with a network for its kinetic energy.
pub fn require_quadratic<M: Mechanism<N>, const N: usize>(model: &M, q: &[f32; N]) -> Result<(), SetupError> {
    let mass = model.system().lagrangian.linearization(q, &[0.0; N]).l_vv;
    SPEEDS.into_iter().try_for_each(|speed| {
        // Direction neither along a coordinate nor along a diagonal.
        let v = core::array::from_fn(|i| if i % 2 == 0 { speed } else { -0.7 * speed });
        let (found, expected) = (model.momentum(q, &v), linear::multiply(&mass, &v));
        let difference = max_abs(&linear::add_scaled(&found, -1.0, &expected));
        let size = max_abs(&expected);
        require(
            "difference of the model's momentum L_v and M(q)v, as a fraction",
            difference / size,
            difference <= QUADRATIC * size,
            "at most 0.001: observers and controllers take a kinetic energy that is quadratic in v",
        )
    })
}
