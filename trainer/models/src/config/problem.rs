//! What is wrong with `[model]`, and where in the configuration.

use std::fmt;
use std::path::PathBuf;
use thiserror::Error;

/// A step on the way to a value of the configuration.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Step {
    /// The key of a table.
    Key(String),
    /// The position in an array, from 0.
    Index(usize),
}

impl Step {
    /// The key, empty for a position.
    pub fn key(&self) -> &str {
        match self {
            Self::Key(key) => key,
            Self::Index(_) => "",
        }
    }

    /// The position, where it is one.
    pub fn index(&self) -> Option<usize> {
        match self {
            Self::Key(_) => None,
            Self::Index(index) => Some(*index),
        }
    }
}

impl From<&str> for Step {
    fn from(key: &str) -> Self {
        Self::Key(key.to_owned())
    }
}

impl From<usize> for Step {
    fn from(index: usize) -> Self {
        Self::Index(index)
    }
}

/// A `[model]` of element types and trees, or of node and edge types and graphs, that cannot be.
#[derive(Clone, Debug, PartialEq, Error)]
pub struct ShapeError {
    /// From the top of the file to the value.
    pub place: Vec<Step>,
    /// What is wrong there.
    pub problem: Problem,
}

impl fmt::Display for ShapeError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        for (i, step) in self.place.iter().enumerate() {
            match step {
                Step::Key(key) if i == 0 => write!(f, "{key}")?,
                Step::Key(key) => write!(f, ".{key}")?,
                Step::Index(index) => write!(f, "[{index}]")?,
            }
        }
        write!(f, ": {}", self.problem)
    }
}

