//! Forces of a file, in addition to its Lagrangian.

use crate::{LAYERS, UNITS};
use leastaction_core::forces::{Coulomb, Dissipation, Forces, PotentialCorrection, Viscous};
use leastaction_core::linear::Matrix;
use leastaction_core::model::{Law, LawNumbers, LoadForces, ModelError};

/// Viscous damping and dry friction.
pub type Friction<const N: usize> = (Viscous<f32, N>, Coulomb<f32, N>);
/// Dissipation and a potential by networks.
pub type Networks<'f, const N: usize> =
    (Dissipation<'f, f32, N, UNITS, LAYERS>, PotentialCorrection<'f, f32, N, UNITS, LAYERS>);
/// Every law that a file can have.
pub type AllForces<'f, const N: usize> = (Friction<N>, Networks<'f, N>);

/// The laws of force of any file, computed exactly as by a program that is compiled only for the laws of that file.
#[derive(Clone, Debug)]
pub enum ForcesOf<'f, const N: usize> {
    /// Viscous damping, or no force.
    Viscous(Viscous<f32, N>),
    /// Viscous damping and dry friction.
    Friction(Friction<N>),
    /// Damping, dry friction and networks.
    All(Box<AllForces<'f, N>>),
}

/// Evaluates `$do` with `$law` bound to the law that is present.
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
    /// Coefficients of viscous damping, N s/m or N m s/rad; 0 if there is none.
    pub fn damping(&self) -> [f32; N] {
        match self {
            Self::Viscous(viscous) | Self::Friction((viscous, _)) => viscous.coefficients,
            Self::All(all) => all.0.0.coefficients,
        }
    }
}

impl<'f, const N: usize> LoadForces<'f, f32, f32, N> for ForcesOf<'f, N> {
    fn knows(law: Law) -> bool {
        <AllForces<N> as LoadForces<f32, f32, N>>::knows(law)
    }

    fn take(laws: &mut LawNumbers<'_, 'f, f32>, groups: &[u8; N]) -> Result<Self, ModelError> {
        let present = laws.laws();
        if present.contains(Law::Dissipation) || present.contains(Law::Potential) {
            return Ok(Self::All(Box::new(AllForces::take(laws, groups)?)));
        }
        if present.contains(Law::Coulomb) {
            return Ok(Self::Friction(Friction::take(laws, groups)?));
        }
        Ok(Self::Viscous(Viscous::take(laws, groups)?))
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
