//! Errors of `[model]`.

use crate::laws::stops::StopsProblem;
use std::path::PathBuf;
use thiserror::Error;

/// A problem with the value at a place of `[model]`.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Problem {
    /// A number of rows that the factor of an inertia matrix cannot have.
    #[error("{rows} rows; the factor of this inertia matrix has {least} to {most}")]
    Rows {
        /// Number of rows asked for.
        rows: u8,
        /// Smallest number: the number of coordinates.
        least: u8,
        /// Largest number.
        most: u8,
    },
    /// Rows for an inertia matrix without a factor.
    #[error("only inertia = \"factor\" has rows")]
    RowsWithoutFactor,
    /// More coordinates than the file format has outputs for.
    #[error(
        "an inertia matrix of {n} coordinates has no factor within the 255 outputs of a network; set inertia = \"cholesky\""
    )]
    TooManyForFactor {
        /// Number of coordinates.
        n: usize,
    },
    /// The model to continue from cannot be read.
    #[error("{message}")]
    From {
        /// Reason why it cannot be read.
        message: String,
    },
    /// The model to continue from is of another family.
    #[error("{} holds a {found} model, which has no element types; name a modular one", file.display())]
    OtherFamily {
        /// Run or model file.
        file: PathBuf,
        /// Family of its model.
        found: &'static str,
    },
    /// The model to start from has other coordinates.
    #[error(
        "{} holds a model of the coordinates {found:?}, or one with rods; to start from is one of {needed:?}, without rods (t: a length, \
         others: angles)",
        file.display()
    )]
    OtherCoordinates {
        /// Run or model file.
        file: PathBuf,
        /// Coordinates of its model, one letter each.
        found: String,
        /// Coordinates of the new model.
        needed: String,
    },
    /// No element types.
    #[error(
        "no element types: add a [[model.types]] with a name and a transform, or name a trained model with from = \"run\""
    )]
    NoTypes,
    /// More than the model file or this program can hold.
    #[error("{found} {what}, but at most {most} can be held")]
    TooMany {
        /// Kind of the items.
        what: &'static str,
        /// Number asked for.
        found: usize,
        /// Largest number that can be held.
        most: usize,
    },
    /// A name that a model file cannot hold.
    #[error("{name:?} cannot be a name: give it at least one letter, and no comma")]
    Name {
        /// Name as given.
        name: String,
    },
    /// Two types with one name.
    #[error("there is another type {name:?}; give each its own name")]
    Twice {
        /// Name of both.
        name: String,
    },
    /// A new type without a transform.
    #[error(
        "how does {name:?} move? add transform = \"angle\" or \"translation\" (learned), \"rod\", \"slide\" or \"free\" (known)"
    )]
    NoTransform {
        /// Name of the type.
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
    /// A number outside its range.
    #[error("`{key}` is {value}; it must be {range}")]
    OutOfRange {
        /// The key.
        key: &'static str,
        /// Value as given.
        value: f64,
        /// Allowed range in words.
        range: &'static str,
    },
    /// A number of entries other than the number of dimensions.
    #[error("`{key}` has {found} numbers; it must have {needed}, one for each dimension")]
    Dimensions {
        /// The key.
        key: &'static str,
        /// Number of entries given.
        found: usize,
        /// Number of dimensions of space.
        needed: usize,
    },
    /// A number of entries of a law other than the number of groups of coordinates.
    #[error("`{key}` has {found} numbers; it must have {needed}, one for each {what}, or one alone for all")]
    GroupCount {
        /// The key.
        key: &'static str,
        /// Number of entries given.
        found: usize,
        /// Number of groups.
        needed: usize,
        /// Kind of a group: coordinate or element type.
        what: &'static str,
    },
    /// A number of dry friction in a model without dry friction.
    #[error("`{key}` means nothing without dry friction; add coulomb = \"learned\", or leave it out")]
    NoDryFriction {
        /// The key.
        key: &'static str,
    },
    /// An asymmetry of damping in a model without damping.
    #[error("`viscous_asymmetry` means nothing without damping; add viscous = \"learned\", or leave it out")]
    NoDamping,
    /// A breakaway ratio of friction that does not stick.
    #[error("`breakaway` is for friction that sticks; add sticking = true, or leave it out")]
    BreakawayOfSmooth,
    /// A number of contacts that is to be learned.
    #[error("`{key}` cannot be learned, because gradients see the smooth law, which has none; give a number")]
    NeverLearned {
        /// The key.
        key: &'static str,
    },
    /// End stops that cannot be.
    #[error(transparent)]
    Stops(#[from] StopsProblem),
    /// Friction that grows with the load in a model whose commands are positions.
    #[error(
        "friction that grows with the load needs forces as commands, and with `servo` they are positions; leave `load` out"
    )]
    LoadOfServo,
    /// Viscous damping given by two keys.
    #[error("viscous damping is given by `{key}` too; leave one of them out")]
    DampingTwice {
        /// The other key.
        key: &'static str,
    },
    /// A network input that is no coordinate of the model.
    #[error(
        "there is no coordinate {coordinate} in every tree of the model: {coordinates} are common to all, counted from 0"
    )]
    NoCoordinate {
        /// Coordinate as given.
        coordinate: u64,
        /// Number of coordinates of the model; for several trees, of the shortest.
        coordinates: usize,
    },
    /// A coordinate that is given twice.
    #[error("coordinate {coordinate} stands there twice")]
    CoordinateTwice {
        /// The coordinate, from 0.
        coordinate: usize,
    },
    /// A network without inputs.
    #[error("a network must see a coordinate; name one, as [0], or leave out the network")]
    NothingSeen,
    /// The position of a coordinate that is no input of the network.
    #[error("coordinate {coordinate} is not among `coordinates` of this network")]
    Unseen {
        /// The coordinate, from 0.
        coordinate: usize,
    },
    /// A potential that depends on a cyclic coordinate.
    #[error("coordinate {coordinate} is cyclic: energies do not depend on it")]
    Cyclic {
        /// The coordinate, from 0.
        coordinate: usize,
    },
    /// A type that does not exist.
    #[error("no {what} is called {name:?}; there are: {known}")]
    UnknownType {
        /// Kind of the type: element type, node type or edge type.
        what: &'static str,
        /// Name as given.
        name: String,
        /// All known names.
        known: String,
    },
    /// An element that hangs from one that does not precede it.
    #[error(
        "element {element} hangs from element {on}, which does not come before it (a cycle?): elements count from 0, parents \
         first; without `on` an element hangs from the ground"
    )]
    Parent {
        /// The element, from 0.
        element: usize,
        /// Number of the element that it hangs from.
        on: u64,
    },
    /// A tree without elements.
    #[error("a tree needs at least one element")]
    EmptyTree,
    /// No tree at all.
    #[error("no tree: add [model.trees] with a line as double = [\"bob\", \"bob\"]")]
    NoTree,
    /// Several trees, none of which is selected.
    #[error("which tree is the data of? add tree = \"...\" to [model]; there are: {known}")]
    WhichTree {
        /// All known names.
        known: String,
    },
    /// A tree that does not exist.
    #[error("no tree is called {name:?}; there are: {known}")]
    UnknownTree {
        /// Name as given.
        name: String,
        /// All known names.
        known: String,
    },
    /// No bodies.
    #[error("no bodies: add chain = 2, for a chain of two, or a [[model.bodies]] with a joint")]
    NoBodies,
    /// Bodies given twice, as a chain and as a list.
    #[error("chain and [[model.bodies]] both say which bodies there are; leave one of them out")]
    ChainAndBodies,
    /// A gear ratio for the whole model without a chain.
    #[error("only a chain has one gear ratio; give every one of [[model.bodies]] its own")]
    GearWithoutChain,
    /// A body on one that does not precede it.
    #[error(
        "body {body} sits on body {on}, which does not come before it: bodies count from 0, parents first; without `on` a body \
         sits on the ground"
    )]
    OnBody {
        /// The body, from 0.
        body: usize,
        /// Number of the body that it sits on.
        on: u64,
    },
    /// A robot description that cannot be read.
    #[error("{}: {message}", file.display())]
    Description {
        /// The file.
        file: PathBuf,
        /// Reason why it cannot be read.
        message: String,
    },
    /// Inertial numbers at which training cannot begin.
    #[error(
        "link {link}: mass and inertia are too large or too small for training to begin there; correct them, or set bodies = \"known\""
    )]
    NoBodyThatCanBe {
        /// Name of the link.
        link: String,
    },
    /// A model of another arm.
    #[error("{} holds another model than the arm of {}: other bodies, or the same on other joints", file.display(), urdf.display())]
    OtherArm {
        /// Run or model file.
        file: PathBuf,
        /// The robot description.
        urdf: PathBuf,
    },
    /// A model of other bodies.
    #[error("{} holds another model than these bodies: start from bodies on the same joints", file.display())]
    OtherBodies {
        /// Run or model file.
        file: PathBuf,
    },
    /// No node types.
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
    /// Several graphs, none of which is selected.
    #[error("which graph is the data of? add graph = \"...\" to [model]; there are: {known}")]
    WhichGraph {
        /// All known names.
        known: String,
    },
    /// A graph that does not exist.
    #[error("no graph is called {name:?}; there are: {known}")]
    UnknownGraph {
        /// Name as given.
        name: String,
        /// All known names.
        known: String,
    },
    /// A pair of nodes as an edge of a model that does not have exactly one edge type.
    #[error(
        "of which type is this edge? write {{ type = \"...\", between = [0, 1] }}; a pair alone does where there is one edge type"
    )]
    WhichEdgeType,
    /// An edge or a rod to a node that does not exist.
    #[error("there is no node {node}: the graph has {nodes}, counted from 0")]
    NoNode {
        /// Node as given.
        node: u16,
        /// Number of nodes of the graph.
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
        /// Number of coordinates of the tree or graph.
        found: usize,
        /// Allowed number of coordinates, in words.
        most: String,
    },
}
