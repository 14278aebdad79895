//! Learned particles on known rods, in any number, as plain functions on slices.

use leastaction_core::constraints::{Constrained, ConstraintError, Constraints, Holonomic};
use leastaction_core::continuous::{Drive, constrained_acceleration, constrained_workspace};
use leastaction_core::particles::Particles;

/// Rods of a system in D dimensions.
pub type Rods<const D: usize> = [Holonomic<f64, D>];

/// A system of particles on rods, under forces.
#[derive(Debug)]
pub struct Driven<'a, P, const D: usize> {
    mechanism: Constrained<'a, f64, P, Rods<D>, D>,
}

impl<'a, P: Particles<f64, D>, const D: usize> Driven<'a, P, D> {
    /// Creates the system on these rods.
    ///
    /// # Errors
    /// An error if a rod ends at no node or has no length.
    pub fn new(system: &'a P, rods: &'a Rods<D>) -> Result<Self, ConstraintError<f64>> {
        Ok(Self { mechanism: Constrained::new(system, rods)? })
    }

    /// Writes v̇(q, v, u), m/s², under a force u on every coordinate, N (no force if u is empty); `None` if it does not exist or a slice
    /// does not have one entry per coordinate.
    pub fn acceleration(&self, q: &[f64], v: &[f64], u: &[f64], out: &mut [f64]) -> Option<()> {
        self.solve(q, v, u, out).map(|_| ())
    }

    /// Force in every rod, N: the multiplier of its constraint, positive if the rod pushes its ends apart; `None` as
    /// for accelerations.
    pub fn multipliers(&self, q: &[f64], v: &[f64], u: &[f64]) -> Option<Vec<f64>> {
        self.solve(q, v, u, &mut vec![0.0; q.len()])
    }

    fn solve(&self, q: &[f64], v: &[f64], u: &[f64], out: &mut [f64]) -> Option<Vec<f64>> {
        let drive = Drive { force: (!u.is_empty()).then_some(u.as_chunks().0), ..Drive::none() };
        let mut workspace = vec![0.0; constrained_workspace(&self.mechanism)];
        let mut lambda = vec![0.0; self.mechanism.constraints().equations()];
        let (q, v, out) = (q.as_chunks().0, v.as_chunks().0, out.as_chunks_mut().0);
        constrained_acceleration(&self.mechanism, (q, v), &drive, &mut workspace, (out, &mut lambda)).ok()?;
        Some(lambda)
    }
}
