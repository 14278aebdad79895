//! Catalogue of all reasons for refusing a plan, by number, beside that of [models](crate::model::CATALOGUE).

use super::PlanError;
use crate::model::{Coded, Entry, entry};

/// All reasons, in the order of their numbers, which follow those of models.
pub const CATALOGUE: [Entry; 14] = [
    entry(80, "plan_too_short", c"not a whole plan"),
    entry(81, "not_a_plan", c"not a plan of leastaction (it does not begin with LAPN)"),
    entry(82, "plan_version", c"a format version of plans that this program does not read: plan anew"),
    entry(83, "plan_checksum", c"the plan is damaged: another checksum"),
    entry(84, "plan_malformed", c"the header of the plan is malformed"),
    entry(
        85,
        "plan_unaligned",
        c"the numbers are not at a multiple of 4: align the array that holds the plan",
    ),
    entry(86, "plan_big_endian", c"numbers of a plan are little-endian and cannot be read in place here"),
    entry(87, "plan_number_count", c"not as many limits and records as the header of the plan needs"),
    entry(88, "plan_not_finite", c"a number of the plan is infinite or not a number"),
    entry(89, "plan_out_of_range", c"a number of the plan's header is out of range"),
    entry(90, "plan_driven", c"a driven coordinate is not among the coordinates, or out of order"),
    entry(91, "plan_limits", c"the largest command of a coordinate is below its least"),
    entry(92, "plan_shape", c"the plan's size is not the one that the program was built for"),
    entry(93, "plan_other_model", c"the plan was made for another model: plan anew"),
];

impl PlanError {
    /// Returns the reason as numbers; limits as the bits of the commands.
    pub fn coded(&self) -> Coded {
        match *self {
            Self::TooShort { bytes } => Coded::new(80, [bytes, 0, 0]),
            Self::Magic => Coded::bare(81),
            Self::Version { found } => Coded::new(82, [found.into(), 0, 0]),
            Self::Checksum { stored, computed } => Coded::new(83, [stored as usize, computed as usize, 0]),
            Self::Malformed => Coded::bare(84),
            Self::Unaligned { offset } => Coded::new(85, [offset.into(), 0, 0]),
            Self::BigEndian => Coded::bare(86),
            Self::NumberCount { found, needed } => Coded::new(87, [found, needed, 0]),
            Self::NotFinite { index } => Coded::new(88, [index, 0, 0]),
            Self::OutOfRange { what } => Coded::bare(89).about(what),
            Self::Driven { coordinate } => Coded::new(90, [coordinate.into(), 0, 0]),
            Self::Limits { coordinate, least, most } => {
                let [least, most] = [least, most].map(|limit| limit.to_bits() as usize);
                Coded::new(91, [coordinate.into(), least, most])
            }
            Self::Shape { what, found, compiled } => Coded::new(92, [found, compiled, 0]).about(what),
            Self::OtherModel { planned, given } => Coded::new(93, [planned as usize, given as usize, 0]),
        }
    }
}
