//! What can be wrong with a robot description.

use crate::tree::TreeError;
use std::path::PathBuf;
use thiserror::Error;

/// A robot description that cannot be used. Links and joints are named as in the file.
#[derive(Debug, Error)]
pub enum UrdfError {
    /// The operating system says why.
    #[error("{}: {error}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        error: std::io::Error,
    },
    /// Not XML, or XML with a document type, which no robot needs and which entities of any size come from.
    #[error("not XML that a robot can be read from: {0}")]
    Xml(#[from] roxmltree::Error),
    /// More text than any robot has.
    #[error("{0} bytes; a robot description has at most {MOST_BYTES}")]
    Bytes(usize),
    /// More links than any robot has.
    #[error("{0} links; at most {MOST_LINKS} are read")]
    Links(usize),
    /// The outermost element is another one.
    #[error("the outermost element is <{0}>, not <robot>; a xacro file must be expanded first")]
    NotRobot(String),
    /// An attribute or element that is needed.
    #[error("{at}: {what} is missing")]
    Missing {
        /// Link or joint.
        at: String,
        /// Element or attribute.
        what: &'static str,
    },
    /// Text that is not the numbers it should be.
    #[error("{at}: {what} = \"{found}\" should be {expected} finite number{}", if *expected == 1 { "" } else { "s" })]
    Number {
        /// Link or joint.
        at: String,
        /// Attribute.
        what: &'static str,
        /// As written.
        found: String,
        /// How many.
        expected: usize,
    },
    /// Two of a name.
    #[error("{0} stands twice")]
    Twice(String),
    /// A joint with a link that is not there.
    #[error("joint {joint}: there is no link {link}")]
    NoLink {
        /// Which joint.
        joint: String,
        /// As named.
        link: String,
    },
    /// A link with two parents.
    #[error("link {link} is the child of two joints, {first} and {second}")]
    TwoParents {
        /// Which link.
        link: String,
        /// A joint.
        first: String,
        /// The other.
        second: String,
    },
    /// No link is without a parent.
    #[error("every link is the child of a joint: the joints go round in a circle, and there is no base")]
    NoRoot,
    /// Links without a parent.
    #[error("links {first} and {second} are both the child of no joint; one base must carry all")]
    TwoRoots {
        /// A link.
        first: String,
        /// Another one.
        second: String,
    },
    /// A circle beside the base.
    #[error("link {0} hangs on no base: its joints go round in a circle")]
    Cycle(String),
    /// A joint of a kind that has no single coordinate.
    #[error("joint {joint}: type {kind}; revolute, continuous, prismatic and fixed joints are known")]
    Kind {
        /// Which.
        joint: String,
        /// As written.
        kind: String,
    },
    /// An axis without direction.
    #[error("joint {0}: its axis is zero")]
    Axis(String),
    /// A mass below 0.
    #[error("link {link}: its mass is {mass} kg")]
    NegativeMass {
        /// Which.
        link: String,
        /// As written, kg.
        mass: f64,
    },
    /// An inertia of no body.
    #[error(
        "link {0}: no body has this inertia (a principal moment is negative or larger than the sum of the others)"
    )]
    NotABody(String),
    /// A moving link without mass.
    #[error(
        "link {link}, moved by joint {joint}, has no mass, and nothing fixed to it has: <inertial> is missing"
    )]
    NoInertia {
        /// Which link.
        link: String,
        /// Its joint.
        joint: String,
    },
    /// A joint that follows one that is not there, or itself.
    #[error("joint {joint} follows {leader}, which {why}")]
    Mimic {
        /// Which.
        joint: String,
        /// The other one.
        leader: String,
        /// What is wrong.
        why: &'static str,
    },
    /// What is left is no tree.
    #[error(transparent)]
    Tree(#[from] TreeError),
}

/// Bytes of a description at most.
pub const MOST_BYTES: usize = 1 << 24;
/// Links at most.
pub const MOST_LINKS: usize = 4096;
