//! Steps of motions side by side that carry derivatives along: the basis of losses over windows of many steps.

mod explicit;
mod implicit;
mod runge_kutta;
mod stages;
mod strikes;
mod tangents;
mod velocities;

pub use explicit::ExplicitSteps;
pub use implicit::VariationalSteps;
pub use runge_kutta::RungeKutta;
pub(crate) use runge_kutta::sum;
pub use tangents::{ControlTangent, Tangents, combine_positions};

use crate::dynamics::Failures;
use crate::row::Row;

/// Positions, then velocities (or momenta, if the steps use them): 2n rows, m or rad and m/s or rad/s.
pub type State = Vec<Row>;

/// Steps from state to state, with samples side by side, that carry derivatives along.
pub trait Steps: Send {
    /// Converts positions and velocities into the state that the steps use, together with its derivatives.
    fn begin(&mut self, weights: &[f64], state: &mut State, tangents: Option<&mut Tangents>);

    /// Advances the state by one step, under controls τ at its start and end, linear between them. With `tangents`, the
    /// derivatives of the state are advanced, too; the second part of the pair holds the derivatives of the control. A
    /// sample that cannot be computed is NaN from then on.
    ///
    /// # Panics
    /// If the numbers of coordinates, of learned weights or of controls do not fit.
    fn step(
        &mut self,
        weights: &[f64],
        state: &mut State,
        tau: [&[Row]; 2],
        tangents: Option<(&mut Tangents, &[ControlTangent])>,
    ) -> Failures;
}
