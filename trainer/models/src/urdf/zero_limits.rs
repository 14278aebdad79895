//! Limits of 0, which exporters write where nobody gave any.

use super::note::DescriptionNote;
use crate::tree::Limits;
use roxmltree::Node;

/// The limits without those of 0, between which nothing could move.
pub(super) fn without_zeros(limits: Limits) -> Limits {
    let none = Limits::none();
    let or_none = |limit: f64| if limit == 0.0 { f64::INFINITY } else { limit };
    Limits {
        position: if limits.position == [0.0; 2] { none.position } else { limits.position },
        velocity: or_none(limits.velocity),
        effort: or_none(limits.effort),
    }
}

/// A note on the joints of a robot that could not move between their limits; `None` if there are none.
pub(super) fn note(robot: Node<'_, '_>) -> Option<DescriptionNote> {
    let joints = robot.children().filter(|node| node.has_tag_name("joint"));
    let moves =
        |node: &Node<'_, '_>| matches!(node.attribute("type"), Some("revolute" | "continuous" | "prismatic"));
    let of_zero = joints.filter(moves).filter(has_zeros);
    let joints: Vec<String> = of_zero.filter_map(|node| node.attribute("name").map(str::to_owned)).collect();
    (!joints.is_empty()).then_some(DescriptionNote::ZeroLimits { joints })
}

fn has_zeros(joint: &Node<'_, '_>) -> bool {
    let limit = joint.children().find(|node| node.has_tag_name("limit"));
    let is_zero = |name: &str| {
        let number = limit.and_then(|limit| limit.attribute(name));
        number.and_then(|number| number.trim().parse::<f64>().ok()) == Some(0.0)
    };
    let has_range = joint.attribute("type") != Some("continuous");
    is_zero("velocity") || is_zero("effort") || has_range && is_zero("lower") && is_zero("upper")
}
