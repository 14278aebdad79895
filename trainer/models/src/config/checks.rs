//! Checks and words that several families share.

use super::place::ShapeError;
use super::problem::Problem;

/// Refuses a name that a model file cannot hold.
pub(crate) fn check_name(name: &str) -> Result<(), Problem> {
    let good = !name.trim().is_empty() && !name.contains(',');
    if good { Ok(()) } else { Err(Problem::Name { name: name.to_owned() }) }
}

/// Names or numbers as a readable list.
pub(crate) fn list<T: ToString>(names: impl Iterator<Item = T>) -> String {
    names.map(|name| name.to_string()).collect::<Vec<_>>().join(", ")
}

/// Refuses a count above the largest that can be held; `key` is the place of the items.
pub(crate) fn check_count(
    what: &'static str,
    key: &str,
    found: usize,
    most: usize,
) -> Result<(), ShapeError> {
    let too_many = Problem::TooMany { what, found, most };
    if found <= most { Ok(()) } else { Err(too_many.at([key.into()])) }
}
