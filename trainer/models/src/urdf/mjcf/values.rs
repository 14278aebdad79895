//! Names and values of attributes.

use crate::urdf::error::UrdfError;
use roxmltree::Node;
use std::ops::RangeInclusive;

/// Name of an element in messages.
pub(super) fn name<'a>(node: Node<'a, '_>) -> &'a str {
    node.attribute("name").unwrap_or("without a name")
}

/// Line of an element, from 1.
pub(super) fn line(node: Node) -> u32 {
    node.document().text_pos_at(node.range().start).row
}

/// Error at an element.
pub(super) fn wrong(node: Node, message: impl Into<String>) -> UrdfError {
    UrdfError::Mjcf { line: line(node), message: format!("<{}> {}", node.tag_name().name(), message.into()) }
}

/// Reads as many finite numbers as `count` allows.
pub(super) fn numbers(
    node: Node,
    (what, text): (&str, &str),
    count: RangeInclusive<usize>,
) -> Result<Vec<f64>, UrdfError> {
    let number = |word: &str| word.parse().ok().filter(|x: &f64| x.is_finite());
    let found: Option<Vec<f64>> = text.split_whitespace().take(*count.end() + 1).map(number).collect();
    found.filter(|found| count.contains(&found.len())).ok_or_else(|| {
        let (least, most) = count.into_inner();
        let expected = if least == most { least.to_string() } else { format!("{least} to {most}") };
        let found: String = text.chars().take(60).collect();
        wrong(node, format!("{what} = {found:?} should be {expected} finite number(s)"))
    })
}

/// Reads N numbers.
pub(super) fn exactly<const N: usize>(node: Node, (what, text): (&str, &str)) -> Result<[f64; N], UrdfError> {
    let found = numbers(node, (what, text), N..=N)?;
    Ok(std::array::from_fn(|k| found[k]))
}
