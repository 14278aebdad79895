//! Rigid bodies on joints, in the plane and in space.

pub mod plane;
pub mod space;

pub use plane::{BodiesArchitecture, BodyNumbers};
pub use space::{ArmArchitecture, ArmBody, ArmDynamics};

use crate::source::ConstantType;
use leastaction_core::energy::bodies::Joint;

/// Kinds of the joints, one letter each: `t` translation, `a` angle.
pub fn letters_of_joints(joints: impl Iterator<Item = Joint>) -> String {
    let letter = |joint| match joint {
        Joint::Revolute => 'a',
        Joint::Prismatic => 't',
    };
    joints.map(letter).collect()
}

/// Describes the energies for the source of a program: their name, the path to import, the name of the header, and the printed shape.
fn tree_type([energies, module, header]: [&'static str; 3], shape: String) -> ConstantType {
    ConstantType { energies, module, header, shape: shape.replace("bodies: [", "bodies: &["), network: None }
}
