use super::acceleration;
use crate::forces::{Forces, System};
use crate::lagrangian::Lagrangian;
use crate::linear::{Singular, add_scaled};
use crate::scalar::Real;

/// Position and velocity.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContinuousState<R, const N: usize> {
    /// q.
    pub q: [R; N],
    /// v.
    pub v: [R; N],
}

impl<R: Real, const N: usize> ContinuousState<R, N> {
    /// This state moved by c along the rate (v, v̇).
    fn moved(&self, c: R, rate: &Self) -> Self {
        Self { q: add_scaled(&self.q, c, &rate.q), v: add_scaled(&self.v, c, &rate.v) }
    }
}

/// (v, v̇) at a state.
fn rate<R: Real, L, F, const N: usize>(
    system: &System<L, F>,
    state: &ContinuousState<R, N>,
    u: &[R; N],
) -> Result<ContinuousState<R, N>, Singular>
where
    L: Lagrangian<R, N>,
    F: Forces<R, N>,
{
    Ok(ContinuousState { q: state.v, v: acceleration(system, &state.q, &state.v, u)? })
}

/// One classical Runge–Kutta step of order 4 with u held over the step h (s). An error where M is singular.
pub fn rk4_step<R: Real, L, F, const N: usize>(
    system: &System<L, F>,
    state: &ContinuousState<R, N>,
    u: &[R; N],
    h: R,
) -> Result<ContinuousState<R, N>, Singular>
where
    L: Lagrangian<R, N>,
    F: Forces<R, N>,
{
    let k1 = rate(system, state, u)?;
    let k2 = rate(system, &state.moved(h.half(), &k1), u)?;
    let k3 = rate(system, &state.moved(h.half(), &k2), u)?;
    let k4 = rate(system, &state.moved(h, &k3), u)?;
    let sixth = h / R::constant(6.0);
    let third = h / R::constant(3.0);
    Ok(state.moved(sixth, &k1).moved(third, &k2).moved(third, &k3).moved(sixth, &k4))
}

/// One explicit midpoint step of order 2 with u held over the step h (s). An error where M is singular.
pub fn midpoint_step<R: Real, L, F, const N: usize>(
    system: &System<L, F>,
    state: &ContinuousState<R, N>,
    u: &[R; N],
    h: R,
) -> Result<ContinuousState<R, N>, Singular>
where
    L: Lagrangian<R, N>,
    F: Forces<R, N>,
{
    let k1 = rate(system, state, u)?;
    let k2 = rate(system, &state.moved(h.half(), &k1), u)?;
    Ok(state.moved(h, &k2))
}
