use leastaction_core::model::CATALOGUE;
use leastaction_core::plan;

/// Outcome of a call. Numbers are never given another meaning; new ones may be added.
///
/// Each status lists the `numbers` of its `leastaction_error`, in order, and everything else that the error carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Status {
    /// Success.
    Ok = 0,

    /// A pointer is NULL. `numbers`: the argument, from 1.
    NullPointer = 1,
    /// A pointer is not aligned as its type requires. `numbers`: the argument, from 1.
    Misaligned = 2,
    /// A length is not the one that the library was built for: was the program compiled with another header? `numbers`: right length, given
    /// length.
    WrongLength = 3,
    /// The storage holds no model: nothing was loaded there, or it was moved or copied.
    NotLoaded = 4,
    /// The storage holds no state: none was started there.
    NotStarted = 5,
    /// The step h is not positive and finite.
    BadStep = 6,
    /// The name of a tree or graph is not UTF-8, or longer than 64 bytes.
    BadName = 7,
    /// The file states neither a step nor an order: the model was trained without steps.
    NoStep = 8,
    /// The graph has rods, and the library was not built for any. `numbers`: number of rods.
    Rods = 9,
    /// A bound of Newton's method is out of range. `numbers`: the bound, from 1. `max_iterations` must be at least 1, `stop` not negative,
    /// `accept` positive and finite.
    BadNewton = 10,
    /// The program was compiled with a header of another binary interface. `numbers`: LEASTACTION_ABI of the library, of the header.
    OtherAbi = 11,
    /// The step h is not the one that the model was trained with.
    OtherStep = 12,
    /// The file does not give the range of the training data, or not for this tree or graph.
    NoRange = 13,
    /// The storage holds no plan: none was loaded there, or it was moved or copied.
    NoPlan = 14,

    /// The file has fewer bytes than the smallest model file. `numbers`: bytes given.
    TooShort = 20,
    /// The file does not begin with the magic letters.
    NotAModel = 21,
    /// The file has a format version that this library does not read. `numbers`: the version.
    Version = 22,
    /// The file was damaged. `numbers`: checksum in the file, checksum of its bytes.
    Checksum = 23,
    /// The header is not a document of this format.
    Malformed = 24,
    /// Bytes follow the end of a shape. `numbers`: number of these bytes.
    TrailingBytes = 25,
    /// The weights do not begin at a multiple of 4: align the array that holds the file. `numbers`: address of the weights modulo 4.
    Unaligned = 26,
    /// The weights are little-endian, which this processor cannot read in place.
    BigEndian = 27,
    /// The file does not have the number of weights that the shape needs. `numbers`: weights in the file, weights
    /// needed.
    WeightCount = 28,
    /// A weight is infinite or not a number. `numbers`: index of the weight.
    WeightNotFinite = 29,
    /// A number of the header is out of range. `what`: name of the number.
    OutOfRange = 30,
    /// Names are missing, empty or not unique. `what`: the named things.
    Names = 31,
    /// The file holds no tree with that name. `numbers`: number of trees in the file.
    NoSuchTree = 32,
    /// The file holds no graph with that name. `numbers`: number of graphs in the file.
    NoSuchGraph = 33,
    /// The file holds a model of another family than the library was built for. `what`: the family in the file.
    OtherFamily = 34,
    /// The file's shape is not the one that the library was built for. `numbers`: size in the file, size built in; `what`: the quantity.
    Shape = 35,
    /// The weights are of another precision than the library was built for. `numbers`: bits in the file, bits built in.
    Precision = 36,
    /// The file has a section that this library does not know and that may change the physics. `numbers`: number of the section.
    Section = 37,
    /// The file lacks a section that every file must have. `what`: name of the section.
    MissingSection = 38,
    /// The file was refused for a reason that this list does not know.
    OtherFileError = 39,

    /// The tree has no elements.
    TreeEmpty = 40,
    /// An element hangs from one that does not come before it. `numbers`: the element, the one that it hangs from.
    TreeParent = 41,
    /// An element is of a type that does not exist. `numbers`: the element, the type, number of types.
    TreeKind = 42,
    /// The tree does not have the number of coordinates that the library was built for. `numbers`: coordinates of the tree, built in.
    TreeCoordinates = 43,
    /// The file has a law of force that the library was not built for. `numbers`: number of the law in the file.
    Law = 44,
    /// The model was trained with an integrator of another order. `numbers`: order in the file, order asked for.
    Order = 45,
    /// A number of a law of force is out of range; `what`: its symbol. `numbers`: the coordinate of an inertia network, of bodies or of an
    /// arm, or the element type of a modular model; its position among the law's numbers, from 0; the bits of the value as a float.
    Friction = 46,
    /// The tree was refused for a reason that this list does not know.
    OtherTreeError = 49,

    /// The graph has no nodes.
    GraphEmpty = 50,
    /// The graph has more nodes than an edge can name. `numbers`: nodes of the graph, maximum.
    GraphTooManyNodes = 51,
    /// A node is of a type that does not exist. `numbers`: the node, the type, number of types.
    GraphNodeKind = 52,
    /// An edge is of a type that does not exist. `numbers`: the edge, the type, number of types.
    GraphEdgeKind = 53,
    /// An edge ends at a node that does not exist. `numbers`: the edge, the node, number of nodes.
    GraphEnd = 54,
    /// An edge joins a node to itself. `numbers`: the edge, the node.
    GraphLoop = 55,
    /// The graph does not have the number of coordinates that the library was built for. `numbers`: coordinates of the graph, built in.
    GraphCoordinates = 56,
    /// The mass of a node type is not positive and finite. `numbers`: the node type.
    GraphMass = 57,
    /// The drag of a node type is negative or not finite. `numbers`: the node type.
    GraphDrag = 58,
    /// The graph has more edges than the library was built for. `numbers`: edges built in, edges of the graph.
    GraphTooManyEdges = 59,
    /// The graph has more rods than the library was built for. `numbers`: rods built in, rods of the graph.
    GraphTooManyRods = 60,
    /// A member of a union names a different number of nodes than its graph has. `numbers`: the member, nodes named,
    /// nodes needed.
    GraphMemberNodes = 61,
    /// A member of a union names its nodes out of order. `numbers`: the member, the node.
    GraphMemberOrder = 62,
    /// A node belongs to no member of a union. `numbers`: the node.
    GraphOwnerless = 63,
    /// The graph was refused for a reason that this list does not know.
    OtherGraphError = 69,

    /// The matrix of the equations has no usable pivot. `numbers`: the column, from 0.
    Singular = 70,
    /// A position, momentum, control, energy or acceleration is infinite or not a number.
    NotFinite = 71,
    /// The equations of a step were not solved: h is too long for this motion. `numbers`: Newton updates taken; `residual`: the remaining
    /// residual.
    NotConverged = 72,
    /// A rod follows from those before it, or contradicts them. `numbers`: the rod, from 0.
    RodRedundant = 73,
    /// A position at the start violates a rod. `numbers`: the rod with the largest violation, from 0; `residual`: violation relative to its
    /// length.
    RodViolated = 74,
    /// The state is so far from the plan, or its gains are so large, that a command is not a number. `numbers`: the driven coordinate, from 0.
    TooFarFromPlan = 75,

    /// The plan has fewer bytes than the smallest plan. `numbers`: bytes given.
    PlanTooShort = 80,
    /// The plan does not begin with the magic letters.
    NotAPlan = 81,
    /// The plan has a format version that this library does not read. `numbers`: the version.
    PlanVersion = 82,
    /// The plan was damaged. `numbers`: checksum in the file, checksum of its bytes.
    PlanChecksum = 83,
    /// The plan's header is not a document of this format.
    PlanMalformed = 84,
    /// The plan's numbers do not begin at a multiple of 4: align the array that holds the plan. `numbers`: address of the numbers modulo 4.
    PlanUnaligned = 85,
    /// The plan's numbers are little-endian, which this processor cannot read in place.
    PlanBigEndian = 86,
    /// The plan does not have the limits and records that its header needs. `numbers`: bytes in the file, bytes needed.
    PlanNumberCount = 87,
    /// A number of the plan is infinite or not a number. `numbers`: its index among limits and records.
    PlanNotFinite = 88,
    /// A number of the plan's header is out of range. `what`: name of the number.
    PlanOutOfRange = 89,
    /// A driven coordinate of the plan is not among the coordinates, or not above the one before. `numbers`: the coordinate.
    PlanDriven = 90,
    /// The largest command of a coordinate is below its least. `numbers`: the coordinate; the bits of the least and of the largest command as
    /// floats.
    PlanLimits = 91,
    /// The plan's size is not the one that the library was built for. `numbers`: size in the file, size built in; `what`: the quantity.
    PlanShape = 92,
    /// The plan was made for another model. `numbers`: fingerprint of the model that it was made for, of the model given.
    PlanOtherModel = 93,
}

