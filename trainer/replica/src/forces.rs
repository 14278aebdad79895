//! Forces of a file, in addition to its Lagrangian.

use crate::{LAYERS, UNITS};
use leastaction_core::adapt::Number;
use leastaction_core::forces::{
    Coefficient, Coulomb, Directional, Dissipation, Forces, Grip, PotentialCorrection, Servo, Sticking, Stop,
    Stops, Viscous,
};
use leastaction_core::lagrangian::Column;
use leastaction_core::linear::Matrix;
use leastaction_core::model::{Law, LawNumbers, LoadForces, ModelError};
use std::f32::consts::FRAC_PI_2;

/// Viscous damping and dry friction.
pub type Friction<const N: usize> = (Viscous<f32, N>, Coulomb<f32, N>);
/// Dissipation and a potential by networks.
pub type Networks<'f, const N: usize> =
    (Dissipation<'f, f32, N, UNITS, LAYERS>, PotentialCorrection<'f, f32, N, UNITS, LAYERS>);
/// Friction and networks.
pub type WithNetworks<'f, const N: usize> = (Friction<N>, Networks<'f, N>);
/// Friction by direction, and friction that sticks.
pub type Axes<const N: usize> = (Directional<f32, N>, Sticking<f32, N>);
/// Friction by direction, friction that sticks, and end stops.
pub type StoppedAxes<const N: usize> = (Directional<f32, N>, (Sticking<f32, N>, Stops<f32, N>));
/// Every law that a file can have, but end stops.
pub type AllForces<'f, const N: usize> = ((WithNetworks<'f, N>, Servo<f32, N>), Axes<N>);

