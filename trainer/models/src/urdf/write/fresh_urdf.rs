//! A URDF file of the moving bodies alone.

use super::Job;
use super::text::{escaped, inertial_of_urdf, numbers, roll_pitch_yaw};
use super::urdf::{ROTOR, dynamics, element};
use crate::tree::{Body, Joint, Limits};
use std::fmt::Write;

/// Name of the link at the base.
const BASE: &str = "world";

impl Job {
    /// Returns the text of a file with the moving bodies.
    pub fn fresh_urdf(&self, name: Option<&str>) -> String {
        let mut text =
            format!("<robot name=\"{}\">\n  <link name=\"{BASE}\"/>\n", escaped(name.unwrap_or("robot")));
        for (k, body, inertia) in self.bodies() {
            let inertial = if inertia.mass() == 0.0 { String::new() } else { inertial_of_urdf(&inertia) };
            let _ = writeln!(text, "  <link name=\"{}\">{inertial}</link>", escaped(&body.name));
            let _ = writeln!(text, "  {}", self.joint_of_urdf(k, body));
        }
        text + "</robot>\n"
    }

    fn joint_of_urdf(&self, k: usize, body: &Body) -> String {
        let kind = match body.joint {
            Joint::Revolute(_) if body.limits.position[1].is_infinite() => "continuous",
            Joint::Revolute(_) => "revolute",
            Joint::Prismatic(_) => "prismatic",
        };
        let parent = body.parent.map_or(BASE, |parent| &self.described().bodies()[parent].name);
        let (own, rotor) = self.joint(k);
        let values = dynamics(&own);
        let dynamics = if values.is_empty() { String::new() } else { element(&values) };
        let comment =
            if rotor == 0.0 { String::new() } else { format!("<!-- {ROTOR} (armature): {rotor:?} -->") };
        format!(
            "<joint name=\"{}\" type=\"{kind}\"><parent link=\"{}\"/><child link=\"{}\"/><origin xyz=\"{}\" rpy=\"{}\"/>\
             <axis xyz=\"{}\"/>{}{dynamics}{comment}</joint>",
            escaped(&body.joint_name),
            escaped(parent),
            escaped(&body.name),
            numbers(&body.pose.translation),
            numbers(&roll_pitch_yaw(&body.pose.rotation)),
            numbers(&body.joint.axis()),
            limit(&body.limits),
        )
    }
}

/// `<limit>` with what is finite.
fn limit(limits: &Limits) -> String {
    let [lower, upper] = limits.position;
    let all = [("lower", lower), ("upper", upper), ("velocity", limits.velocity), ("effort", limits.effort)];
    let finite: Vec<String> =
        all.iter().filter(|(_, x)| x.is_finite()).map(|(name, x)| format!(" {name}=\"{x:?}\"")).collect();
    if finite.is_empty() { String::new() } else { format!("<limit{}/>", finite.concat()) }
}
