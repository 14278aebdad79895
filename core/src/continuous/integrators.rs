use super::{acceleration, finite};
use crate::forces::{Forces, System};
use crate::lagrangian::Lagrangian;
use crate::linear::{SolveError, add_scaled};
use crate::scalar::Real;

/// Position and velocity.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContinuousState<R, const N: usize> {
    /// Position q, m or rad.
    pub q: [R; N],
    /// Velocity v, m/s or rad/s.
    pub v: [R; N],
}

impl<R: Real, const N: usize> ContinuousState<R, N> {
    /// Moves the state by c along the rate (v, v̇).
    fn moved(&self, c: R, rate: &Self) -> Self {
        Self { q: add_scaled(&self.q, c, &rate.q), v: add_scaled(&self.v, c, &rate.v) }
    }

    fn checked(self) -> Result<Self, SolveError> {
        Ok(Self { q: finite(self.q)?, v: finite(self.v)? })
    }
}

/// Rate (v, v̇) of a state.
fn rate<R: Real, L, F, const N: usize>(
    system: &System<L, F>,
    state: &ContinuousState<R, N>,
    tau: &[R; N],
) -> Result<ContinuousState<R, N>, SolveError>
where
    L: Lagrangian<R, N>,
    F: Forces<R, N>,
{
    Ok(ContinuousState { q: state.v, v: acceleration(system, &state.q, &state.v, tau)? })
}

/// One classical Runge–Kutta step of order 4 with τ held over the step h (s).
///
/// # Errors
/// See [`acceleration`]; also if the final state is not finite.
pub fn rk4_step<R: Real, L, F, const N: usize>(
    system: &System<L, F>,
    state: &ContinuousState<R, N>,
    tau: &[R; N],
    h: R,
) -> Result<ContinuousState<R, N>, SolveError>
where
    L: Lagrangian<R, N>,
    F: Forces<R, N>,
{
    let k1 = rate(system, state, tau)?;
    let k2 = rate(system, &state.moved(h.half(), &k1), tau)?;
    let k3 = rate(system, &state.moved(h.half(), &k2), tau)?;
    let k4 = rate(system, &state.moved(h, &k3), tau)?;
    let sixth = h / R::constant(6.0);
    let third = h / R::constant(3.0);
    state.moved(sixth, &k1).moved(third, &k2).moved(third, &k3).moved(sixth, &k4).checked()
}

/// One explicit midpoint step of order 2 with τ held over the step h (s).
///
/// # Errors
/// See [`acceleration`]; also if the final state is not finite.
pub fn midpoint_step<R: Real, L, F, const N: usize>(
    system: &System<L, F>,
    state: &ContinuousState<R, N>,
    tau: &[R; N],
    h: R,
) -> Result<ContinuousState<R, N>, SolveError>
where
    L: Lagrangian<R, N>,
    F: Forces<R, N>,
{
    let k1 = rate(system, state, tau)?;
    let k2 = rate(system, &state.moved(h.half(), &k1), tau)?;
    state.moved(h, &k2).checked()
}