/// The laws of force of any file, computed exactly as by a program that is compiled only for the laws of that file.
#[derive(Clone, Debug)]
pub enum ForcesOf<'f, const N: usize> {
    /// Viscous damping, or no force.
    Viscous(Viscous<f32, N>),
    /// Viscous damping and dry friction.
    Friction(Friction<N>),
    /// Damping, dry friction and networks.
    Networks(Box<WithNetworks<'f, N>>),
    /// Damping, dry friction and servos.
    Servo(Box<(Friction<N>, Servo<f32, N>)>),
    /// Damping, dry friction, friction by direction and friction that sticks.
    Axes(Box<(Friction<N>, Axes<N>)>),
    /// Damping, dry friction, friction by direction, friction that sticks and end stops.
    Stopped(Box<(Friction<N>, StoppedAxes<N>)>),
    /// Every law but end stops.
    All(Box<AllForces<'f, N>>),
    /// Every law.
    AllStopped(Box<(AllForces<'f, N>, Stops<f32, N>)>),
}

/// Evaluates `$do` with `$law` bound to the law that is present.
macro_rules! with_law {
    ($self:ident, $law:ident => $do:expr) => {
        match $self {
            Self::Viscous($law) => $do,
            Self::Friction($law) => $do,
            Self::Networks(all) => {
                let $law = &**all;
                $do
            }
            Self::Servo(all) => {
                let $law = &**all;
                $do
            }
            Self::Axes(all) => {
                let $law = &**all;
                $do
            }
            Self::Stopped(all) => {
                let $law = &**all;
                $do
            }
            Self::All(all) => {
                let $law = &**all;
                $do
            }
            Self::AllStopped(all) => {
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
            Self::Networks(all) => all.0.0.coefficients,
            Self::Servo(all) => all.0.0.coefficients,
            Self::Axes(all) => all.0.0.coefficients,
            Self::Stopped(all) => all.0.0.coefficients,
            Self::All(all) => all.0.0.0.0.coefficients,
            Self::AllStopped(all) => all.0.0.0.0.0.coefficients,
        }
    }

    /// These forces with dry friction as a linear feedback meets it, whose velocities are spread about those of a motion with standard
    /// deviations `spread` (rad/s or m/s): widths become √(ε² + πσ²/2).
    ///
    /// The slope −c/√(ε² + πσ²/2) at v = 0 is the mean slope of −c tanh(v/ε) over Gaussian velocities, exactly for σ → 0 and for ε → 0, where
    /// it is −c√(2/π)/σ, and within 3% in between (the random-input describing function: Gelb and Vander Velde 1968).
    #[must_use]
    pub fn spread_over(&self, spread: &[f32; N]) -> Self {
        let mut spread_forces = self.clone();
        let (dry, axes) = match &mut spread_forces {
            Self::Viscous(_) => return spread_forces,
            Self::Friction((_, dry)) => (dry, None),
            Self::Networks(all) => (&mut all.0.1, None),
            Self::Servo(all) => (&mut all.0.1, None),
            Self::Axes(all) => (&mut all.0.1, Some((&mut all.1.0, &mut all.1.1))),
            Self::Stopped(all) => (&mut all.0.1, Some((&mut all.1.0, &mut all.1.1.0))),
            Self::All(all) => (&mut all.0.0.0.1, Some((&mut all.1.0, &mut all.1.1))),
            Self::AllStopped(all) => (&mut all.0.0.0.0.1, Some((&mut all.0.1.0, &mut all.0.1.1))),
        };
        let dry = dry.coordinates.iter_mut().map(|of| &mut of.width);
        let mut widths: Vec<&mut f32> = dry.collect();
        if let Some((directional, sticking)) = axes {
            widths.extend(directional.coordinates.iter_mut().map(|of| &mut of.width));
            widths.extend(sticking.coordinates.iter_mut().map(|of| &mut of.width));
        }
        for (width, spread) in widths.into_iter().zip(spread.iter().cycle()) {
            *width = width.hypot(FRAC_PI_2.sqrt() * spread);
        }
        spread_forces
    }
}

impl<'f, const N: usize> LoadForces<'f, f32, f32, N> for ForcesOf<'f, N> {
    fn knows(law: Law) -> bool {
        <(AllForces<N>, Stops<f32, N>) as LoadForces<f32, f32, N>>::knows(law)
    }

    fn take(laws: &mut LawNumbers<'_, 'f, f32>, groups: &[u8; N]) -> Result<Self, ModelError> {
        let present = laws.laws();
        let networks = present.contains(Law::Dissipation) || present.contains(Law::Potential);
        let axes = present.contains(Law::Directional) || present.contains(Law::Sticking);
        let kinds = (networks, present.contains(Law::Servo), axes, present.contains(Law::Stops));
        match kinds {
            (false, false, false, false) => {}
            (true, false, false, false) => {
                return Ok(Self::Networks(Box::new(LoadForces::take(laws, groups)?)));
            }
            (false, true, false, false) => return Ok(Self::Servo(Box::new(LoadForces::take(laws, groups)?))),
            (false, false, true, false) => return Ok(Self::Axes(Box::new(LoadForces::take(laws, groups)?))),
            (false, false, _, true) => return Ok(Self::Stopped(Box::new(LoadForces::take(laws, groups)?))),
            (.., false) => return Ok(Self::All(Box::new(LoadForces::take(laws, groups)?))),
            (.., true) => return Ok(Self::AllStopped(Box::new(LoadForces::take(laws, groups)?))),
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

    fn sticks(&self) -> bool {
        with_law!(self, law => law.sticks())
    }

    fn single_valued(&self, q: &[f32; N], v: &[f32; N], tau: &[f32; N]) -> [f32; N] {
        with_law!(self, law => law.single_valued(q, v, tau))
    }

    fn single_valued_derivatives(
        &self,
        q: &[f32; N],
        v: &[f32; N],
        tau: &[f32; N],
    ) -> (Matrix<f32, N>, Matrix<f32, N>) {
        with_law!(self, law => law.single_valued_derivatives(q, v, tau))
    }

    fn grips(&self, tau: &[f32; N]) -> [Grip<f32>; N] {
        with_law!(self, law => law.grips(tau))
    }

    fn stops(&self) -> [Stop<f32>; N] {
        with_law!(self, law => law.stops())
    }

    fn slopes(&self, coefficient: Coefficient, v: &[f32; N]) -> [f32; N] {
        with_law!(self, law => law.slopes(coefficient, v))
    }

    fn network_columns(
        &self,
        q: &[f32; N],
        v: &[f32; N],
        numbers: &[Number],
        columns: &mut [Column<f32, N>],
    ) {
        with_law!(self, law => law.network_columns(q, v, numbers, columns));
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

#[cfg(test)]
mod tests {
    use super::*;
    use leastaction_core::forces::DryFriction;

    /// Mean of (1 − tanh²(v/ε))/ε over v = σ z with Gaussian z, by the trapezoidal rule.
    fn mean_slope(width: f64, spread: f64) -> f64 {
        let nodes = || (-8_000..=8_000).map(|k| 1e-3 * f64::from(k));
        let weight = |z: f64| (-0.5 * z * z).exp();
        let slope = |z: f64| (1.0 - (spread * z / width).tanh().powi(2)) / width;
        nodes().map(|z| weight(z) * slope(z)).sum::<f64>() / nodes().map(weight).sum::<f64>()
    }

    #[test]
    fn spread_friction_has_the_mean_slope() {
        let friction = |width: f32| {
            let dry = DryFriction { constant: 1.0, load: 0.0, smoothing: 1.0, width };
            ForcesOf::Friction((Viscous { coefficients: [0.3] }, Coulomb { coordinates: [dry] }))
        };
        for (width, spread) in [(0.02, 0.0), (0.02, 0.01), (0.05, 0.05), (0.05, 0.1), (0.02, 1.0), (0.5, 0.3)]
        {
            let (_, slope) = friction(width).spread_over(&[spread]).derivatives(&[0.0], &[0.0], &[0.0]);
            let expected = 0.3 + mean_slope(f64::from(width), f64::from(spread));
            let found = f64::from(-slope[0][0]);
            assert!((found - expected).abs() < 0.03 * expected, "{found} instead of {expected}");
        }
    }

    #[test]
    fn damping_is_not_spread() {
        let viscous = ForcesOf::Viscous(Viscous { coefficients: [0.3, 0.4] });
        assert_eq!(viscous.spread_over(&[1.0, 1.0]).damping(), viscous.damping());
    }
}
