//! Rigid bodies on joints: in the plane, and in space.

pub mod plane;
pub mod space;

pub use plane::{BodiesArchitecture, BodyNumbers};
pub use space::{ArmArchitecture, ArmBody};

use crate::source::ConstantType;
use leastaction_core::energy::bodies::Joint;

/// One letter a joint: `t` translation, `a` angle.
pub fn letters_of_joints(joints: impl Iterator<Item = Joint>) -> String {
    let letter = |joint| match joint {
        Joint::Revolute => 'a',
        Joint::Prismatic => 't',
    };
    joints.map(letter).collect()
}

/// Names of the energies, what is taken of their module, and of the shape, with the shape as it is printed, in the source of a program.
fn tree_type([energies, module, header]: [&'static str; 3], shape: String) -> ConstantType {
    ConstantType { energies, module, header, shape: shape.replace("bodies: [", "bodies: &["), network: None }
}
