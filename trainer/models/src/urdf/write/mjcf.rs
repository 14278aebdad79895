//! The text of an MJCF file, with other numbers.

use super::text::{inertial_of_mjcf, numbers};
use super::{Edits, Job};
use crate::urdf::UrdfError;
use crate::urdf::mjcf::gravity;
use nalgebra::Matrix3;
use roxmltree::Document;

/// `<inertial>` of a body whose mass is part of another one.
const NOTHING: &str = "<inertial pos=\"0 0 0\" mass=\"0\" diaginertia=\"0 0 0\"/>";

impl Job {
    /// Returns the text with the identified numbers.
    pub fn edited_mjcf(&self, document: &Document) -> Result<String, UrdfError> {
        let mut edits = Edits::new(document);
        for k in 0..self.assembled.links.len() {
            if self.is_changed(k) {
                self.edit_bodies(k, &mut edits);
            }
            self.edit_hinge(k, &mut edits);
        }
        let root = document.root_element();
        let own = self.identified.tree.gravity;
        if gravity(root)? != own {
            edits.append(root, format!("<option gravity=\"{}\"/>", numbers(&own)));
        }
        Ok(edits.text())
    }

    /// Gives the whole inertia of a body to the element that its joint moves, and none to those welded to it.
    fn edit_bodies(&self, k: usize, edits: &mut Edits) {
        for (i, link) in self.assembled.links[k].iter().enumerate() {
            let link = &self.description.links[*link];
            let Some(node) = edits.element(&link.at) else { continue };
            let inertia = self.identified.tree.bodies()[k].inertia.placed(&Matrix3::identity(), &link.origin);
            let text = if i == 0 { inertial_of_mjcf(&inertia) } else { NOTHING.to_owned() };
            edits.put_child(node, "inertial", text);
        }
    }

    fn edit_hinge(&self, k: usize, edits: &mut Edits) {
        let joint = &self.description.joints[self.assembled.joints[k]];
        let Some(node) = edits.element(&joint.at) else { return };
        let (own, rotor) = self.joint(k);
        let armature = (rotor != joint.armature).then_some(("armature", rotor));
        let damping = own.damping.map(|x| ("damping", x));
        let friction = own.friction.map(|x| ("frictionloss", x));
        edits.set(node, &[armature, damping, friction].into_iter().flatten().collect::<Vec<_>>());
    }
}
