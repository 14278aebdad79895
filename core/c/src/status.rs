use leastaction_core::model::CATALOGUE;

/// What came of a call. Numbers are never given another meaning; new ones may be added.
///
/// Of every status: what `numbers` of a `leastaction_error` are, in order, and what else it carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Status {
    /// It worked.
    Ok = 0,

    /// A pointer is NULL. Which argument, from 1.
    NullPointer = 1,
    /// A pointer is not aligned as its type asks. Which argument, from 1.
    Misaligned = 2,
    /// A length is not the one that the library was built for: was the program compiled with another header? Length that is
    /// right, length given.
    WrongLength = 3,
    /// The storage holds no model: nothing was loaded there, or it was moved or copied.
    NotLoaded = 4,
    /// The storage holds no state: none was started there.
    NotStarted = 5,
    /// The step h is not positive and finite.
    BadStep = 6,
    /// The name of a tree or graph is not UTF-8, or longer than 64 bytes.
    BadName = 7,
    /// The file does not say a step and an order: the model was not trained for one.
    NoStep = 8,
    /// The graph has rods, and the library was not built for any. How many.
    Rods = 9,
    /// A bound of Newton's method is out of range. Which, from 1: `max_iterations` is at least 1, `stop` is not negative,
    /// `accept` positive and finite.
    BadNewton = 10,
    /// The program was compiled with a header of another binary interface. LEASTACTION_ABI of the library, that of the header.
    OtherAbi = 11,
    /// The step h is not the one that the model was trained with.
    OtherStep = 12,
    /// The file does not say what the training data covered, or not for this tree or graph.
    NoRange = 13,

    /// Fewer bytes than the smallest model file has. Bytes given.
    TooShort = 20,
    /// The file does not begin with the magic letters.
    NotAModel = 21,
    /// A format version that this library does not read. The version in the file.
    Version = 22,
    /// The file was damaged. Checksum in the file, checksum of the bytes as they are.
    Checksum = 23,
    /// The header is not a document of this format.
    Malformed = 24,
    /// Bytes after the end of a shape. How many.
    TrailingBytes = 25,
    /// The weights do not begin at a multiple of 4: align the array that holds the file. Their address modulo 4.
    Unaligned = 26,
    /// Weights are little-endian, which this processor cannot read in place.
    BigEndian = 27,
    /// The shape asks for another number of weights than there are. Weights there are, weights needed.
    WeightCount = 28,
    /// A weight is infinite or not a number. Its position.
    WeightNotFinite = 29,
    /// A number of the header is out of range. `what`: which.
    OutOfRange = 30,
    /// Names are missing, empty or the same. `what`: of what.
    Names = 31,
    /// The file holds no tree of that name. Trees that it holds.
    NoSuchTree = 32,
    /// The file holds no graph of that name. Graphs that it holds.
    NoSuchGraph = 33,
    /// The file holds a model of another family than the library was built for. `what`: the family in the file.
    OtherFamily = 34,
    /// The file's shape is not the one that the library was built for. In the file, built in; `what`: of what.
    Shape = 35,
    /// The weights are of another precision than the library was built for. Bits in the file, built in.
    Precision = 36,
    /// The file has a section that this library does not know and that may change the physics. Its number.
    Section = 37,
    /// The file lacks a section that every file has. `what`: which.
    MissingSection = 38,
    /// The file was refused for a reason that this list does not know.
    OtherFileError = 39,

    /// A tree without elements.
    TreeEmpty = 40,
    /// An element hangs from one that does not come before it. The element, what it hangs from.
    TreeParent = 41,
    /// An element is of a type that does not exist. The element, the type, types there are.
    TreeKind = 42,
    /// The tree has not the coordinates that the library was built for. Of the tree, built in.
    TreeCoordinates = 43,
    /// The file has a law of force that the library was not built for. Its number in the file.
    Law = 44,
    /// The model was trained with an integrator of another order. In the file, asked for.
    Order = 45,
    /// A number of dry friction is out of range; `what`: which. The coordinate of an inertia network, of bodies or of an arm, or the element type of a
    /// modular one; 0 for c, 1 for c_load, 2 for tau_s, 3 for epsilon; the bits of the number as a float.
    Friction = 46,
    /// The tree was refused for a reason that this list does not know.
    OtherTreeError = 49,

    /// A graph without nodes.
    GraphEmpty = 50,
    /// More nodes than an edge can name. Of the graph, at most.
    GraphTooManyNodes = 51,
    /// A node is of a type that does not exist. The node, the type, types there are.
    GraphNodeKind = 52,
    /// An edge is of a type that does not exist. The edge, the type, types there are.
    GraphEdgeKind = 53,
    /// An edge ends at a node that does not exist. The edge, the node, nodes there are.
    GraphEnd = 54,
    /// An edge joins a node to itself. The edge, the node.
    GraphLoop = 55,
    /// The graph has not the coordinates that the library was built for. Of the graph, built in.
    GraphCoordinates = 56,
    /// The mass of a node type is not positive and finite. The node type.
    GraphMass = 57,
    /// The drag of a node type is negative or not finite. The node type.
    GraphDrag = 58,
    /// More edges than the library was built for. Built in, of the graph.
    GraphTooManyEdges = 59,
    /// More rods than the library was built for. Built in, of the graph.
    GraphTooManyRods = 60,
    /// A member of a union does not name as many nodes as it has. The member, named, needed.
    GraphMemberNodes = 61,
    /// A member of a union names its nodes out of order. The member, the node.
    GraphMemberOrder = 62,
    /// No member of a union has a node. The node.
    GraphOwnerless = 63,
    /// The graph was refused for a reason that this list does not know.
    OtherGraphError = 69,

    /// The matrix of the equations has no usable pivot. The column, from 0.
    Singular = 70,
    /// A position, momentum, control, energy or acceleration is infinite or not a number.
    NotFinite = 71,
    /// The equations of a step were not solved: h is too long for this motion. Newton updates taken; `residual`: what is
    /// left.
    NotConverged = 72,
    /// A rod follows from those before it, or contradicts them. Which, from 0.
    RodRedundant = 73,
    /// A position at the start violates a rod. The rod that is furthest off, from 0; `residual`: by how much of its length.
    RodViolated = 74,
}

