//! The acceleration of a tree under given forces.

use super::links::{Accelerated, Node, Unit, no_nodes, with_parent};
use super::{ArmBodies, BodyInertia};
use crate::energy::multibody::Wrench as _;
use crate::expected::present;
use crate::linear::{Matrix, SolveError};
use crate::scalar::{Real, Scalar, WeightFormat};

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
        let mut equation = Equation::new(force);
        self.write_equation(q, v, &mut equation);
        equation.solve();
        equation.x
    }

    /// [`ArmBodies::forward_dynamics`], or the reason why there is no solution.
    #[inline(always)]
    pub(super) fn solved<S: Real<Weight = W::Wide>>(
        &self,
        q: &[S; N],
        v: &[S; N],
        force: &[S; N],
    ) -> Result<[S; N], SolveError> {
        let mut equation = Equation::new(force);
        self.write_equation(q, v, &mut equation);
        equation.solve();
        for k in (0..N).rev() {
            let pivot = S::one() / equation.mass[k][k];
            if !(pivot.abs() > S::zero() && pivot.is_finite()) {
                return Err(SolveError::of_pivot(pivot, k));
            }
        }
        Ok(equation.x)
    }

    /// Writes M, and takes L_vq v − L_q from the right-hand side.
    #[inline(always)]
    fn write_equation<S: Scalar<Weight = W::Wide>>(
        &self,
        q: &[S; N],
        v: &[S; N],
        Equation { mass, carries, x }: &mut Equation<S, N>,
    ) {
        let base = Accelerated::base(self.falling());
        let mut nodes = no_nodes();
        self.place(q, &mut nodes, |k, parent: Option<&(BodyInertia<S>, Accelerated<S>)>, link, inertia| {
            let below = parent.map_or(&base, |(_, accelerated)| accelerated);
            (inertia, Accelerated::on(below, link, (v[k], None), &inertia))
        });
        for k in (0..N).rev() {
            let mut below = self.parent(k);
            let Some((own, parent)) = with_parent(&mut nodes, k, below) else { continue };
            let (link, (inertia, Accelerated { force, .. })) = (&own.link, &own.sums);
            let (mut unit, share) = Unit::new(link, inertia);
            (mass[k][k], x[k]) = (share + self.rotor(k), x[k] - link.share(force));
            if let Some(Node { sums: (sum, below), .. }) = parent {
                *sum = sum.plus(&inertia.about(link.step));
                below.force = below.force.plus(force.about(link.step));
            }
            while let Some(j) = below {
                let Some(Some(node)) = present(nodes.get(j)) else { break };
                (mass[k][j], carries[k][j]) = (unit.at(&node.link), true);
                below = self.parent(j);
            }
        }
    }
}

/// The equation Mx = b.
struct Equation<S, const N: usize> {
    /// M in its lower triangle, 0 where joint j does not carry joint k.
    mass: Matrix<S, N>,
    /// Whether joint j carries joint k, as entry k, j.
    carries: [[bool; N]; N],
    /// b, and then x.
    x: [S; N],
}

impl<S: Scalar, const N: usize> Equation<S, N> {
    #[inline(always)]
    fn new(x: &[S; N]) -> Self {
        Self { mass: [[S::zero(); N]; N], carries: [[false; N]; N], x: *x }
    }

    /// Solves the equation in place, from the tips; leaves the reciprocals of the pivots in the diagonal.
    #[inline(always)]
    fn solve(&mut self) {
        let Self { mass, carries, x } = self;
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
}
