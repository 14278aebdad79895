//! Descriptions of the families' shapes in words.

use leastaction_core::energy::NetworkShape;
use leastaction_core::energy::bodies::Joint;

/// Description of a shape in words; it also serialises to fields for programs.
pub trait Describe {
    /// Readable names and values, line by line.
    fn lines(&self) -> Vec<(&'static str, String)>;
}

/// Name of a joint's kind.
pub(crate) fn joint(joint: Joint) -> &'static str {
    match joint {
        Joint::Revolute => "revolute",
        Joint::Prismatic => "prismatic",
    }
}

/// Numbers in brackets.
pub(crate) fn vector(x: &[f64; 3]) -> String {
    format!("({:.4}, {:.4}, {:.4})", x[0], x[1], x[2])
}

/// Layers of a network, for example 2-16-1 (tanh).
pub(crate) fn layers(network: Option<&NetworkShape>) -> String {
    let Some(NetworkShape { inputs, widths, outputs, activation }) = network else {
        return "?".to_owned();
    };
    let hidden: String = widths.iter().take_while(|w| **w > 0).map(|w| format!("{w}-")).collect();
    let activation =
        if hidden.is_empty() { "linear".to_owned() } else { format!("{activation:?}").to_lowercase() };
    format!("{inputs}-{hidden}{outputs} ({activation})")
}
