//! Steps of motions side by side that carry derivatives along: what losses over windows of many steps are made of.

mod explicit;
mod runge_kutta;
mod stages;
mod tangents;

pub use explicit::ExplicitSteps;
pub use runge_kutta::RungeKutta;
pub(crate) use runge_kutta::sum;
pub use tangents::{ControlTangent, Tangents, combine_positions};

use crate::row::Row;

/// Positions, then velocities: 2n rows, m or rad and m/s or rad/s.
pub type State = Vec<Row>;
