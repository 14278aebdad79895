//! Helpers of the tests that run the examples on the book's pages about models.

use leastaction_learning::run::{Monitor, Row};

/// The block of a page that begins with this file name.
pub fn example(page: &'static str, name: &str) -> &'static str {
    let mut blocks = page.split("```toml\n").skip(1).map(|rest| rest.split("```").next().unwrap());
    blocks
        .find(|block| block.starts_with(&format!("# {name}\n")))
        .unwrap_or_else(|| panic!("no example {name}"))
}

/// A monitor that fails on any warning.
pub struct Strict;

impl Monitor for Strict {
    fn row(&mut self, _: &Row) {}

    fn warning(&mut self, message: &str) {
        panic!("{message}");
    }
}
