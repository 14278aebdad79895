use crate::status::Status;
use core::ffi::{CStr, c_char, c_int};

/// What every status says.
const MESSAGES: [(Status, &CStr); 48] = [
    (Status::Ok, c"ok"),
    (Status::NullPointer, c"a pointer is NULL"),
    (Status::Misaligned, c"a pointer is not aligned as its type asks"),
    (Status::WrongLength, c"a length is not the one that the library was built for"),
    (Status::NotLoaded, c"the storage holds no model: nothing was loaded there, or it was moved or copied"),
    (Status::NotStarted, c"the storage holds no state: none was started there"),
    (Status::BadStep, c"the step h is not positive and finite"),
    (Status::BadName, c"the name is not UTF-8, or longer than 64 bytes"),
    (Status::NoStep, c"the file does not say a step and an order"),
    (Status::Rods, c"the graph has rods, which this library does not keep"),
    (Status::BadNewton, c"a bound of Newton's method is out of range"),
    (Status::TooShort, c"not a whole model file"),
    (Status::NotAModel, c"not a leastaction model file (it does not begin with LACT)"),
    (Status::Version, c"a format version that this library does not read"),
    (Status::Checksum, c"the file is damaged: another checksum"),
    (Status::Malformed, c"the header is malformed"),
    (Status::TrailingBytes, c"bytes after the end of the model"),
    (Status::Unaligned, c"the weights are not at a multiple of 4: align the array that holds the file"),
    (Status::BigEndian, c"weights are little-endian and cannot be read in place here"),
    (Status::WeightCount, c"not as many weights as the shape needs"),
    (Status::WeightNotFinite, c"a weight is infinite or not a number"),
    (Status::OutOfRange, c"a number of the header is out of range"),
    (Status::Names, c"names are missing, empty or the same"),
    (Status::NoSuchTree, c"no tree in the file has that name"),
    (Status::NoSuchGraph, c"no graph in the file has that name"),
    (Status::OtherFamily, c"a model of another family than the library was built for"),
    (Status::Shape, c"the file's shape is not the one that the library was built for"),
    (Status::Precision, c"weights of another precision than the library was built for"),
    (Status::OtherFileError, c"the file was refused"),
    (Status::TreeEmpty, c"a tree without elements"),
    (Status::TreeParent, c"an element hangs from one that does not come before it"),
    (Status::TreeKind, c"an element is of a type that does not exist"),
    (Status::TreeCoordinates, c"the tree has not the coordinates that the library was built for"),
    (Status::OtherTreeError, c"the tree was refused"),
    (Status::GraphEmpty, c"a graph without nodes"),
    (Status::GraphTooManyNodes, c"more nodes than an edge can name"),
    (Status::GraphNodeKind, c"a node is of a type that does not exist"),
    (Status::GraphEdgeKind, c"an edge is of a type that does not exist"),
    (Status::GraphEnd, c"an edge ends at a node that does not exist"),
    (Status::GraphLoop, c"an edge joins a node to itself"),
    (Status::GraphCoordinates, c"the graph has not the coordinates that the library was built for"),
    (Status::GraphMass, c"the mass of a node type is not positive and finite"),
    (Status::GraphDrag, c"the drag of a node type is negative or not finite"),
    (Status::GraphTooManyEdges, c"more edges than the library was built for"),
    (Status::OtherGraphError, c"the graph was refused"),
    (Status::Singular, c"the matrix of the equations has no usable pivot"),
    (Status::NotFinite, c"a number is infinite or not a number"),
    (Status::NotConverged, c"the step was not solved: h is too long for this motion"),
];

/// What a status says, in English: a string that is never freed. Of a number that is no status: "unknown status".
#[unsafe(no_mangle)]
pub extern "C" fn leastaction_message(status: c_int) -> *const c_char {
    let found = MESSAGES.iter().find(|(known, _)| *known as c_int == status);
    found.map_or(c"unknown status", |(_, message)| message).as_ptr()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test")]
mod tests {
    use super::*;

    #[test]
    fn messages_are_of_all_statuses_in_order() {
        let source = include_str!("status.rs").lines().filter(|line| line.contains(" = "));
        let numbers = source.map(|line| line.split(" = ").nth(1).unwrap().trim_end_matches(','));
        let known = MESSAGES.iter().map(|(status, _)| (*status as i32).to_string());
        assert!(numbers.eq(known));
    }

    #[test]
    fn messages_are_found() {
        // SAFETY: a message ends with a zero.
        let text = |status| unsafe { CStr::from_ptr(leastaction_message(status)) }.to_str().unwrap();
        assert_eq!(text(0), "ok");
        assert_eq!(text(72), "the step was not solved: h is too long for this motion");
        assert_eq!(text(73), "unknown status");
        assert_eq!(text(-1), "unknown status");
    }
}