/// Reasons for refusing a file, in the order of core's catalogue.
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

/// Reasons for refusing a plan, in the order of core's catalogue.
const OF_PLANS: [Status; plan::CATALOGUE.len()] = [
    Status::PlanTooShort,
    Status::NotAPlan,
    Status::PlanVersion,
    Status::PlanChecksum,
    Status::PlanMalformed,
    Status::PlanUnaligned,
    Status::PlanBigEndian,
    Status::PlanNumberCount,
    Status::PlanNotFinite,
    Status::PlanOutOfRange,
    Status::PlanDriven,
    Status::PlanLimits,
    Status::PlanShape,
    Status::PlanOtherModel,
];

impl Status {
    /// The status with the given number in one of core's catalogues.
    pub(crate) fn of_file(code: u8) -> Self {
        let found = OF_FILES.iter().chain(&OF_PLANS).find(|status| **status as i32 == i32::from(code));
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
        let reasons = || CATALOGUE.iter().chain(&plan::CATALOGUE);
        let catalogue = reasons().map(|entry| (i32::from(entry.code), entry.name.to_string()));
        let statuses =
            OF_FILES.iter().chain(&OF_PLANS).map(|status| (*status as i32, snake(&format!("{status:?}"))));
        assert!(catalogue.eq(statuses));
        // No other status has a number in these ranges.
        let source = include_str!("status.rs").lines().filter_map(|line| line.split_once(" = "));
        let numbers = source.filter_map(|(_, number)| number.trim_end_matches(',').parse::<i32>().ok());
        let of_files = numbers.filter(|number| *number == 8 || (20..70).contains(number) || *number >= 80);
        assert!(of_files.eq(reasons().map(|entry| i32::from(entry.code))));
    }

    #[test]
    fn codes_are_statuses() {
        for entry in CATALOGUE.iter().chain(&plan::CATALOGUE) {
            assert_eq!(Status::of_file(entry.code) as i32, i32::from(entry.code));
        }
    }
}
