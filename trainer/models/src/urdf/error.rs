//! Errors of a robot description.

use crate::tree::TreeError;
use std::path::PathBuf;
use thiserror::Error;

/// Reason why a robot description cannot be used. Links and joints are named as in the file.
#[derive(Debug, Error)]
pub enum UrdfError {
    /// The file cannot be read.
    #[error("{}: {error}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Reason given by the operating system.
        error: std::io::Error,
    },
    /// Not XML, or XML with a document type, which no robot needs and which can contain entities of any size.
    #[error("not XML that a robot can be read from: {0}")]
    Xml(#[from] roxmltree::Error),
    /// More text than any robot has.
    #[error("{0} bytes; a robot description has at most {MOST_BYTES}")]
    Bytes(usize),
    /// More links than any robot has.
    #[error("{0} links; at most {MOST_LINKS} are read")]
    Links(usize),
    /// The outermost element is neither `<robot>` nor `<mujoco>`.
    #[error(
        "the outermost element is <{0}>, neither <robot> (URDF) nor <mujoco> (MJCF); a xacro file must be expanded first"
    )]
    NotRobot(String),
    /// An element of an MJCF file that cannot be read.
    #[error("line {line}: {message}")]
    Mjcf {
        /// Line in the file, from 1.
        line: u32,
        /// Element and reason, in words.
        message: String,
    },
    /// A file that xacro has not expanded.
    #[error(
        "line {line}: {what} belongs to xacro, which has not expanded this file; expand it first: `xacro in.urdf.xacro > out.urdf` (ROS 2)"
    )]
    Xacro {
        /// Line in the file, from 1.
        line: u32,
        /// Element or expression as written.
        what: String,
    },
    /// More than one fault.
    #[error("{} faults: {}", .0.len(), several(.0))]
    Several(Vec<UrdfError>),
    /// A missing attribute or element.
    #[error("{at}: {what} is missing")]
    Missing {
        /// Link or joint.
        at: String,
        /// Element or attribute.
        what: &'static str,
    },
    /// Text other than the expected numbers.
    #[error("{at}: {what} = \"{found}\" should be {expected} finite number{}", if *expected == 1 { "" } else { "s" })]
    Number {
        /// Link or joint.
        at: String,
        /// Attribute.
        what: &'static str,
        /// Text as written.
        found: String,
        /// Expected count of numbers.
        expected: usize,
    },
    /// Two links or joints of the same name.
    #[error("{0} stands twice")]
    Twice(String),
    /// A joint with a link that does not exist.
    #[error("joint {joint}: there is no link {link}")]
    NoLink {
        /// Name of the joint.
        joint: String,
        /// Name of the link as given.
        link: String,
    },
    /// A link with two parents.
    #[error("link {link} is the child of two joints, {first} and {second}")]
    TwoParents {
        /// Name of the link.
        link: String,
        /// First of the joints.
        first: String,
        /// Second of the joints.
        second: String,
    },
    /// A description without links.
    #[error("there is no <link> in it; if xacro made the file, it called no macro that makes a robot")]
    NoLinks,
    /// No link is without a parent.
    #[error("every link is the child of a joint: the joints go round in a circle, and there is no base")]
    NoRoot,
    /// Two or more links without a parent.
    #[error("links {first} and {second} are both the child of no joint; one base must carry all")]
    TwoRoots {
        /// First of the links.
        first: String,
        /// Second of the links.
        second: String,
    },
    /// A cycle of joints that is not connected to the base.
    #[error("link {0} hangs on no base: its joints go round in a circle")]
    Cycle(String),
    /// A joint of an unknown kind.
    #[error(
        "joint {joint}: type {kind}; revolute, continuous, prismatic and fixed joints are known, and floating and planar ones are held still"
    )]
    Kind {
        /// Name of the joint.
        joint: String,
        /// Kind as written.
        kind: String,
    },
    /// A choice of a joint that the description does not have.
    #[error("no joint is called {name:?}; there are: {known}")]
    NoJoint {
        /// Key of the choice: joints or lock.
        key: &'static str,
        /// Name as given.
        name: String,
        /// Names of the joints that move.
        known: String,
    },
    /// A choice of a joint that cannot be made.
    #[error("joint {joint} {why}")]
    Choice {
        /// Key of the choice: joints or lock.
        key: &'static str,
        /// Name of the joint.
        joint: String,
        /// Reason, in words.
        why: String,
    },
    /// A description with other joints than the numbers that are to be written into it.
    #[error(
        "the description no longer has the joints that the model was learned with; restore the file, or train again"
    )]
    OtherJoints,
    /// An axis without direction.
    #[error("joint {0}: its axis is zero")]
    Axis(String),
    /// A moving body with a mass below 0.
    #[error("link {link}, moved by joint {joint}, has a mass of {mass} kg together with what is fixed to it")]
    NegativeMass {
        /// Name of the link.
        link: String,
        /// Name of its joint.
        joint: String,
        /// Mass of the body, kg.
        mass: f64,
    },
    /// A moving link without mass.
    #[error("link {link}, moved by joint {joint}, has no mass ({found}), and nothing that it carries has")]
    NoInertia {
        /// Name of the link.
        link: String,
        /// Name of its joint.
        joint: String,
        /// Reason, in words: no `<inertial>`, a mass of 0, or a shape that is not read.
        found: String,
    },
    /// A joint that follows itself, if by way of others.
    #[error("joint {0} follows itself: the joints that follow each other (<mimic>) go round in a circle")]
    Mimic(String),
    /// The remaining bodies form no tree.
    #[error(transparent)]
    Tree(#[from] TreeError),
}

/// Maximum size of a description, in bytes.
pub const MOST_BYTES: usize = 1 << 24;
/// Maximum number of links.
pub const MOST_LINKS: usize = 4096;

/// Number of faults that one error writes out.
pub(super) const MOST_WRITTEN: usize = 20;

impl UrdfError {
    /// Whether bodies without mass are among the faults.
    #[must_use]
    pub fn lacks_mass(&self) -> bool {
        match self {
            Self::NoInertia { .. } => true,
            Self::Several(faults) => faults.iter().any(|fault| matches!(fault, Self::NoInertia { .. })),
            _ => false,
        }
    }

    /// Key of the choice that is wrong; `None` if the file is.
    #[must_use]
    pub fn key(&self) -> Option<&'static str> {
        match self {
            Self::NoJoint { key, .. } | Self::Choice { key, .. } => Some(key),
            _ => None,
        }
    }
}

/// Faults one after the other, as many as fit.
fn several(faults: &[UrdfError]) -> String {
    let written: Vec<String> = faults.iter().take(MOST_WRITTEN).map(ToString::to_string).collect();
    let more = faults.len().saturating_sub(MOST_WRITTEN);
    let rest = if more > 0 { format!("; and {more} more") } else { String::new() };
    written.join("; ") + &rest
}
