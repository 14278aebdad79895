//! Learned particles of any number on known rods, as plain functions on slices.

use leastaction_core::constraints::{Constrained, ConstraintError, Constraints, Holonomic};
use leastaction_core::continuous::{Drive, constrained_acceleration, constrained_room};
use leastaction_core::particles::Particles;

/// The rods of a system in D dimensions.
pub type Rods<const D: usize> = [Holonomic<f64, D>];

/// A system of particles on its rods, under a constant force.
#[derive(Debug)]
pub struct Driven<'a, P, const D: usize> {
    mechanism: Constrained<'a, f64, P, Rods<D>, D>,
    force: &'a [[f64; D]],
}

impl<'a, P: Particles<f64, D>, const D: usize> Driven<'a, P, D> {
    /// The system on these rods; `force` (N) is that on every node, or empty.
    ///
    /// # Errors
    /// Where a rod ends at no node or has no length.
    pub fn new(
        system: &'a P,
        rods: &'a Rods<D>,
        force: &'a [[f64; D]],
    ) -> Result<Self, ConstraintError<f64>> {
        Ok(Self { mechanism: Constrained::new(system, rods)?, force })
    }

    /// Writes v̇(q, v), m/s²; `None` where it does not exist or a slice has not one entry a coordinate.
    pub fn acceleration(&self, q: &[f64], v: &[f64], out: &mut [f64]) -> Option<()> {
        let mut lambda = vec![0.0; self.mechanism.constraints().equations()];
        self.write(q, v, out, &mut lambda)
    }

    /// The multiplier of every rod, N: above 0 where it is pushed apart; `None` as for accelerations.
    pub fn multipliers(&self, q: &[f64], v: &[f64]) -> Option<Vec<f64>> {
        let mut lambda = vec![0.0; self.mechanism.constraints().equations()];
        self.write(q, v, &mut vec![0.0; q.len()], &mut lambda)?;
        Some(lambda)
    }

    fn write(&self, q: &[f64], v: &[f64], out: &mut [f64], lambda: &mut [f64]) -> Option<()> {
        let force = (!self.force.is_empty()).then_some(self.force);
        let drive = Drive { force, ..Drive::none() };
        let mut room = vec![0.0; constrained_room(&self.mechanism)];
        let (q, v, out) = (q.as_chunks().0, v.as_chunks().0, out.as_chunks_mut().0);
        constrained_acceleration(&self.mechanism, (q, v), &drive, &mut room, (out, lambda)).ok()
    }
}
