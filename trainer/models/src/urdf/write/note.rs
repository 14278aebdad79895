//! Notes on a description that was written.

use std::fmt;

/// A note on a description that was written.
#[derive(Clone, Debug, PartialEq)]
pub enum WriteNote {
    /// The moving bodies alone were written.
    Fresh {
        /// Reason why the text of the description was not edited.
        why: &'static str,
    },
    /// Bodies have parts on joints that are held still.
    Held {
        /// Names of the joints.
        joints: Vec<String>,
    },
    /// Inertias of rotors have no place in the format.
    Rotors,
    /// Gravity has no place in the format.
    Gravity {
        /// Gravity in the base frame, m/s².
        gravity: [f64; 3],
    },
}

impl fmt::Display for WriteNote {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Fresh { why } => write!(
                f,
                "{why}, so the file is written anew: moving bodies with their joints, without meshes and without what \
                 is fixed to the base"
            ),
            Self::Held { joints } => write!(
                f,
                "the masses of links on joints that are held still are part of the bodies that carry them; they are right \
                 where these joints were held: {}",
                joints.join(", ")
            ),
            Self::Rotors => f.write_str(
                "URDF has no inertia of a joint's rotor: it stands in a comment of each <joint>, which programs pass over; \
                 --mjcf writes it as armature",
            ),
            Self::Gravity { gravity: [x, y, z] } => {
                write!(f, "URDF has no gravity: the model's is ({x}, {y}, {z}) m/s²")
            }
        }
    }
}
