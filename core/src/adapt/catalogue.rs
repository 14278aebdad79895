//! Catalogue of all reasons for refusing settings and patches, by number, beside those of [models](crate::model::CATALOGUE) and
//! [plans](crate::plan::CATALOGUE).

use super::{PatchError, SettingsError, Unfit};
use crate::frame::FrameFault;
use crate::model::{Coded, Entry, entry};

/// All reasons, in the order of their numbers, which follow those of plans: from 100 on of settings, from 120 on of patches.
pub const CATALOGUE: [Entry; 21] = [
    entry(100, "settings_too_short", c"not a whole file of settings"),
    entry(101, "not_settings", c"not settings of an adapter (they do not begin with LATU)"),
    entry(102, "settings_version", c"a format version of settings that this program does not read"),
    entry(103, "settings_checksum", c"the settings are damaged: another checksum"),
    entry(104, "settings_malformed", c"the settings are malformed, or too many for the program"),
    entry(105, "settings_coordinates", c"settings for another number of coordinates"),
    entry(106, "settings_places", c"more numbers than the program has places for"),
    entry(107, "settings_out_of_range", c"a setting is not finite, or out of its range"),
    entry(108, "settings_number", c"a value of a number that follows is not finite, or out of its range"),
    entry(109, "settings_no_such", c"a number of a coordinate or a body that the model does not have"),
    entry(110, "settings_part_of_body", c"the numbers of a body must all be there, one after the other"),
    entry(111, "settings_gauge", c"a gain cannot follow beside the inertias of all bodies"),
    entry(112, "settings_other_model", c"the settings were made for another model"),
    entry(113, "settings_other_tick", c"the settings were made for ticks of another length"),
    entry(120, "patch_too_short", c"not a whole patch"),
    entry(121, "not_a_patch", c"not a patch (it does not begin with LAPT)"),
    entry(122, "patch_version", c"a format version of patches that this program does not read"),
    entry(123, "patch_checksum", c"the patch is damaged: another checksum"),
    entry(124, "patch_malformed", c"the patch is malformed, or has too many numbers"),
    entry(125, "patch_not_finite", c"a number of the patch, or its standard error, is none"),
    entry(126, "patch_other_model", c"the patch was saved for another model"),
];

const SETTINGS: u8 = 100;
const PATCHES: u8 = 120;

/// Reason for a fault of the frame of files whose reasons begin with `first`.
fn framed(first: u8, fault: FrameFault) -> Coded {
    match fault {
        FrameFault::TooShort { bytes } => Coded::new(first, [bytes, 0, 0]),
        FrameFault::Magic { .. } => Coded::bare(first + 1),
        FrameFault::Version { found, .. } => Coded::new(first + 2, [found.into(), 0, 0]),
        FrameFault::Checksum { stored, computed } => {
            Coded::new(first + 3, [stored as usize, computed as usize, 0])
        }
    }
}

impl Unfit {
    /// Returns the reason as numbers.
    pub fn coded(&self) -> Coded {
        match *self {
            Self::NoSuch { found, count } => Coded::new(109, [found.into(), count.into(), 0]),
            Self::PartOfBody { body } => Coded::new(110, [body.into(), 0, 0]),
            Self::Gauge { coordinate } => Coded::new(111, [coordinate.into(), 0, 0]),
        }
    }
}

impl SettingsError {
    /// Returns the reason as numbers; ticks as their bits.
    pub fn coded(&self) -> Coded {
        match *self {
            Self::Frame(fault) => framed(SETTINGS, fault),
            Self::Malformed => Coded::bare(104),
            Self::Coordinates { found, needed } => Coded::new(105, [found.into(), needed.into(), 0]),
            Self::Places { found, places } => Coded::new(106, [found.into(), places.into(), 0]),
            Self::OutOfRange => Coded::bare(107),
            Self::Number { index } => Coded::new(108, [index.into(), 0, 0]),
            Self::Unfit(unfit) => unfit.coded(),
            Self::OtherTick { made_for, given } => {
                Coded::new(113, [made_for.to_bits() as usize, given.to_bits() as usize, 0])
            }
            Self::OtherModel { saved, given } => Coded::new(112, [saved as usize, given as usize, 0]),
        }
    }
}

impl PatchError {
    /// Returns the reason as numbers.
    pub fn coded(&self) -> Coded {
        match *self {
            Self::Frame(fault) => framed(PATCHES, fault),
            Self::Malformed => Coded::bare(124),
            Self::NotFinite { index } => Coded::new(125, [index.into(), 0, 0]),
            Self::OtherModel { saved, given } => Coded::new(126, [saved as usize, given as usize, 0]),
        }
    }
}
