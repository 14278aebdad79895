use leastaction_core::adapt;
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
    /// The storage holds no adapter: none has begun there, or it was moved or copied.
    NoAdapter = 15,
    /// No number that follows has this index. `numbers`: the index, number of numbers.
    NoNumber = 16,

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

    /// The settings have fewer bytes than the smallest file. `numbers`: bytes given.
    SettingsTooShort = 100,
    /// The settings do not begin with the magic letters.
    NotSettings = 101,
    /// The settings have a format version that this library does not read. `numbers`: the version.
    SettingsVersion = 102,
    /// The settings were damaged. `numbers`: checksum in the file, checksum of its bytes.
    SettingsChecksum = 103,
    /// The settings are no document of this format, or have more numbers or coordinates than the library was built for.
    SettingsMalformed = 104,
    /// The settings are for another number of coordinates. `numbers`: coordinates of the settings, built in.
    SettingsCoordinates = 105,
    /// More numbers follow than the library was built for. `numbers`: numbers that follow, LEASTACTION_NUMBERS.
    SettingsPlaces = 106,
    /// A setting is not finite, or out of its range.
    SettingsOutOfRange = 107,
    /// A value of a number that follows is not finite, or out of its range. `numbers`: its index.
    SettingsNumber = 108,
    /// A number of a coordinate or a body that the model does not have follows. `numbers`: the coordinate or body, how many there are.
    SettingsNoSuch = 109,
    /// The numbers of a body must all follow, one after the other. `numbers`: the body.
    SettingsPartOfBody = 110,
    /// A gain cannot follow beside the inertias of all bodies. `numbers`: the coordinate of the gain.
    SettingsGauge = 111,
    /// The settings were made for another model. `numbers`: fingerprint of the model that they were made for, of the model given.
    SettingsOtherModel = 112,
    /// The settings were made for ticks of another length. `numbers`: the bits of that tick and of `h` as floats.
    SettingsOtherTick = 113,

    /// The patch has fewer bytes than the smallest patch. `numbers`: bytes given.
    PatchTooShort = 120,
    /// The patch does not begin with the magic letters.
    NotAPatch = 121,
    /// The patch has a format version that this library does not read. `numbers`: the version.
    PatchVersion = 122,
    /// The patch was damaged. `numbers`: checksum in the file, checksum of its bytes.
    PatchChecksum = 123,
    /// The patch is no document of this format, or has more numbers than the library was built for.
    PatchMalformed = 124,
    /// A number of the patch is not finite, or its standard error is none. `numbers`: its index.
    PatchNotFinite = 125,
    /// The patch was saved for another model. `numbers`: fingerprint of the model that it was saved for, of the model given.
    PatchOtherModel = 126,
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

/// Reasons for refusing settings and patches of an adapter, in the order of core's catalogue.
const OF_ADAPTERS: [Status; adapt::CATALOGUE.len()] = [
    Status::SettingsTooShort,
    Status::NotSettings,
    Status::SettingsVersion,
    Status::SettingsChecksum,
    Status::SettingsMalformed,
    Status::SettingsCoordinates,
    Status::SettingsPlaces,
    Status::SettingsOutOfRange,
    Status::SettingsNumber,
    Status::SettingsNoSuch,
    Status::SettingsPartOfBody,
    Status::SettingsGauge,
    Status::SettingsOtherModel,
    Status::SettingsOtherTick,
    Status::PatchTooShort,
    Status::NotAPatch,
    Status::PatchVersion,
    Status::PatchChecksum,
    Status::PatchMalformed,
    Status::PatchNotFinite,
    Status::PatchOtherModel,
];

/// Reasons for refusing a file that this library reads.
fn of_files() -> impl Iterator<Item = Status> {
    let adapts = cfg!(any(feature = "adapt", test));
    let of_adapters = OF_ADAPTERS.iter().filter(move |_| adapts);
    OF_FILES.iter().chain(&OF_PLANS).chain(of_adapters).copied()
}

impl Status {
    /// The status with the given number in one of core's catalogues.
    pub(crate) fn of_file(code: u8) -> Self {
        let found = of_files().find(|status| *status as i32 == i32::from(code));
        debug_assert!(found.is_some(), "a reason without a status");
        found.unwrap_or(Self::OtherFileError)
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
        let reasons = || CATALOGUE.iter().chain(&plan::CATALOGUE).chain(&adapt::CATALOGUE);
        let catalogue = reasons().map(|entry| (i32::from(entry.code), entry.name.to_string()));
        let statuses = of_files().map(|status| (status as i32, snake(&format!("{status:?}"))));
        assert!(catalogue.eq(statuses));
        // No other status has a number in these ranges.
        let source = include_str!("status.rs").lines().filter_map(|line| line.split_once(" = "));
        let numbers = source.filter_map(|(_, number)| number.trim_end_matches(',').parse::<i32>().ok());
        let of_files = numbers.filter(|number| *number == 8 || (20..70).contains(number) || *number >= 80);
        assert!(of_files.eq(reasons().map(|entry| i32::from(entry.code))));
    }

    #[test]
    fn codes_are_statuses() {
        for entry in CATALOGUE.iter().chain(&plan::CATALOGUE).chain(&adapt::CATALOGUE) {
            assert_eq!(Status::of_file(entry.code) as i32, i32::from(entry.code));
        }
    }
}
