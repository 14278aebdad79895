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
    /// The outermost element is not `<robot>`.
    #[error("the outermost element is <{0}>, not <robot>; a xacro file must be expanded first")]
    NotRobot(String),
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
    /// A joint of a kind that has no single coordinate.
    #[error("joint {joint}: type {kind}; revolute, continuous, prismatic and fixed joints are known")]
    Kind {
        /// Name of the joint.
        joint: String,
        /// Kind as written.
        kind: String,
    },
    /// An axis without direction.
    #[error("joint {0}: its axis is zero")]
    Axis(String),
    /// A mass below 0.
    #[error("link {link}: its mass is {mass} kg")]
    NegativeMass {
        /// Name of the link.
        link: String,
        /// Mass as written, kg.
        mass: f64,
    },
    /// A physically impossible inertia.
    #[error(
        "link {0}: no body has this inertia (a principal moment is negative or larger than the sum of the others)"
    )]
    NotABody(String),
    /// A moving link without mass.
    #[error(
        "link {link}, moved by joint {joint}, has no mass, and nothing fixed to it has: <inertial> is missing"
    )]
    NoInertia {
        /// Name of the link.
        link: String,
        /// Name of its joint.
        joint: String,
    },
    /// A joint that follows one that does not exist, does not move, or follows another one.
    #[error("joint {joint} follows {leader}, which {why}")]
    Mimic {
        /// Name of the joint.
        joint: String,
        /// Name of the joint that it follows.
        leader: String,
        /// Reason, in words.
        why: &'static str,
    },
    /// The remaining bodies form no tree.
    #[error(transparent)]
    Tree(#[from] TreeError),
}

/// Maximum size of a description, in bytes.
pub const MOST_BYTES: usize = 1 << 24;
/// Maximum number of links.
pub const MOST_LINKS: usize = 4096;
