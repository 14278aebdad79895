use crate::status::Status;
use core::ffi::{CStr, c_char, c_int};
use leastaction_core::adapt;
use leastaction_core::model::entry_of;
use leastaction_core::plan;

/// Messages of this library's own statuses; those of files are in core's catalogue.
const MESSAGES: [(Status, &CStr); 22] = [
    (Status::Ok, c"ok"),
    (Status::NullPointer, c"a pointer is NULL"),
    (Status::Misaligned, c"a pointer is not aligned as its type asks"),
    (Status::WrongLength, c"a length is not the one that the library was built for"),
    (Status::NotLoaded, c"the storage holds no model: nothing was loaded there, or it was moved or copied"),
    (Status::NotStarted, c"the storage holds no state: none was started there"),
    (Status::BadStep, c"the step h is not positive and finite"),
    (Status::BadName, c"the name is not UTF-8, or longer than 64 bytes"),
    (Status::Rods, c"the graph has rods: build the library with the feature rods"),
    (Status::BadNewton, c"a bound of Newton's method is out of range"),
    (Status::OtherAbi, c"the program was compiled with the header of another library"),
    (Status::OtherStep, c"the step h is not the one that the model was trained with"),
    (Status::NoRange, c"the file does not say what the training data covered"),
    (Status::NoPlan, c"the storage holds no plan: none was loaded there, or it was moved or copied"),
    (Status::NoAdapter, c"the storage holds no adapter: none has begun there, or it was moved or copied"),
    (Status::NoNumber, c"no number that follows has this index"),
    (Status::Singular, c"the matrix of the equations has no usable pivot"),
    (Status::NotFinite, c"a number is infinite or not a number"),
    (Status::NotConverged, c"the step was not solved: h is too long for this motion"),
    (Status::RodRedundant, c"a rod follows from those before it, or contradicts them"),
    (Status::RodViolated, c"a position at the start violates a rod"),
    (Status::TooFarFromPlan, c"a command is not a number: the state is too far from the plan"),
];

/// Message of a status, in English: a string that is never freed. For a number that is no status: "unknown status".
#[unsafe(export_name = concat!(env!("LEASTACTION_EXPORTS"), "message"))]
pub extern "C" fn leastaction_message(status: c_int) -> *const c_char {
    let own = MESSAGES.iter().find(|(known, _)| *known as c_int == status).map(|(_, message)| *message);
    // A library that follows no numbers has no texts about them.
    let adapts = |_: &&_| cfg!(any(feature = "adapt", test));
    let others = || plan::CATALOGUE.iter().chain(adapt::CATALOGUE.iter().filter(adapts));
    let of_other = |code| others().find(|entry| entry.code == code);
    let of_file = || u8::try_from(status).ok().and_then(|code| entry_of(code).or_else(|| of_other(code)));
    let of_file = || of_file().map(|entry| entry.message);
    own.or_else(of_file).unwrap_or(c"unknown status").as_ptr()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test")]
mod tests {
    use super::*;

    #[test]
    fn every_status_has_one_message() {
        let source = include_str!("status.rs").lines().filter_map(|line| line.split_once(" = "));
        let numbers = source.filter_map(|(_, number)| number.trim_end_matches(',').parse::<c_int>().ok());
        let mut known: Vec<c_int> = MESSAGES.iter().map(|(status, _)| *status as c_int).collect();
        let reasons =
            leastaction_core::model::CATALOGUE.iter().chain(&plan::CATALOGUE).chain(&adapt::CATALOGUE);
        known.extend(reasons.map(|entry| c_int::from(entry.code)));
        known.sort_unstable();
        assert!(numbers.eq(known));
    }

    #[test]
    fn messages_are_found() {
        // SAFETY: a message ends with a zero.
        let text = |status| unsafe { CStr::from_ptr(leastaction_message(status)) }.to_str().unwrap();
        assert_eq!(text(0), "ok");
        assert_eq!(text(72), "the step was not solved: h is too long for this motion");
        assert_eq!(text(23), "the file is damaged: another checksum");
        assert_eq!(text(83), "the plan is damaged: another checksum");
        assert_eq!(text(103), "the settings are damaged: another checksum");
        assert_eq!(text(76), "unknown status");
        assert_eq!(text(256 + 23), "unknown status");
        assert_eq!(text(-1), "unknown status");
    }
}
