//! The forces beside a Lagrangian, as a file has them.

use crate::{LAYERS, UNITS};
use leastaction_core::forces::{Coulomb, Dissipation, Forces, PotentialCorrection, Viscous};
use leastaction_core::linear::Matrix;
use leastaction_core::model::{Law, Laws};

/// Damping and dry friction.
pub type Friction<const N: usize> = (Viscous<f32, N>, Coulomb<f32, N>);
/// Dissipation and a potential from networks.
pub type Networks<'f, const N: usize> =
    (Dissipation<'f, f32, N, UNITS, LAYERS>, PotentialCorrection<'f, f32, N, UNITS, LAYERS>);
/// Every law that a file can have.
pub type AllForces<'f, const N: usize> = (Friction<N>, Networks<'f, N>);

/// All laws of force that a file can have: as a program computes them that is compiled for those of the file alone.
#[derive(Clone, Debug)]
pub enum ForcesOf<'f, const N: usize> {
    /// Viscous damping, or nothing.
    Viscous(Viscous<f32, N>),
    /// With dry friction.
    Friction(Friction<N>),
    /// With networks.
    All(Box<AllForces<'f, N>>),
}

/// Which laws a program must be compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Needed {
    /// Damping at most.
    Viscous,
    /// Damping and dry friction.
    Friction,
    /// Networks too.
    All,
}

impl Needed {
    /// By a file of these laws.
    pub fn by(laws: Laws) -> Self {
        if laws.contains(Law::Dissipation) || laws.contains(Law::Potential) {
            return Self::All;
        }
        if laws.contains(Law::Coulomb) { Self::Friction } else { Self::Viscous }
    }
}

/// Evaluates `$do` with `$law` the law that is there.
macro_rules! with_law {
    ($self:ident, $law:ident => $do:expr) => {
        match $self {
            Self::Viscous($law) => $do,
            Self::Friction($law) => $do,
            Self::All(all) => {
                let $law = &**all;
                $do
            }
        }
    };
}

impl<const N: usize> ForcesOf<'_, N> {
    /// Of damping its coefficients, N s/m or N m s/rad; 0 where there is none.
    pub fn damping(&self) -> [f32; N] {
        match self {
            Self::Viscous(viscous) | Self::Friction((viscous, _)) => viscous.coefficients,
            Self::All(all) => all.0.0.coefficients,
        }
    }
}

impl<const N: usize> From<Viscous<f32, N>> for ForcesOf<'_, N> {
    fn from(viscous: Viscous<f32, N>) -> Self {
        Self::Viscous(viscous)
    }
}

impl<const N: usize> From<Friction<N>> for ForcesOf<'_, N> {
    fn from(friction: Friction<N>) -> Self {
        Self::Friction(friction)
    }
}

impl<'f, const N: usize> From<AllForces<'f, N>> for ForcesOf<'f, N> {
    fn from(all: AllForces<'f, N>) -> Self {
        Self::All(Box::new(all))
    }
}

impl<const N: usize> Forces<f32, N> for ForcesOf<'_, N> {
    fn force(&self, q: &[f32; N], v: &[f32; N], tau: &[f32; N]) -> [f32; N] {
        with_law!(self, law => law.force(q, v, tau))
    }

    fn derivatives(&self, q: &[f32; N], v: &[f32; N], tau: &[f32; N]) -> (Matrix<f32, N>, Matrix<f32, N>) {
        with_law!(self, law => law.derivatives(q, v, tau))
    }

    fn load_derivative(&self, q: &[f32; N], v: &[f32; N], tau: &[f32; N]) -> Matrix<f32, N> {
        with_law!(self, law => law.load_derivative(q, v, tau))
    }

    fn potential(&self, q: &[f32; N]) -> f32 {
        with_law!(self, law => law.potential(q))
    }

    fn control(&self, q: &[f32; N], v: &[f32; N], total: &[f32; N]) -> [f32; N] {
        with_law!(self, law => law.control(q, v, total))
    }

    fn trusted_part(&self, v: &[f32; N], dv: &[f32; N]) -> f32 {
        with_law!(self, law => law.trusted_part(v, dv))
    }
}
