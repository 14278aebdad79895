//! Elements that are refused, and those that are not read.

use super::classes::Classes;
use super::values::{name, wrong};
use crate::urdf::error::{MOST_WRITTEN, UrdfError};
use crate::urdf::faults::Faults;
use crate::urdf::note::DescriptionNote;
use roxmltree::Node;

/// Elements that MuJoCo expands into bodies.
const EXPANDED: [&str; 6] = ["replicate", "attach", "composite", "flexcomp", "model", "flex"];

/// Advice for a file that has such elements.
const EXPAND: &str = "expand it first by MuJoCo: `python -c 'import mujoco; mujoco.mj_saveLastXML(\"out.xml\", \
                      mujoco.MjModel.from_xml_path(\"in.xml\"))'`";

/// Refuses elements that only MuJoCo can expand.
pub(super) fn refuse(root: Node) -> Result<(), UrdfError> {
    let mut faults = Faults::default();
    let expanded = root.descendants().filter(|node| EXPANDED.contains(&node.tag_name().name()));
    for node in expanded.take(MOST_WRITTEN) {
        faults.push(wrong(node, format!("is not read; {EXPAND}")));
    }
    if let Some(node) = root.descendants().find(|node| node.has_tag_name("include")) {
        faults
            .push(wrong(node, "names another file, which is read only if the description is a file itself"));
    }
    faults.end()
}

/// Notes on what acts on the robot and is not read.
pub(super) fn notes(root: Node, classes: &Classes) -> Vec<DescriptionNote> {
    let mut notes = Vec::new();
    if root.children().any(|node| node.has_tag_name("tendon") && node.has_children()) {
        notes.push("<tendon>".to_owned());
    }
    let joints = || root.descendants().filter(|node| node.has_tag_name("joint") && is_in_body(node));
    let springs: Vec<&str> =
        joints().filter(|node| has_spring(*node, classes)).map(|node| name(node)).collect();
    if !springs.is_empty() {
        notes.push(format!("the springs (stiffness) of the joints {}", springs.join(", ")));
    }
    let floats = |node: &Node| node.attribute("gravcomp").is_some_and(|value| value.trim() != "0");
    if root.descendants().any(|node| node.has_tag_name("body") && floats(&node)) {
        notes.push("gravcomp of bodies".to_owned());
    }
    notes.into_iter().map(|what| DescriptionNote::NotRead { what }).collect()
}

fn is_in_body(node: &Node) -> bool {
    node.ancestors().any(|around| around.has_tag_name("body"))
}

/// Whether a joint has a spring.
fn has_spring(node: Node, classes: &Classes) -> bool {
    let class = node.ancestors().skip(1).find_map(|around| around.attribute("childclass"));
    classes.number(node, class, "stiffness").ok().flatten().is_some_and(|stiffness| stiffness != 0.0)
}
