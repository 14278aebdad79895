//! Links and joints of a model of MuJoCo (MJCF), as those of a URDF file.
//!
//! A body without joints is a link on a fixed joint. A body with several joints is a chain of links, of which the last
//! has its mass. The frame of a link is at the anchor of its joint, with the axes of the body; `ref` turns or shifts
//! the frame, so that q counts as in MuJoCo. Equality constraints of two joints are followers (`<mimic>`).
//! A body or joint without a name is called by its number in MuJoCo: "joint 3".

mod body;
mod classes;
mod compiler;
mod equality;
mod geoms;
mod include;
mod inertial;
mod joints;
mod left_out;
mod pose;
mod values;

pub(super) use compiler::gravity;
pub(super) use include::with_included;

use super::connections::Description;
use super::error::{MOST_LINKS, UrdfError};
use super::faults::Faults;
use super::note::DescriptionNote;
use super::parts::{JointElement, Link};
use crate::tree::Pose;
use body::{Member, members};
use classes::Classes;
use compiler::Compiler;
use joints::Anchored;
use nalgebra::Vector3;
use roxmltree::Node;
use std::collections::HashMap;

/// Name of the base.
const WORLD: &str = "world";

/// Settings that hold for all bodies.
struct Settings<'a> {
    compiler: Compiler,
    classes: Classes<'a>,
}

/// A body that is still to be read, with the link that carries it and the pose of its parent's frame in that link.
struct Waiting<'a, 'i> {
    member: Member<'a, 'i>,
    parent: String,
    pose: Pose,
}

/// Links and joints found so far.
#[derive(Default)]
struct Found {
    links: Vec<Link>,
    joints: Vec<JointElement>,
    /// Number of bodies; the world is number 0 of MuJoCo's.
    bodies: usize,
    /// Number of joints, without those that only fix a body.
    singles: usize,
    /// Positions of joints at which the bodies are where the file has them, rad or m.
    zeros: HashMap<String, f64>,
    /// Joints with limits of 0.
    zero_limits: Vec<String>,
    faults: Faults,
    notes: Vec<DescriptionNote>,
}

/// Whether masses and inertias can be other than those of `<inertial>`.
pub(super) fn changes_inertials(root: Node) -> Result<bool, UrdfError> {
    Ok(Compiler::read(root)?.changes_inertials())
}

/// Reads the links and joints below `<mujoco>`.
pub(super) fn description(root: Node) -> Result<Description, UrdfError> {
    left_out::refuse(root)?;
    let settings = Settings { compiler: Compiler::read(root)?, classes: Classes::read(root)? };
    let mut found = Found { links: vec![Link::empty(WORLD, 0..0)], ..Found::default() };
    found.read_bodies(root, &settings)?;
    settings.compiler.scale(&mut found.links);
    equality::read(root, &mut found);
    found.notes.extend(left_out::notes(root, &settings.classes));
    let joints = std::mem::take(&mut found.zero_limits);
    found.notes.extend((!joints.is_empty()).then_some(DescriptionNote::ZeroLimits { joints }));
    found.faults.end()?;
    let mut description = Description::new(found.links, found.joints)?;
    description.is_depth_first = true;
    description.gravity = Some(compiler::gravity(root)?);
    description.notes = found.notes;
    Ok(description)
}

impl Found {
    /// Reads all bodies, each after the one that carries it and before the next on that one.
    fn read_bodies(&mut self, root: Node, settings: &Settings) -> Result<(), UrdfError> {
        let mut waiting = Vec::new();
        for world in root.children().filter(|node| node.has_tag_name("worldbody")) {
            let bodies = members(world, None, settings)?.into_iter();
            let bodies = bodies.filter(|member| member.node.has_tag_name("body"));
            waiting.extend(bodies.map(|member| Waiting {
                member,
                parent: WORLD.to_owned(),
                pose: Pose::identity(),
            }));
        }
        waiting.reverse();
        while let Some(next) = waiting.pop() {
            let carried = self.read_body(next, settings);
            waiting.extend(self.faults.take(carried).into_iter().flatten().rev());
            if self.links.len() > MOST_LINKS {
                return Err(UrdfError::Links(self.links.len()));
            }
            if self.faults.are_many() {
                break;
            }
        }
        Ok(())
    }

    /// Reads a body; returns those that it carries.
    fn read_body<'a, 'i>(
        &mut self,
        body: Waiting<'a, 'i>,
        settings: &Settings,
    ) -> Result<Vec<Waiting<'a, 'i>>, UrdfError> {
        let node = body.member.node;
        let class = node.attribute("childclass").or(body.member.class);
        self.bodies += 1;
        let name = node.attribute("name").map_or_else(|| format!("body {}", self.bodies), str::to_owned);
        let members = members(node, class, settings)?;
        let pose = body.pose.then(&body.member.frame).then(&settings.pose(node, None)?);
        let anchor = self.read_joints(&name, &members, (&body.parent, pose), settings);
        let own = settings.link((node, &name), &members)?;
        self.links.push(own.seen_from(anchor));
        let shift = Pose { translation: -anchor, ..Pose::identity() };
        let carried = members.into_iter().filter(|member| member.node.has_tag_name("body"));
        Ok(carried.map(|member| Waiting { member, parent: name.clone(), pose: shift }).collect())
    }

    /// Reads the joints of a body, with links between them; returns the anchor of the last one in the body's frame.
    fn read_joints(
        &mut self,
        name: &str,
        members: &[Member],
        (parent, pose): (&str, Pose),
        settings: &Settings,
    ) -> Vector3<f64> {
        let of_kind = |member: &&Member| ["joint", "freejoint"].contains(&member.node.tag_name().name());
        let joints: Vec<&Member> = members.iter().filter(of_kind).collect();
        if joints.is_empty() {
            self.joints.push(JointElement::fixed([parent, name], pose));
        }
        let (mut parent, mut pose, mut anchor) = (parent.to_owned(), pose, Vector3::zeros());
        for (k, member) in joints.iter().enumerate() {
            let read = settings.joint(member, self.singles);
            self.singles += 1;
            let Some(found) = self.faults.take(read) else { continue };
            anchor = found.anchor;
            let is_last = k + 1 == joints.len();
            let child = if is_last { name.to_owned() } else { format!("{name}, joint {}", k + 1) };
            if !is_last {
                self.links.push(Link::empty(&child, 0..0));
            }
            self.put_joint(found, [&parent, &child], &pose);
            (parent, pose) = (child, Pose { translation: -anchor, ..Pose::identity() });
        }
        anchor
    }

    /// Puts a joint between two links; `pose` is that of its body's frame in the first.
    fn put_joint(&mut self, found: Anchored, [parent, child]: [&str; 2], pose: &Pose) {
        let Anchored { mut joint, zero, has_zero_limits, .. } = found;
        self.zeros.insert(joint.name.clone(), zero);
        if has_zero_limits {
            self.zero_limits.push(joint.name.clone());
        }
        joint.pose = pose.then(&joint.pose);
        (joint.parent, joint.child) = (parent.to_owned(), child.to_owned());
        self.joints.push(joint);
    }
}
