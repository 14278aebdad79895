//! A learned model as plain functions on slices, whatever its family and size.

use crate::architecture::{Architecture, Family, Visitor};
use leastaction_core::continuous::{acceleration, energy};
use leastaction_core::model::ModelError;

/// Writes v̇(q, v), m/s² or rad/s², of a free motion; `None` where it does not exist or a slice is too short.
pub type Acceleration<'w> = Box<dyn Fn(&[f64], &[f64], &mut [f64]) -> Option<()> + Sync + 'w>;
/// The energy T + V, J; not a number where a slice is too short.
pub type Energy<'w> = Box<dyn Fn(&[f64], &[f64]) -> f64 + Sync + 'w>;

/// The accelerations that a model gives, and its own energy.
///
/// # Errors
/// Where the shape is beyond what is compiled.
pub fn functions<'w>(
    architecture: &Architecture,
    weights: &'w [f64],
) -> Result<(Acceleration<'w>, Energy<'w>), ModelError> {
    architecture.dispatch(Functions { weights })?
}

struct Functions<'w> {
    weights: &'w [f64],
}

impl<'w> Visitor for Functions<'w> {
    type Output = Result<(Acceleration<'w>, Energy<'w>), ModelError>;

    fn visit<F: Family<N>, const N: usize>(self, family: &F) -> Self::Output {
        let (system, same) = (family.system::<f64>(self.weights)?, family.system::<f64>(self.weights)?);
        let accelerations = move |q: &[f64], v: &[f64], out: &mut [f64]| {
            let (q, v) = (q.first_chunk::<N>()?, v.first_chunk::<N>()?);
            *out.first_chunk_mut::<N>()? = acceleration(&system, q, v, &[0.0; N]).ok()?;
            Some(())
        };
        let energies = move |q: &[f64], v: &[f64]| match (q.first_chunk::<N>(), v.first_chunk::<N>()) {
            (Some(q), Some(v)) => energy(&same.lagrangian, q, v),
            _ => f64::NAN,
        };
        Ok((Box::new(accelerations), Box::new(energies)))
    }
}