/// The reasons for which a file is refused, as core's catalogue has them.
const OF_FILES: [Status; CATALOGUE.len()] = [
    Status::NoStep,
    Status::TooShort,
    Status::NotAModel,
    Status::Version,
    Status::Checksum,
    Status::Malformed,
    Status::TrailingBytes,
    Status::Unaligned,
    Status::BigEndian,
    Status::WeightCount,
    Status::WeightNotFinite,
    Status::OutOfRange,
    Status::Names,
    Status::NoSuchTree,
    Status::NoSuchGraph,
    Status::OtherFamily,
    Status::Shape,
    Status::Precision,
    Status::Section,
    Status::MissingSection,
    Status::OtherFileError,
    Status::TreeEmpty,
    Status::TreeParent,
    Status::TreeKind,
    Status::TreeCoordinates,
    Status::Law,
    Status::Order,
    Status::Friction,
    Status::OtherTreeError,
    Status::GraphEmpty,
    Status::GraphTooManyNodes,
    Status::GraphNodeKind,
    Status::GraphEdgeKind,
    Status::GraphEnd,
    Status::GraphLoop,
    Status::GraphCoordinates,
    Status::GraphMass,
    Status::GraphDrag,
    Status::GraphTooManyEdges,
    Status::GraphTooManyRods,
    Status::GraphMemberNodes,
    Status::GraphMemberOrder,
    Status::GraphOwnerless,
    Status::OtherGraphError,
];

impl Status {
    /// The reason of that number in core's catalogue.
    pub(crate) fn of_file(code: u8) -> Self {
        let found = OF_FILES.iter().find(|status| **status as i32 == i32::from(code));
        debug_assert!(found.is_some(), "a reason without a status");
        found.copied().unwrap_or(Self::OtherFileError)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `TreeKind` as `tree_kind`.
    fn snake(name: &str) -> String {
        let mut text = String::new();
        for c in name.chars() {
            if c.is_uppercase() && !text.is_empty() {
                text.push('_');
            }
            text.push(c.to_ascii_lowercase());
        }
        text
    }

    #[test]
    fn statuses_of_files_are_the_catalogue() {
        let catalogue = CATALOGUE.iter().map(|entry| (i32::from(entry.code), entry.name.to_string()));
        let statuses = OF_FILES.iter().map(|status| (*status as i32, snake(&format!("{status:?}"))));
        assert!(catalogue.eq(statuses));
        // And there is no other among their numbers.
        let source = include_str!("status.rs").lines().filter_map(|line| line.split_once(" = "));
        let numbers = source.filter_map(|(_, number)| number.trim_end_matches(',').parse::<i32>().ok());
        let of_files = numbers.filter(|number| *number == 8 || (20..70).contains(number));
        assert!(of_files.eq(CATALOGUE.iter().map(|entry| i32::from(entry.code))));
    }

    #[test]
    fn codes_are_statuses() {
        for entry in &CATALOGUE {
            assert_eq!(Status::of_file(entry.code) as i32, i32::from(entry.code));
        }
    }
}
