//! The forces beside a Lagrangian, as a file has them.

use leastaction_core::forces::{Coulomb, Forces, Viscous};
use leastaction_core::linear::Matrix;
use leastaction_core::model::{Law, Laws};

/// Damping and dry friction.
pub type Friction<const N: usize> = (Viscous<f32, N>, Coulomb<f32, N>);

/// All laws of force that a file can have: as a program computes them that is compiled for those of the file alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ForcesOf<const N: usize> {
    /// Viscous damping, or nothing.
    Viscous(Viscous<f32, N>),
    /// With dry friction.
    Friction(Friction<N>),
}

/// Whether a file has dry friction.
pub(crate) fn is_dry(laws: Laws) -> bool {
    laws.contains(Law::Coulomb)
}

impl<const N: usize> ForcesOf<N> {
    /// Of damping its coefficients, N s/m or N m s/rad; 0 where there is none.
    pub fn damping(&self) -> [f32; N] {
        match self {
            Self::Viscous(viscous) | Self::Friction((viscous, _)) => viscous.coefficients,
        }
    }
}

impl<const N: usize> From<Viscous<f32, N>> for ForcesOf<N> {
    fn from(viscous: Viscous<f32, N>) -> Self {
        Self::Viscous(viscous)
    }
}

impl<const N: usize> From<Friction<N>> for ForcesOf<N> {
    fn from(friction: Friction<N>) -> Self {
        Self::Friction(friction)
    }
}

impl<const N: usize> Forces<f32, N> for ForcesOf<N> {
    fn force(&self, q: &[f32; N], v: &[f32; N], tau: &[f32; N]) -> [f32; N] {
        match self {
            Self::Viscous(forces) => forces.force(q, v, tau),
            Self::Friction(forces) => forces.force(q, v, tau),
        }
    }

    fn derivatives(&self, q: &[f32; N], v: &[f32; N], tau: &[f32; N]) -> (Matrix<f32, N>, Matrix<f32, N>) {
        match self {
            Self::Viscous(forces) => forces.derivatives(q, v, tau),
            Self::Friction(forces) => forces.derivatives(q, v, tau),
        }
    }

    fn load_derivative(&self, q: &[f32; N], v: &[f32; N], tau: &[f32; N]) -> Matrix<f32, N> {
        match self {
            Self::Viscous(forces) => forces.load_derivative(q, v, tau),
            Self::Friction(forces) => forces.load_derivative(q, v, tau),
        }
    }

    fn control(&self, q: &[f32; N], v: &[f32; N], total: &[f32; N]) -> [f32; N] {
        match self {
            Self::Viscous(forces) => forces.control(q, v, total),
            Self::Friction(forces) => forces.control(q, v, total),
        }
    }

    fn trusted_part(&self, v: &[f32; N], dv: &[f32; N]) -> f32 {
        match self {
            Self::Viscous(forces) => forces.trusted_part(v, dv),
            Self::Friction(forces) => forces.trusted_part(v, dv),
        }
    }
}
