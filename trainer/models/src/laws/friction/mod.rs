//! Friction of a coordinate, whatever laws it comes from.

pub mod config;

use super::group::NumberKind;
use leastaction_core::model::Law;

/// Friction of one coordinate:
///
/// Q = −(b (1 + βt) v + (c (1 + δt) + c_load (√(τ² + τ_s²) − τ_s)) t), t = tanh(v/ε),
///
/// or, if it sticks, the set-valued law of the same levels ([`leastaction_core::forces::Sticking`]).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CoordinateFriction {
    /// Damping b, N s/m or N m s/rad.
    pub viscous: f64,
    /// Asymmetry β of damping.
    pub viscous_asymmetry: f64,
    /// Dry friction; `None` if the model has none.
    pub dry: Option<DryNumbers>,
}

/// Dry friction of one coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DryNumbers {
    /// Friction c at no load, the mean of both directions, N or N m.
    pub constant: f64,
    /// Asymmetry δ.
    pub asymmetry: f64,
    /// Growth c_load of friction with the load.
    pub load: f64,
    /// Load τ_s below which friction hardly grows, N or N m.
    pub smoothing: f64,
    /// Width ε of the change of sign of the smooth law, m/s or rad/s.
    pub width: f64,
    /// Breakaway ratio s of friction that sticks; `None` if friction is smooth.
    pub breakaway: Option<f64>,
}

impl Default for DryNumbers {
    fn default() -> Self {
        Self { constant: 0.0, asymmetry: 0.0, load: 0.0, smoothing: 1.0, width: 1.0, breakaway: None }
    }
}

impl CoordinateFriction {
    /// A number of this friction; `None` for one that it does not have.
    pub(crate) fn number(&self, kind: NumberKind) -> Option<f64> {
        let dry = self.dry;
        match kind {
            NumberKind::Damping => Some(self.viscous),
            NumberKind::DampingAsymmetry => Some(self.viscous_asymmetry),
            NumberKind::Friction => dry.map(|dry| dry.constant),
            NumberKind::FrictionAsymmetry => dry.map(|dry| dry.asymmetry),
            NumberKind::Load => dry.map(|dry| dry.load),
            NumberKind::Smoothing => dry.map(|dry| dry.smoothing),
            NumberKind::Width => dry.map(|dry| dry.width),
            NumberKind::Breakaway => dry.and_then(|dry| dry.breakaway),
            NumberKind::Stiffness
            | NumberKind::Centre
            | NumberKind::HalfDistance
            | NumberKind::Restitution => None,
        }
    }

    /// Adds a law with these numbers. Parts that two laws have in common add up; their widths and smoothing loads are those of the later law
    /// whose part is not 0.
    pub(crate) fn add(&mut self, law: Law, numbers: &[f64]) {
        let of = |kind: NumberKind| {
            let place = NumberKind::of(law).iter().position(|own| *own == kind);
            place.and_then(|k| numbers.get(k)).copied()
        };
        if let Some(damping) = of(NumberKind::Damping) {
            self.viscous += damping;
            self.viscous_asymmetry += of(NumberKind::DampingAsymmetry).unwrap_or_default();
        }
        let Some(constant) = of(NumberKind::Friction) else { return };
        let load = of(NumberKind::Load).unwrap_or_default();
        let dry = self.dry.get_or_insert_default();
        let is_first = dry.constant == 0.0 && dry.load == 0.0;
        dry.constant += constant;
        dry.asymmetry += of(NumberKind::FrictionAsymmetry).unwrap_or_default();
        dry.load += load;
        if constant != 0.0 || is_first {
            dry.width = of(NumberKind::Width).unwrap_or(dry.width);
        }
        dry.smoothing = of(NumberKind::Smoothing).unwrap_or(dry.smoothing);
        dry.breakaway = of(NumberKind::Breakaway).or(dry.breakaway);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_several_laws_add_up() {
        let mut own = CoordinateFriction::default();
        own.add(Law::Directional, &[0.5, 0.25, 0.0, 0.0, 0.3]);
        own.add(Law::Sticking, &[0.7, -0.5, 0.125, 0.2, 1.5, 0.4]);
        let dry = own.dry.unwrap();
        assert_eq!((own.viscous, own.viscous_asymmetry), (0.5, 0.25));
        assert_eq!((dry.constant, dry.asymmetry, dry.width, dry.breakaway), (0.7, -0.5, 0.4, Some(1.5)));
        let mut loaded = CoordinateFriction::default();
        loaded.add(Law::Coulomb, &[0.0, 0.125, 0.2, 0.3]);
        loaded.add(Law::Directional, &[0.5, 0.25, 0.7, 0.5, 0.4]);
        let expected = DryNumbers {
            constant: 0.7,
            asymmetry: 0.5,
            load: 0.125,
            smoothing: 0.2,
            width: 0.4,
            breakaway: None,
        };
        assert_eq!(loaded.dry, Some(expected));
        let mut damped = CoordinateFriction::default();
        damped.add(Law::Viscous, &[0.5]);
        damped.add(Law::Servo, &[7.0]);
        assert_eq!(damped, CoordinateFriction { viscous: 0.5, ..CoordinateFriction::default() });
    }
}
