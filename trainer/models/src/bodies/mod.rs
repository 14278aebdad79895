//! Rigid bodies on joints: in the plane, and in space.

pub mod plane;
pub mod space;

pub use plane::{BodiesArchitecture, BodyNumbers};
pub use space::{ArmArchitecture, ArmBody};

use leastaction_core::energy::bodies::Joint;

/// One letter a joint: `t` translation, `a` angle.
pub fn letters_of_joints(joints: impl Iterator<Item = Joint>) -> String {
    let letter = |joint| match joint {
        Joint::Revolute => 'a',
        Joint::Prismatic => 't',
    };
    joints.map(letter).collect()
}
