use super::links::{Accelerated, Unit, no_nodes, with_parent};
use super::{ARM_GRAVITY_PARAMETERS, ARM_PARAMETERS};
use crate::energy::multibody::{Bodies, Motion, Wrench as _};
use crate::expected::present;
use crate::scalar::{Scalar, WeightFormat};

/// A tree of N rigid bodies on joints in space: γ and the [`ArmParameters`](super::ArmParameters) of every body.
pub type ArmBodies<'a, W, const N: usize> = Bodies<'a, W, ARM_GRAVITY_PARAMETERS, ARM_PARAMETERS, N>;

impl<W: WeightFormat, const N: usize> ArmBodies<'_, W, N> {
    /// Computes the drive forces that give the acceleration v̇ at (q, v): M v̇ + L_vq v − L_q, N m or N,
    /// without friction. O(n), by the recursive Newton–Euler algorithm.
    pub fn inverse_dynamics<S: Scalar<Weight = W::Wide>>(
        &self,
        q: &[S; N],
        v: &[S; N],
        acceleration: &[S; N],
    ) -> [S; N] {
        let base = Accelerated::base(self.falling());
        let mut nodes = no_nodes();
        self.place(q, &mut nodes, |k, parent, link, inertia| {
            Accelerated::on(parent.unwrap_or(&base), link, (v[k], Some(acceleration[k])), &inertia)
        });
        let mut force = [S::zero(); N];
        for k in (0..N).rev() {
            let Some((own, parent)) = with_parent(&mut nodes, k, self.parent(k)) else { continue };
            force[k] = own.link.share(&own.sums.force) + self.rotor::<S>(k) * acceleration[k];
            if let Some(below) = parent {
                let sums = &mut below.sums;
                sums.force = sums.force.plus(own.sums.force.about(own.link.step));
            }
        }
        force
    }

    /// Computes the drive forces that hold the arm against gravity, V_q, N m or N.
    pub fn gravity_torque<S: Scalar<Weight = W::Wide>>(&self, q: &[S; N]) -> [S; N] {
        let gravity = self.gravity();
        let motion = Motion::new(self, q, &[S::zero(); N]);
        core::array::from_fn(|k| -motion.unit(k).along(gravity))
    }

    /// Computes M(q), symmetric, from the composite inertia of all that each joint carries. Velocities are not
    /// needed.
    pub fn mass_matrix<S: Scalar<Weight = W::Wide>>(&self, q: &[S; N]) -> [[S; N]; N] {
        let mut nodes = no_nodes();
        self.place(q, &mut nodes, |_, _, _, inertia| inertia);
        let mut mass = [[S::zero(); N]; N];
        for k in (0..N).rev() {
            let mut below = self.parent(k);
            let Some((own, parent)) = with_parent(&mut nodes, k, below) else { continue };
            let (mut unit, share) = Unit::new(&own.link, &own.sums);
            mass[k][k] = share + self.rotor(k);
            if let Some(below) = parent {
                below.sums = below.sums.plus(&own.sums.about(own.link.step));
            }
            while let Some(j) = below {
                let Some(Some(node)) = present(nodes.get(j)) else { break };
                mass[j][k] = unit.at(&node.link);
                mass[k][j] = mass[j][k];
                below = self.parent(j);
            }
        }
        mass
    }
}
