//! Dynamics of arms in double precision by the recursions of core, for states side by side.

use crate::Model;
use leastaction_core::energy::arm::{ArmBodies, BodyTree};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::scalar::{LANES, Lanes, Scalar};
use leastaction_programs::{Row, WIDTH};
use std::array::from_fn;

/// Dynamics of the bodies of an arm, without forces beside them. Slices have n rows; a number that does not exist is not finite.
pub trait ArmDynamics: Send + Sync {
    /// Computes the energies T(q, v) and V(q), J.
    fn energies(&self, at: [&[Row]; 2]) -> [Row; 2];

    /// Writes the forces τ(q, v, v̇), N or N m.
    fn inverse_dynamics(&self, at: [&[Row]; 3], to: &mut [Row]);

    /// Writes M(q) row by row.
    fn mass_matrix(&self, q: &[Row], to: &mut [Row]);

    /// Writes v̇(q, v, τ), m/s² or rad/s².
    fn acceleration(&self, at: [&[Row]; 3], to: &mut [Row]);

    /// Writes the derivatives of v̇(q, v, τ) with respect to all numbers of q, v and τ, one column of n rows for each.
    fn acceleration_derivatives(&self, at: [&[Row]; 3], to: &mut [Row]);
}

/// Calls a macro with all numbers of coordinates that the recursions are compiled for.
macro_rules! of_size {
    ($model:expr, $arm:expr, [$($n:literal),*]) => {
        match $arm.bodies.len() {
            $($n => Some(Box::new(bodies::<$n>($model)?)),)*
            _ => None,
        }
    };
}

impl Model {
    /// Returns the dynamics of an arm's bodies. `None` for other families, for a potential that a network corrects, and for numbers of
    /// coordinates that core is not compiled for.
    pub fn arm_dynamics(&self) -> Option<Box<dyn ArmDynamics + '_>> {
        let arm = self.architecture.family.arm()?;
        if self.architecture.corrections.potential.is_some() {
            return None;
        }
        of_size!(self, arm, [1, 2, 3, 4, 5, 6, 7, 8, 12])
    }
}

fn bodies<const N: usize>(model: &Model) -> Option<ArmBodies<'_, f64, N>> {
    let tree = BodyTree::new(model.architecture.family.arm()?.tree_bodies()).ok()?;
    ArmBodies::take(&mut &model.weights[..], tree)
}

impl<const N: usize> ArmDynamics for ArmBodies<'_, f64, N> {
    fn energies(&self, at: [&[Row]; 2]) -> [Row; 2] {
        let mut to = [Row::default(); 2];
        in_lanes(at, &mut to, |[q, v]| {
            let energies = Lagrangian::energies(self, &q, &v);
            [energies.kinetic, energies.potential]
        });
        to
    }

    fn inverse_dynamics(&self, at: [&[Row]; 3], to: &mut [Row]) {
        in_lanes(at, to, |[q, v, a]| ArmBodies::inverse_dynamics(self, &q, &v, &a));
    }

    fn mass_matrix(&self, q: &[Row], to: &mut [Row]) {
        in_lanes([q], to, |[q]| ArmBodies::mass_matrix(self, &q));
    }

    fn acceleration(&self, at: [&[Row]; 3], to: &mut [Row]) {
        in_lanes(at, to, |[q, v, tau]| self.forward_dynamics(&q, &v, &tau));
    }

    fn acceleration_derivatives(&self, at: [&[Row]; 3], to: &mut [Row]) {
        in_lanes(at, to, |[q, v, tau]| {
            let a = self.forward_dynamics(&q, &v, &tau);
            let of_forces = self.inverse_dynamics_derivatives(&q, &v, &a);
            let factors = Factors::new(ArmBodies::mass_matrix(self, &q));
            let by = |forces: &[[Lanes; N]; N]| -> [[Lanes; N]; N] {
                from_fn(|j| factors.solve(from_fn(|i| -forces[i][j])))
            };
            let unit = |j: usize| from_fn(|i| if i == j { Lanes::one() } else { Lanes::zero() });
            [by(&of_forces.force_q), by(&of_forces.force_v), from_fn(|j| factors.solve(unit(j)))]
        });
    }
}

/// Numbers of one group of lanes, in the order of rows.
trait InOrder {
    fn write(&self, group: usize, to: &mut [Row]);
}

impl InOrder for Lanes {
    #[inline(always)]
    fn write(&self, group: usize, to: &mut [Row]) {
        to[0].0.as_chunks_mut().0[group] = self.0;
    }
}

impl<T: InOrder, const M: usize> InOrder for [T; M] {
    #[inline(always)]
    fn write(&self, group: usize, to: &mut [Row]) {
        let each = to.len() / M;
        self.iter().zip(to.chunks_exact_mut(each)).for_each(|(numbers, to)| numbers.write(group, to));
    }
}

/// Writes what `of` computes for every group of lanes.
#[inline(always)]
fn in_lanes<T: InOrder, const N: usize, const K: usize>(
    at: [&[Row]; K],
    to: &mut [Row],
    of: impl Fn([[Lanes; N]; K]) -> T,
) {
    for group in 0..WIDTH / LANES {
        of(at.map(|rows| from_fn(|i| Lanes(rows[i].0.as_chunks().0[group])))).write(group, to);
    }
}

/// Factors of a symmetric matrix, LDLᵀ: L below the diagonal, 1/D on it.
struct Factors<const N: usize>([[Lanes; N]; N]);

impl<const N: usize> Factors<N> {
    fn new(mut matrix: [[Lanes; N]; N]) -> Self {
        for k in 0..N {
            let inverse = Lanes::one() / matrix[k][k];
            for i in k + 1..N {
                let factor = matrix[i][k] * inverse;
                let column: [Lanes; N] = from_fn(|j| matrix[j][k]);
                let row = matrix[i].iter_mut().zip(column);
                row.take(i + 1).skip(k + 1).for_each(|(entry, other)| *entry -= factor * other);
            }
            (k + 1..N).for_each(|i| matrix[i][k] = matrix[i][k] * inverse);
            matrix[k][k] = inverse;
        }
        Self(matrix)
    }

    fn solve(&self, mut x: [Lanes; N]) -> [Lanes; N] {
        let Self(factors) = self;
        for (i, j) in (0..N).flat_map(|i| (0..i).map(move |j| (i, j))) {
            let other = x[j];
            x[i] -= factors[i][j] * other;
        }
        (0..N).for_each(|i| x[i] = x[i] * factors[i][i]);
        for (i, j) in (0..N).rev().flat_map(|i| (i + 1..N).map(move |j| (i, j))) {
            let other = x[j];
            x[i] -= factors[j][i] * other;
        }
        x
    }
}
