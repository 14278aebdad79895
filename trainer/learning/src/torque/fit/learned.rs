//! Selection of the learned and the known numbers of a fit.

use super::friction::{JOINT, JointNumber, SOFTNESS};
use leastaction_models::{Architecture, NumberKind};

/// Largest load coefficient.
const MOST_LOAD: f64 = 0.9;

/// Constraint on the fitted bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bodies {
    /// Physically consistent bodies: their pseudo-inertia is positive definite.
    Consistent,
    /// Unconstrained numbers, as linear least squares gives them.
    Free,
    /// The bodies of the tree, unchanged.
    Known,
}

/// Numbers of bodies and joints that are learned.
#[derive(Clone, Debug, PartialEq)]
pub struct Learned {
    /// Constraint on the bodies.
    pub bodies: Bodies,
    /// Indices in the tree of bodies that are known whatever `bodies` says.
    pub known: Vec<usize>,
    /// Rotor inertia ≥ 0.
    pub rotors: bool,
    /// Viscous friction ≥ 0.
    pub viscous: bool,
    /// Coulomb friction ≥ 0.
    pub coulomb: bool,
    /// Friction that grows with the load.
    pub load: bool,
    /// Asymmetries of viscous and of Coulomb friction.
    pub asymmetries: [bool; 2],
    /// A constant offset of every logged torque.
    pub offsets: bool,
    /// Range of the width ε of tanh(v/ε); equal ends if it is known.
    pub width: [f64; 2],
    /// Range of the smoothing s of a load; equal ends if it is known.
    pub smoothing: [f64; 2],
    /// Known numbers of single joints, each with its coordinate; they override the other settings.
    pub held: Vec<(usize, JointNumber, f64)>,
}

impl Default for Learned {
    /// Consistent bodies, rotors, offsets, and all friction are learned, including its growth with the load at a known
    /// smoothing. Widths are learned from 0.02 to 1 rad/s.
    fn default() -> Self {
        Self {
            bodies: Bodies::Consistent,
            known: Vec::new(),
            rotors: true,
            viscous: true,
            coulomb: true,
            load: true,
            asymmetries: [false; 2],
            offsets: true,
            width: [0.02, 1.0],
            smoothing: [SOFTNESS; 2],
            held: Vec::new(),
        }
    }
}

impl Learned {
    /// The friction for which laws of a shape have numbers, and all else by default.
    pub fn friction_of(architecture: &Architecture) -> Self {
        let has = |kind: NumberKind| architecture.has_law_number(kind);
        Self {
            viscous: has(NumberKind::Damping),
            coulomb: has(NumberKind::Friction),
            load: has(NumberKind::Load),
            asymmetries: [NumberKind::DampingAsymmetry, NumberKind::FrictionAsymmetry].map(has),
            ..Self::default()
        }
    }

    /// Ranges of the numbers of a joint; `width` is the width of a joint without dry friction.
    pub(super) fn ranges(&self, joint: usize, width: f64) -> [[f64; 2]; JOINT] {
        let most = |is_learned: bool, most: f64| if is_learned { most } else { 0.0 };
        let all = |is_learned: bool| most(is_learned, f64::INFINITY);
        let offset = all(self.offsets);
        let [beta, delta] = self.asymmetries.map(|is_learned| most(is_learned, 1.0));
        let mut ranges = [
            [0.0, all(self.rotors)],
            [0.0, all(self.viscous)],
            [0.0, all(self.coulomb)],
            [0.0, most(self.load, MOST_LOAD)],
            if self.coulomb || self.load || self.asymmetries[0] { self.width } else { [width; 2] },
            [-offset, offset],
            if self.load { self.smoothing } else { [SOFTNESS; 2] },
            [-beta, beta],
            [-delta, delta],
        ];
        for (_, number, value) in self.held.iter().filter(|(of, ..)| *of == joint) {
            ranges[*number as usize] = [*value; 2];
        }
        ranges
    }
}
