//! The acceleration of a tree under given forces.

use super::motion::Frame;
use super::vector::{Twist, Wrench};
use super::{ARM_PARAMETERS, ArmBodies, BodyInertia};
use crate::energy::multibody::{Frame as _, Wrench as _};
use crate::expected::{expected, present};
use crate::linear::Matrix;
use crate::scalar::{Scalar, WeightFormat};

impl<W: WeightFormat, const N: usize> ArmBodies<'_, W, N> {
    /// Computes v̇ = M⁻¹(force + L_q − L_vq v), m/s² or rad/s², for the sum of all forces on the joints, N or N m.
    ///
    /// One recursion gives M by composite inertias and L_vq v − L_q by the recursive Newton–Euler algorithm; M = LᵀDL is then eliminated from
    /// the tips to the base, which leaves entries of joints on different branches 0. The result is not finite if M is singular or numbers leave
    /// the range of S.
    ///
    /// Source: Featherstone, *Rigid Body Dynamics Algorithms*, 2008, sections 6.2 and 6.5.
    pub fn forward_dynamics<S: Scalar<Weight = W::Wide>>(
        &self,
        q: &[S; N],
        v: &[S; N],
        force: &[S; N],
    ) -> [S; N] {
        let EquationOfMotion { mut mass, carries, bias } = self.mass_and_bias(q, v);
        let mut x = core::array::from_fn(|k| force[k] - bias[k]);
        solve_from_tips(&mut mass, &carries, &mut x);
        x
    }

    #[inline(always)]
    fn mass_and_bias<S: Scalar<Weight = W::Wide>>(&self, q: &[S; N], v: &[S; N]) -> EquationOfMotion<S, N> {
        let (base, falling) =
            (Frame::base(), Twist { linear: self.gravity().map(|g: S| -g), ..Twist::zero() });
        let (mut frames, mut twists) = ([base; N], [falling; N]);
        let (mut wrenches, mut inertias) = ([Wrench::zero(); N], [BodyInertia::zero(); N]);
        for k in 0..N {
            let numbers = self.body(k);
            let on = |parent: usize| Some((frames.get(parent)?, twists.get(parent)?));
            let on = |parent| expected(on(parent), (&base, &falling));
            let (parent, below) = self.parent(k).map_or((&base, &falling), on);
            let frame = parent.carried(self.tree.bodies()[k].joint, &numbers, q[k], v[k]);
            twists[k] = frame.accelerated(parent.velocity.angular, below, v[k], S::zero());
            inertias[k] = numbers.inertia.turned(&frame.rotation);
            wrenches[k] = inertias[k].force(frame.velocity.angular, &twists[k]);
            frames[k] = frame;
        }
        let (mut mass, mut carries, mut bias) = ([[S::zero(); N]; N], [[false; N]; N], [S::zero(); N]);
        for k in (0..N).rev() {
            let (mut step, mut unit) = (frames[k].step, inertias[k].unit_momentum(&frames[k]));
            let rotor: S = W::scalar(self.numbers[k][ARM_PARAMETERS - 1]);
            (mass[k][k], bias[k]) = (frames[k].share(&unit) + rotor, frames[k].share(&wrenches[k]));
            let carried = (inertias[k].about(step), wrenches[k].about(step));
            let below = self.parent(k).and_then(|j| Some((inertias.get_mut(j)?, wrenches.get_mut(j)?)));
            if let Some((inertia, wrench)) = below {
                (*inertia, *wrench) = (inertia.plus(&carried.0), wrench.plus(carried.1));
            }
            let mut below = self.parent(k);
            while let Some(j) = below {
                let Some(frame) = present(frames.get(j)) else { break };
                unit = unit.about(step);
                (mass[k][j], carries[k][j]) = (frame.share(&unit), true);
                (step, below) = (frame.step, self.parent(j));
            }
        }
        EquationOfMotion { mass, carries, bias }
    }
}

/// Terms of M v̇ + bias = force.
struct EquationOfMotion<S, const N: usize> {
    /// M in its lower triangle.
    mass: Matrix<S, N>,
    /// Whether joint j carries joint k, as entry k, j.
    carries: [[bool; N]; N],
    /// L_vq v − L_q.
    bias: [S; N],
}

/// Solves Mx = b in place, from the lower triangle of M, whose entries are 0 where joint j does not carry joint k.
#[inline(always)]
fn solve_from_tips<S: Scalar, const N: usize>(
    mass: &mut Matrix<S, N>,
    carries: &[[bool; N]; N],
    x: &mut [S; N],
) {
    for k in (0..N).rev() {
        let row = mass[k];
        let inverse = S::one() / row[k];
        mass[k][k] = inverse;
        for i in (0..k).rev() {
            if !carries[k][i] {
                continue;
            }
            let factor = row[i] * inverse;
            for j in 0..=i {
                mass[i][j] -= factor * row[j];
            }
            let carried = x[k];
            x[i] -= factor * carried;
            mass[k][i] = factor;
        }
    }
    for k in 0..N {
        x[k] = x[k] * mass[k][k];
        for i in 0..k {
            if carries[k][i] {
                let carrier = x[i];
                x[k] -= mass[k][i] * carrier;
            }
        }
    }
}
