use leastaction_core::continuous::{self, ContinuousState};
use leastaction_core::discrete::{Control, Del, Path, Report, State, StepError};
use leastaction_core::forces::{Forces, System};
use leastaction_core::lagrangian::{Energies, Hessian, Lagrangian};
use leastaction_core::linear;

/// A system in N coordinates that can be simulated and controlled in f32: what plants and models have in common.
///
/// Every [`System`] of a Lagrangian with an invertible mass matrix is one.
pub trait Mechanism<const N: usize> {
    /// T(q, v) and V(q), J.
    fn energies(&self, q: &[f32; N], v: &[f32; N]) -> Energies<f32>;
    /// All derivatives of L at (q, v).
    fn hessian(&self, q: &[f32; N], v: &[f32; N]) -> Hessian<f32, N>;
    /// ∂Q/∂q and ∂Q/∂v of the damping.
    fn damping(&self, q: &[f32; N], v: &[f32; N]) -> ([[f32; N]; N], [[f32; N]; N]);
    /// M(q)a.
    fn inertial_force(&self, q: &[f32; N], a: &[f32; N]) -> [f32; N];
    /// v = M⁻¹p.
    fn velocity(&self, q: &[f32; N], p: &[f32; N]) -> Result<[f32; N], StepError<f32>>;
    /// The control that produces the acceleration a.
    fn inverse_dynamics(&self, q: &[f32; N], v: &[f32; N], a: &[f32; N]) -> Result<[f32; N], StepError<f32>>;
    /// One Runge–Kutta step of h seconds under a held control.
    fn rk4_step(
        &self,
        state: &ContinuousState<f32, N>,
        u: &[f32; N],
        h: f32,
    ) -> Result<ContinuousState<f32, N>, StepError<f32>>;
    /// The discrete state at rest or in motion at (q, v).
    fn state(&self, q: [f32; N], v: [f32; N]) -> Result<State<f32, N>, StepError<f32>>;
    /// The discrete state at q₁ from two positions and the control held between them.
    fn start<P: Path>(
        &self,
        del: &Del<f32, P>,
        q: [&[f32; N]; 2],
        u: &[f32; N],
    ) -> Result<State<f32, N>, StepError<f32>>;
    /// One discrete Euler–Lagrange step under a held control; on error the state is what it was.
    fn del_step<P: Path>(
        &self,
        del: &Del<f32, P>,
        state: &mut State<f32, N>,
        u: &[f32; N],
    ) -> Result<Report<f32>, StepError<f32>>;
}

impl<L, F, const N: usize> Mechanism<N> for System<L, F>
where
    L: Lagrangian<f32, N>,
    F: Forces<f32, N>,
{
    fn energies(&self, q: &[f32; N], v: &[f32; N]) -> Energies<f32> {
        self.lagrangian.energies(q, v)
    }

    fn hessian(&self, q: &[f32; N], v: &[f32; N]) -> Hessian<f32, N> {
        self.lagrangian.hessian(q, v)
    }

    fn damping(&self, q: &[f32; N], v: &[f32; N]) -> ([[f32; N]; N], [[f32; N]; N]) {
        self.forces.derivatives(q, v, &[0.0; N])
    }

    fn inertial_force(&self, q: &[f32; N], a: &[f32; N]) -> [f32; N] {
        // L_v is linear in v: the momentum of a "velocity" a is Ma.
        self.lagrangian.dynamics(q, a).l_v
    }

    fn velocity(&self, q: &[f32; N], p: &[f32; N]) -> Result<[f32; N], StepError<f32>> {
        Ok(linear::solve(self.lagrangian.dynamics(q, &[0.0; N]).mass, *p)?)
    }

    fn inverse_dynamics(&self, q: &[f32; N], v: &[f32; N], a: &[f32; N]) -> Result<[f32; N], StepError<f32>> {
        continuous::inverse_dynamics(self, q, v, a)
    }

    fn rk4_step(
        &self,
        state: &ContinuousState<f32, N>,
        u: &[f32; N],
        h: f32,
    ) -> Result<ContinuousState<f32, N>, StepError<f32>> {
        Ok(continuous::rk4_step(self, state, u, h)?)
    }

    fn state(&self, q: [f32; N], v: [f32; N]) -> Result<State<f32, N>, StepError<f32>> {
        State::new(&self.lagrangian, q, v)
    }

    fn start<P: Path>(
        &self,
        del: &Del<f32, P>,
        [q0, q1]: [&[f32; N]; 2],
        u: &[f32; N],
    ) -> Result<State<f32, N>, StepError<f32>> {
        del.start(self, q0, q1, &Control::held(*u))
    }

    fn del_step<P: Path>(
        &self,
        del: &Del<f32, P>,
        state: &mut State<f32, N>,
        u: &[f32; N],
    ) -> Result<Report<f32>, StepError<f32>> {
        del.step(self, state, &Control::held(*u))
    }
}
