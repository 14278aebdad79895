//! Steps of motions side by side that carry derivatives along: what losses over windows of many steps are made of.

mod explicit;
mod implicit;
mod runge_kutta;
mod stages;
mod tangents;

pub use explicit::ExplicitSteps;
pub use implicit::VariationalSteps;
pub use runge_kutta::RungeKutta;
pub(crate) use runge_kutta::sum;
pub use tangents::{ControlTangent, Tangents, combine_positions};

use crate::dynamics::Failures;
use crate::row::Row;

/// Positions, then velocities, or momenta where steps are of these: 2n rows, m or rad and m/s or rad/s.
pub type State = Vec<Row>;

/// Steps from state to state, samples side by side, that carry derivatives along.
pub trait Steps: Send {
    /// Makes of positions and velocities what the steps are from and to, with how it moves.
    fn begin(&mut self, weights: &[f64], state: &mut State, tangents: Option<&mut Tangents>);

    /// One step on, under controls τ at its start and end, linear between; with `tangents` also how the new state moves, of which
    /// numbers of the control each moves as `controls` says. A sample that cannot be computed is no number from here on.
    ///
    /// # Panics
    /// Where the numbers of coordinates, of learned weights or of controls do not fit.
    fn step(
        &mut self,
        weights: &[f64],
        state: &mut State,
        tau: [&[Row]; 2],
        tangents: Option<(&mut Tangents, &[ControlTangent])>,
    ) -> Failures;
}
