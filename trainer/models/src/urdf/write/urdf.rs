//! The text of a URDF file, with other numbers.

use super::text::inertial_of_urdf;
use super::{Edits, Job, JointNumbers};
use roxmltree::Document;

/// First words of the comment on a rotor.
pub(super) const ROTOR: &str = "inertia of the rotor";

impl Job {
    /// Returns the text with the identified numbers.
    pub fn edited_urdf(&self, document: &Document) -> String {
        let mut edits = Edits::new(document);
        for (k, _, inertia) in self.bodies() {
            if self.is_changed(k) {
                self.edit_links(k, &inertial_of_urdf(&inertia), &mut edits);
            }
            self.edit_joint(k, &mut edits);
        }
        edits.text()
    }

    /// Gives the whole inertia of a body to the link that its joint moves, and none to the others.
    fn edit_links(&self, k: usize, inertial: &str, edits: &mut Edits) {
        for (i, link) in self.assembled.links[k].iter().enumerate() {
            let Some(node) = edits.element(&self.description.links[*link].at) else { continue };
            if i == 0 && self.identified.tree.bodies()[k].inertia.mass() != 0.0 {
                edits.put_child(node, "inertial", inertial.to_owned());
            } else {
                edits.remove_children(node, "inertial");
            }
        }
    }

    fn edit_joint(&self, k: usize, edits: &mut Edits) {
        let joint = &self.description.joints[self.assembled.joints[k]];
        let Some(node) = edits.element(&joint.at) else { return };
        let (numbers, rotor) = self.joint(k);
        let values = dynamics(&numbers);
        match node.children().find(|child| child.has_tag_name("dynamics")) {
            Some(own) => edits.set(own, &values),
            None if values.is_empty() => {}
            None => edits.add(node, element(&values)),
        }
        if rotor != 0.0 {
            edits.put_comment(node, ROTOR, &format!(" (armature): {rotor:?}"));
        }
    }
}

/// Attributes of `<dynamics>`.
pub(super) fn dynamics(numbers: &JointNumbers) -> Vec<(&'static str, f64)> {
    let damping = numbers.damping.map(|x| ("damping", x));
    damping.into_iter().chain(numbers.friction.map(|x| ("friction", x))).collect()
}

/// `<dynamics>` with these attributes.
pub(super) fn element(values: &[(&str, f64)]) -> String {
    let values: String = values.iter().map(|(name, value)| format!(" {name}=\"{value:?}\"")).collect();
    format!("<dynamics{values}/>")
}
