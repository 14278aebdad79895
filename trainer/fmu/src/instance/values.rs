//! Reading and setting of variables.

use super::{Instance, finite};
use crate::{FmuError, Kind, Phase, State, Variable};

impl Instance {
    /// Values of the variables with these value references.
    ///
    /// # Errors
    /// [`FmuError::Reference`]; [`FmuError::Core`] if a value does not exist.
    pub fn get(&self, references: &[u32]) -> Result<Vec<f64>, FmuError> {
        // All components of the acceleration come from one evaluation.
        let mut acceleration = None;
        let variables = references.iter().map(|reference| self.variable(*reference));
        variables.map(|variable| self.value(variable?, &mut acceleration)).collect()
    }

    fn value(
        &self,
        Variable { kind, index }: Variable,
        acceleration: &mut Option<Vec<f64>>,
    ) -> Result<f64, FmuError> {
        let State { time, h, u, q, v, start_q, start_v, .. } = &self.state;
        let of = |list: &[f64]| list.get(index).copied().unwrap_or_default();
        let energies = || self.unit.energies(q, v);
        Ok(match kind {
            Kind::Time => *time,
            Kind::Step => *h,
            Kind::Force => of(u),
            Kind::Position => of(q),
            Kind::Velocity => of(v),
            Kind::StartPosition => of(start_q),
            Kind::StartVelocity => of(start_v),
            Kind::KineticEnergy => energies()?.kinetic.into(),
            Kind::PotentialEnergy => energies()?.potential.into(),
            Kind::Energy => energies().map(|own| f64::from(own.kinetic) + f64::from(own.potential))?,
            Kind::Acceleration => {
                let known = acceleration.take().map_or_else(|| self.acceleration(), Ok)?;
                of(acceleration.insert(known))
            }
        })
    }

    pub(super) fn acceleration(&self) -> Result<Vec<f64>, FmuError> {
        self.unit.acceleration(&self.state.q, &self.state.v, &self.state.u)
    }

    /// Sets the variables with these value references.
    ///
    /// # Errors
    /// [`FmuError::Reference`], [`FmuError::Set`], [`FmuError::NotFinite`], [`FmuError::StepSize`].
    pub fn set(&mut self, references: &[u32], values: &[f64]) -> Result<(), FmuError> {
        FmuError::check_length("the list of values", references.len(), values.len())?;
        let mut changed = self.state.clone();
        for (reference, value) in references.iter().zip(values) {
            self.set_one(&mut changed, self.variable(*reference)?, *value)?;
        }
        self.state = changed;
        Ok(())
    }

    fn set_one(&self, state: &mut State, variable: Variable, value: f64) -> Result<(), FmuError> {
        finite(&variable.name(), value)?;
        let phase = state.phase;
        let before = matches!(phase, Phase::Instantiated | Phase::Initialization);
        let lists: [Option<&mut Vec<f64>>; 2] = match variable.kind {
            Kind::Force if phase != Phase::Terminated => [Some(&mut state.u), None],
            Kind::StartPosition if before => [Some(&mut state.start_q), Some(&mut state.q)],
            Kind::StartVelocity if before => [Some(&mut state.start_v), Some(&mut state.v)],
            Kind::Step if before && self.unit.h().is_none() => {
                state.h =
                    Some(value).filter(|h| *h > 0.0 && *h <= 3600.0).ok_or(FmuError::StepSize(value))?;
                [None, None]
            }
            _ => return Err(FmuError::Set { variable, phase }),
        };
        let places = lists.into_iter().flatten().filter_map(|list| list.get_mut(variable.index));
        places.for_each(|to| *to = value);
        Ok(())
    }

    fn variable(&self, reference: u32) -> Result<Variable, FmuError> {
        Variable::of_reference(reference, self.unit.n()).ok_or(FmuError::Reference(reference))
    }
}
