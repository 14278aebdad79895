//! An MJCF file of the moving bodies alone.

use super::Job;
use super::text::{escaped, inertial_of_mjcf, numbers};
use crate::tree::{Body, Inertia, Joint};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use std::fmt::Write;

/// Mass (kg) and moments of inertia (kg m²) of a body without mass, which MuJoCo refuses.
const SPECK: f64 = 1e-12;

impl Job {
    /// Returns the text of a file with the moving bodies.
    pub fn fresh_mjcf(&self, name: Option<&str>) -> String {
        let mut text = format!(
            "<mujoco model=\"{}\">\n  <compiler angle=\"radian\" autolimits=\"true\"/>\n  <option gravity=\"{}\"/>\n  <worldbody>\n",
            escaped(name.unwrap_or("robot")),
            numbers(&self.identified.tree.gravity)
        );
        let mut waiting: Vec<Step> = self.carried(None);
        while let Some(step) = waiting.pop() {
            match step {
                Step::Open(k, depth) => {
                    self.open(k, depth, &mut text);
                    waiting.push(Step::Close(depth));
                    waiting.extend(self.carried(Some((k, depth))));
                }
                Step::Close(depth) => {
                    let _ = writeln!(text, "{}</body>", indent(depth));
                }
            }
        }
        text + "  </worldbody>\n</mujoco>\n"
    }

    /// Steps that write the bodies on a body, the last one first.
    fn carried(&self, on: Option<(usize, usize)>) -> Vec<Step> {
        let (parent, depth) = (on.map(|(k, _)| k), on.map_or(0, |(_, depth)| depth + 1));
        let bodies = self.described().bodies().iter().enumerate().rev();
        bodies.filter(|(_, body)| body.parent == parent).map(|(k, _)| Step::Open(k, depth)).collect()
    }

    fn open(&self, k: usize, depth: usize, text: &mut String) {
        let body = &self.described().bodies()[k];
        let turn =
            UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(body.pose.rotation));
        let quat = [turn.w, turn.i, turn.j, turn.k];
        let given = self.identified.tree.bodies()[k].inertia;
        let speck = Inertia::of_centre(SPECK, Vector3::zeros(), Matrix3::identity() * SPECK);
        let inertia = if given.mass() == 0.0 { given.with(&speck) } else { given };
        let (outer, inner) = (indent(depth), indent(depth + 1));
        let _ = writeln!(
            text,
            "{outer}<body name=\"{}\" pos=\"{}\" quat=\"{}\">\n{inner}{}\n{inner}{}",
            escaped(&body.name),
            numbers(&body.pose.translation),
            numbers(&quat),
            inertial_of_mjcf(&inertia),
            self.joint_of_mjcf(k, body)
        );
    }

    fn joint_of_mjcf(&self, k: usize, body: &Body) -> String {
        let kind = if matches!(body.joint, Joint::Prismatic(_)) { "slide" } else { "hinge" };
        let (own, rotor) = self.joint(k);
        let [lower, upper] = body.limits.position;
        let mut text = format!(
            "<joint name=\"{}\" type=\"{kind}\" axis=\"{}\"",
            escaped(&body.joint_name),
            numbers(&body.joint.axis())
        );
        if lower.is_finite() && upper.is_finite() && lower < upper {
            let _ = write!(text, " range=\"{lower:?} {upper:?}\"");
        }
        let effort = body.limits.effort;
        if effort.is_finite() && effort > 0.0 {
            let _ = write!(text, " actuatorfrcrange=\"{:?} {effort:?}\"", -effort);
        }
        let values = [("armature", Some(rotor)), ("damping", own.damping), ("frictionloss", own.friction)];
        for (name, value) in values {
            value.into_iter().for_each(|value| text += &format!(" {name}=\"{value:?}\""));
        }
        text + "/>"
    }
}

/// A step of writing nested elements.
enum Step {
    /// Opens a body at a depth.
    Open(usize, usize),
    /// Closes the body that is open at a depth.
    Close(usize),
}

fn indent(depth: usize) -> String {
    "  ".repeat(depth.min(40) + 2)
}