/// What is wrong with trees of elements or with graphs.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Problem {
    /// Rows that the factor of an inertia matrix cannot have.
    #[error("{rows} rows; the factor of this inertia matrix has {least} to {most}")]
    Rows {
        /// That are asked for.
        rows: u8,
        /// As many as coordinates.
        least: u8,
        /// At most.
        most: u8,
    },
    /// Rows where there is no factor.
    #[error("only inertia = \"factor\" has rows")]
    RowsWithoutFactor,
    /// More coordinates than the file format has outputs for.
    #[error(
        "an inertia matrix of {n} coordinates has no factor within the 255 outputs of a network; set inertia = \"cholesky\""
    )]
    TooManyForFactor {
        /// Coordinates.
        n: usize,
    },
    /// The model to go on from cannot be read.
    #[error("{message}")]
    From {
        /// Why.
        message: String,
    },
    /// The model to go on from is of another family.
    #[error("{} holds a {found} model, which has no element types; name a modular one", file.display())]
    OtherFamily {
        /// The run or the model file.
        file: PathBuf,
        /// Its family.
        found: &'static str,
    },
    /// The model to start from has other coordinates.
    #[error(
        "{} holds a model of the coordinates {found:?}, or one with rods; to start from is one of {needed:?}, without rods (t: a length, \
         others: angles)",
        file.display()
    )]
    OtherCoordinates {
        /// The run or the model file.
        file: PathBuf,
        /// Its coordinates, one letter each.
        found: String,
        /// Those of this model.
        needed: String,
    },
    /// No element type.
    #[error(
        "no element types: add a [[model.types]] with a name and a transform, or name a trained model with from = \"run\""
    )]
    NoTypes,
    /// More than the model file or this program holds.
    #[error("{found} {what}, but at most {most} can be held")]
    TooMany {
        /// Of what.
        what: &'static str,
        /// Asked for.
        found: usize,
        /// Held.
        most: usize,
    },
    /// A name that a model file cannot hold.
    #[error("{name:?} cannot be a name: give it at least one letter, and no comma")]
    Name {
        /// The name.
        name: String,
    },
    /// Two types of one name.
    #[error("there is another type {name:?}; give each its own name")]
    Twice {
        /// The name.
        name: String,
    },
    /// A new type that does not say how it moves.
    #[error(
        "how does {name:?} move? add transform = \"angle\" or \"translation\" (learned), \"rod\", \"slide\" or \"free\" (known)"
    )]
    NoTransform {
        /// The type.
        name: String,
    },
    /// A key that has no meaning for this transform.
    #[error("`{key}` means nothing for transform = \"{transform}\"; leave it out")]
    Meaningless {
        /// The key.
        key: &'static str,
        /// The transform.
        transform: &'static str,
    },
    /// A key that would change a trained network.
    #[error(
        "`{key}` of {name:?} cannot be changed: its networks come from the trained model; give a new type another name"
    )]
    Trained {
        /// The key.
        key: &'static str,
        /// The type.
        name: String,
    },
    /// A second pair potential.
    #[error("the trained model has a pair potential already; leave out [model.pair]")]
    Pair,
    /// A number out of its range.
    #[error("`{key}` is {value}; it must be {range}")]
    OutOfRange {
        /// The key.
        key: &'static str,
        /// As given.
        value: f64,
        /// In words.
        range: &'static str,
    },
    /// Not as many numbers as there are dimensions.
    #[error("`{key}` has {found} numbers; it must have {needed}, one for each dimension")]
    Dimensions {
        /// The key.
        key: &'static str,
        /// Given.
        found: usize,
        /// Of space.
        needed: usize,
    },
    /// Not as many numbers of friction as there are groups of coordinates.
    #[error("`{key}` has {found} numbers; it must have {needed}, one for each {what}, or one alone for all")]
    FrictionCount {
        /// The key.
        key: &'static str,
        /// Given.
        found: usize,
        /// Groups.
        needed: usize,
        /// Coordinate or element type.
        what: &'static str,
    },
    /// A number of dry friction where there is none.
    #[error("`{key}` means nothing without dry friction; add coulomb = \"learned\", or leave it out")]
    NoDryFriction {
        /// The key.
        key: &'static str,
    },
    /// Viscous damping at two keys.
    #[error("viscous damping is given by `{key}` too; leave one of them out")]
    DampingTwice {
        /// The other key.
        key: &'static str,
    },
    /// A coordinate of a network that does not exist.
    #[error(
        "there is no coordinate {coordinate} in every tree of the model: {coordinates} are common to all, counted from 0"
    )]
    NoCoordinate {
        /// As given.
        coordinate: u64,
        /// Of the model, of several trees that of the shortest.
        coordinates: usize,
    },
    /// A coordinate twice.
    #[error("coordinate {coordinate} stands there twice")]
    CoordinateTwice {
        /// From 0.
        coordinate: usize,
    },
    /// A network that sees nothing.
    #[error("a network must see a coordinate; name one, as [0], or leave out the network")]
    NothingSeen,
    /// The position of a coordinate that a network does not see.
    #[error("coordinate {coordinate} is not among `coordinates` of this network")]
    Unseen {
        /// From 0.
        coordinate: usize,
    },
    /// A potential of a cyclic coordinate.
    #[error("coordinate {coordinate} is cyclic: energies do not depend on it")]
    Cyclic {
        /// From 0.
        coordinate: usize,
    },
    /// A type that does not exist.
    #[error("no {what} is called {name:?}; there are: {known}")]
    UnknownType {
        /// Element type, node type or edge type.
        what: &'static str,
        /// As given.
        name: String,
        /// All names.
        known: String,
    },
    /// An element that hangs from one that does not come before it.
    #[error(
        "element {element} hangs from element {on}, which does not come before it (a cycle?): elements count from 0, parents \
         first; without `on` an element hangs from the ground"
    )]
    Parent {
        /// The element, from 0.
        element: usize,
        /// What it hangs from.
        on: u64,
    },
    /// A tree without elements.
    #[error("a tree needs at least one element")]
    EmptyTree,
    /// No tree at all.
    #[error("no tree: add [model.trees] with a line as double = [\"bob\", \"bob\"]")]
    NoTree,
    /// Several trees, and none is chosen.
    #[error("which tree is the data of? add tree = \"...\" to [model]; there are: {known}")]
    WhichTree {
        /// All names.
        known: String,
    },
    /// A tree that does not exist.
    #[error("no tree is called {name:?}; there are: {known}")]
    UnknownTree {
        /// As given.
        name: String,
        /// All names.
        known: String,
    },
    /// No body.
    #[error("no bodies: add chain = 2, for a chain of two, or a [[model.bodies]] with a joint")]
    NoBodies,
    /// Bodies twice.
    #[error("chain and [[model.bodies]] both say which bodies there are; leave one of them out")]
    ChainAndBodies,
    /// A gear ratio of no chain.
    #[error("only a chain has one gear ratio; give every one of [[model.bodies]] its own")]
    GearWithoutChain,
    /// A body on one that does not come before it.
    #[error(
        "body {body} sits on body {on}, which does not come before it: bodies count from 0, parents first; without `on` a body \
         sits on the ground"
    )]
    OnBody {
        /// The body, from 0.
        body: usize,
        /// What it sits on.
        on: u64,
    },
    /// A robot description that cannot be read.
    #[error("{}: {message}", file.display())]
    Description {
        /// The file.
        file: PathBuf,
        /// What is wrong.
        message: String,
    },
    /// A joint that follows another one.
    #[error(
        "{}: a joint follows another one (<mimic>), and each joint of a model must have a coordinate of its own; give it a fixed joint, or \
         one of its own",
        file.display()
    )]
    Follows {
        /// The file.
        file: PathBuf,
    },
    /// Inertial numbers of no body.
    #[error(
        "link {link}: its inertia is of no body that can be (a moment of inertia is larger than the sum of the other two, or the mass is 0), \
         so it cannot be where training begins; correct it, or set bodies = \"known\""
    )]
    NoBodyThatCanBe {
        /// The link.
        link: String,
    },
    /// Another arm.
    #[error("{} holds another model than the arm of {}: other bodies, or the same on other joints", file.display(), urdf.display())]
    OtherArm {
        /// The run or the model file.
        file: PathBuf,
        /// The description.
        urdf: PathBuf,
    },
    /// No node type.
    #[error("no node types: add a [[model.node_types]] with a name and a mass")]
    NoNodeTypes,
    /// No graph at all.
    #[error(
        "no graph: add [model.graphs.three] with nodes = [\"bob\", \"bob\", \"bob\"] and what joins them"
    )]
    NoGraph,
    /// A graph without nodes.
    #[error("a graph needs at least one node")]
    EmptyGraph,
    /// Several graphs, and none is chosen.
    #[error("which graph is the data of? add graph = \"...\" to [model]; there are: {known}")]
    WhichGraph {
        /// All names.
        known: String,
    },
    /// A graph that does not exist.
    #[error("no graph is called {name:?}; there are: {known}")]
    UnknownGraph {
        /// As given.
        name: String,
        /// All names.
        known: String,
    },
    /// A pair of nodes where there is not exactly one edge type.
    #[error(
        "of which type is this edge? write {{ type = \"...\", between = [0, 1] }}; a pair alone does where there is one edge type"
    )]
    WhichEdgeType,
    /// An edge or a rod to a node that does not exist.
    #[error("there is no node {node}: the graph has {nodes}, counted from 0")]
    NoNode {
        /// As given.
        node: u16,
        /// Of the graph.
        nodes: usize,
    },
    /// An edge or a rod from a node to itself.
    #[error("it joins node {node} to itself; name two nodes")]
    Loop {
        /// The node.
        node: u16,
    },
    /// A tree or a graph of a size that this program cannot train.
    #[error("{found} coordinates to train; this program takes {most}")]
    Size {
        /// Of the tree or graph.
        found: usize,
        /// How many can be trained.
        most: String,
    },
}

impl Problem {
    /// This problem at a place of the configuration.
    pub(crate) fn at<const N: usize>(self, place: [Step; N]) -> ShapeError {
        let place = std::iter::once(Step::from("model")).chain(place).collect();
        ShapeError { place, problem: self }
    }
}

/// Refuses what a model file cannot hold as a name.
pub(crate) fn check_name(name: &str) -> Result<(), Problem> {
    let good = !name.trim().is_empty() && !name.contains(',');
    if good { Ok(()) } else { Err(Problem::Name { name: name.to_owned() }) }
}

/// Names or numbers, for people.
pub(crate) fn list<T: ToString>(names: impl Iterator<Item = T>) -> String {
    names.map(|name| name.to_string()).collect::<Vec<_>>().join(", ")
}

/// Refuses more than can be held; `key` is where they are.
pub(crate) fn check_count(
    what: &'static str,
    key: &str,
    found: usize,
    most: usize,
) -> Result<(), ShapeError> {
    let too_many = Problem::TooMany { what, found, most };
    if found <= most { Ok(()) } else { Err(too_many.at([key.into()])) }
}
