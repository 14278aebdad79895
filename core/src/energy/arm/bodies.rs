use super::motion::Frame;
use super::vector::{Twist, Wrench};
use super::{ARM_GRAVITY_PARAMETERS, ARM_PARAMETERS, BodyInertia};
use crate::energy::multibody::{Bodies, Frame as _, Motion, Wrench as _};
use crate::expected::{expected, present};
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
        let (base, falling) =
            (Frame::base(), Twist { linear: self.gravity().map(|g: S| -g), ..Twist::zero() });
        let (mut frames, mut twists, mut wrenches) = ([base; N], [falling; N], [Wrench::zero(); N]);
        for k in 0..N {
            let numbers = self.body(k);
            let on = |parent: usize| Some((frames.get(parent).copied()?, twists.get(parent).copied()?));
            let on = |parent| expected(on(parent), (base, falling));
            let (parent, below) = self.parent(k).map_or((base, falling), on);
            let frame = parent.carried(self.tree.bodies()[k].joint, &numbers, q[k], v[k]);
            let twist = frame.accelerated(parent.velocity.angular, &below, v[k], acceleration[k]);
            wrenches[k] = numbers.inertia.turned(&frame.rotation).force(frame.velocity.angular, &twist);
            (frames[k], twists[k]) = (frame, twist);
        }
        let mut force = [S::zero(); N];
        for k in (0..N).rev() {
            let rotor: S = W::scalar(self.numbers[k][ARM_PARAMETERS - 1]);
            force[k] = frames[k].share(&wrenches[k]) + rotor * acceleration[k];
            let carried = wrenches[k].about(frames[k].step);
            if let Some(below) = self.parent(k).and_then(|parent| wrenches.get_mut(parent)) {
                *below = below.plus(carried);
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
        let base = Frame::base();
        let (mut frames, mut inertias) = ([base; N], [BodyInertia::zero(); N]);
        let mut mass = [[S::zero(); N]; N];
        for k in 0..N {
            let numbers = self.body(k);
            let on = |parent: usize| expected(frames.get(parent).copied(), base);
            let frame = self.parent(k).map_or(base, on).placed(self.tree.bodies()[k].joint, &numbers, q[k]);
            inertias[k] = numbers.inertia.turned(&frame.rotation);
            (frames[k], mass[k][k]) = (frame, numbers.rotor);
        }
        for k in (0..N).rev() {
            let (mut step, mut unit) = (frames[k].step, inertias[k].unit_momentum(&frames[k]));
            mass[k][k] = frames[k].share(&unit) + mass[k][k];
            let carried = inertias[k].about(step);
            if let Some(below) = self.parent(k).and_then(|parent| inertias.get_mut(parent)) {
                *below = below.plus(&carried);
            }
            let mut below = self.parent(k);
            while let Some(j) = below {
                let Some(frame) = present(frames.get(j)) else { break };
                unit = unit.about(step);
                mass[j][k] = frame.share(&unit);
                mass[k][j] = mass[j][k];
                (step, below) = (frame.step, self.parent(j));
            }
        }
        mass
    }
}
