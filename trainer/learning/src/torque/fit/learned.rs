//! What a fit learns, and what it knows.

use super::friction::{JOINT, JointNumber, SOFTNESS};

/// Most of a load that friction may take.
const MOST_LOAD: f64 = 0.9;

/// What bodies may become.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bodies {
    /// Bodies that can be: of positive definite pseudo-inertia.
    Consistent,
    /// Any numbers, as linear least squares gives them.
    Free,
    /// Those of the tree.
    Known,
}

/// What is learned of bodies and joints.
#[derive(Clone, Debug, PartialEq)]
pub struct Learned {
    /// Of the bodies.
    pub bodies: Bodies,
    /// Bodies that are known whatever the others are, by their places in the tree.
    pub known: Vec<usize>,
    /// Rotor inertia ≥ 0.
    pub rotors: bool,
    /// Viscous friction ≥ 0.
    pub viscous: bool,
    /// Coulomb friction ≥ 0.
    pub coulomb: bool,
    /// Friction that grows with the load.
    pub load: bool,
    /// A constant offset of every logged torque.
    pub offsets: bool,
    /// The range of the width ε of tanh(v/ε); one number twice where it is known.
    pub width: [f64; 2],
    /// The range of the smoothing s of a load; one number twice where it is known.
    pub smoothing: [f64; 2],
    /// Numbers of single joints that are known whatever the others are, by the coordinate.
    pub held: Vec<(usize, JointNumber, f64)>,
}

impl Default for Learned {
    /// Consistent bodies, rotors, all friction, that grows with the load of known smoothing, offsets, widths from 0.02 to 1 rad/s.
    fn default() -> Self {
        Self {
            bodies: Bodies::Consistent,
            known: Vec::new(),
            rotors: true,
            viscous: true,
            coulomb: true,
            load: true,
            offsets: true,
            width: [0.02, 1.0],
            smoothing: [SOFTNESS; 2],
            held: Vec::new(),
        }
    }
}

impl Learned {
    /// Where the numbers of a joint may be; of a joint without dry friction the width is this.
    pub(super) fn ranges(&self, joint: usize, width: f64) -> [[f64; 2]; JOINT] {
        let most = |is_learned: bool, most: f64| if is_learned { most } else { 0.0 };
        let all = |is_learned: bool| most(is_learned, f64::INFINITY);
        let offset = all(self.offsets);
        let mut ranges = [
            [0.0, all(self.rotors)],
            [0.0, all(self.viscous)],
            [0.0, all(self.coulomb)],
            [0.0, most(self.load, MOST_LOAD)],
            if self.coulomb || self.load { self.width } else { [width; 2] },
            [-offset, offset],
            if self.load { self.smoothing } else { [SOFTNESS; 2] },
        ];
        for (_, number, value) in self.held.iter().filter(|(of, ..)| *of == joint) {
            ranges[*number as usize] = [*value; 2];
        }
        ranges
    }
}
