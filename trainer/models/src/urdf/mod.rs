//! Construction of a tree from a robot description (URDF).
//!
//! The root link is fixed to the base, and its frame is that of the base. Links on fixed joints are merged with the
//! body that carries them; links fixed to the base vanish. Joints that follow another one (`<mimic>`) move with the
//! coordinate of that joint. Coordinates are in the order in which a depth-first walk from the base meets their joints,
//! with the children of a link in the order of the file. Meshes, colours, transmissions and everything else are
//! ignored. A document type is refused, which excludes entities that expand; nothing here is recursive, however deep
//! the file is nested.

mod error;
mod parts;

pub use error::{MOST_BYTES, MOST_LINKS, UrdfError};

use crate::tree::{Body, Joint, Pose, Tree};
use nalgebra::Unit;
use parts::{JointElement, Link};
use std::collections::HashMap;
use std::path::Path;

/// Whether bodies may have no mass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Inertias {
    /// Every moving body has a mass.
    Required,
    /// A body without mass gets zeros, for [`Tree::with_guessed_inertias`].
    Optional,
}

/// Reads a robot description from a file.
///
/// # Errors
/// [`UrdfError`].
pub fn read(path: &Path, inertias: Inertias) -> Result<Tree, UrdfError> {
    let failed = |error| UrdfError::Io { path: path.to_owned(), error };
    let bytes = std::fs::metadata(path).map_err(failed)?.len();
    if bytes > MOST_BYTES as u64 {
        return Err(UrdfError::Bytes(usize::try_from(bytes).unwrap_or(usize::MAX)));
    }
    parse(&std::fs::read_to_string(path).map_err(failed)?, inertias)
}

/// Reads a robot description from its text.
///
/// # Errors
/// [`UrdfError`].
pub fn parse(text: &str, inertias: Inertias) -> Result<Tree, UrdfError> {
    if text.len() > MOST_BYTES {
        return Err(UrdfError::Bytes(text.len()));
    }
    let document = roxmltree::Document::parse(text)?;
    let robot = document.root_element();
    if !robot.has_tag_name("robot") {
        return Err(UrdfError::NotRobot(robot.tag_name().name().to_owned()));
    }
    let of = |name: &'static str| robot.children().filter(move |node| node.has_tag_name(name));
    let links = of("link").count();
    if links > MOST_LINKS {
        return Err(UrdfError::Links(links));
    }
    let links = of("link").map(Link::read).collect::<Result<Vec<_>, _>>()?;
    let joints = of("joint").map(JointElement::read).collect::<Result<Vec<_>, _>>()?;
    Description::new(links, joints)?.tree(inertias)
}

/// Links and joints, and their connections.
struct Description {
    links: Vec<Link>,
    joints: Vec<JointElement>,
    /// Joints on every link, each with the link that it moves.
    carried: Vec<Vec<(usize, usize)>>,
    root: usize,
}

impl Description {
    fn new(links: Vec<Link>, joints: Vec<JointElement>) -> Result<Self, UrdfError> {
        let names = numbered("link", links.iter().map(|link| &link.name))?;
        numbered("joint", joints.iter().map(|joint| &joint.name))?;
        let mut carried = vec![Vec::new(); links.len()];
        let mut parent: Vec<Option<usize>> = vec![None; links.len()];
        for (k, joint) in joints.iter().enumerate() {
            let no_link = |link: &String| UrdfError::NoLink { joint: joint.name.clone(), link: link.clone() };
            let of = |link: &String| names.get(link.as_str()).copied().ok_or_else(|| no_link(link));
            let (from, to) = (of(&joint.parent)?, of(&joint.child)?);
            if let Some(first) = parent[to].replace(k) {
                let [first, second] = [first, k].map(|k| joints[k].name.clone());
                return Err(UrdfError::TwoParents { link: joint.child.clone(), first, second });
            }
            carried[from].push((k, to));
        }
        let mut roots = (0..links.len()).filter(|link| parent[*link].is_none());
        let root = roots.next().ok_or(UrdfError::NoRoot)?;
        if let Some(second) = roots.next() {
            let [first, second] = [root, second].map(|link| links[link].name.clone());
            return Err(UrdfError::TwoRoots { first, second });
        }
        Ok(Self { links, joints, carried, root })
    }

    fn tree(&self, inertias: Inertias) -> Result<Tree, UrdfError> {
        let mut bodies: Vec<Body> = Vec::new();
        // Body that each joint moves.
        let mut moved: HashMap<&str, usize> = HashMap::new();
        let mut is_met = vec![false; self.links.len()];
        // Links still to be visited, each with the body that it belongs to and its pose in that body.
        let mut open = vec![(self.root, None, Pose::identity())];
        while let Some((link, body, pose)) = open.pop() {
            is_met[link] = true;
            if let Some(body) = body {
                let body: &mut Body = &mut bodies[body];
                let own = self.links[link].inertia.placed(&pose.rotation, &pose.translation);
                body.inertia = body.inertia.with(&own);
            }
            // The last link pushed is visited first, so the order is reversed.
            for (k, child) in self.carried[link].iter().rev() {
                let at = pose.then(&self.joints[*k].pose);
                if self.joints[*k].kind == "fixed" {
                    open.push((*child, body, at));
                }
            }
            for (k, child) in &self.carried[link] {
                let joint = &self.joints[*k];
                if joint.kind == "fixed" {
                    continue;
                }
                moved.insert(&joint.name, bodies.len());
                open.insert(0, (*child, Some(bodies.len()), Pose::identity()));
                bodies.push(joint.body(&self.links[*child].name, body, pose.then(&joint.pose))?);
            }
        }
        if let Some(link) = is_met.iter().position(|met| !met) {
            return Err(UrdfError::Cycle(self.links[link].name.clone()));
        }
        self.give_coordinates(&mut bodies, &moved)?;
        if inertias == Inertias::Required {
            with_mass(&bodies)?;
        }
        Ok(Tree::new(bodies)?)
    }

    /// Gives every independent joint a coordinate, and a joint that follows another one the coordinate of that joint.
    fn give_coordinates(&self, bodies: &mut [Body], moved: &HashMap<&str, usize>) -> Result<(), UrdfError> {
        let followed: HashMap<&str, &(String, f64, f64)> = self
            .joints
            .iter()
            .filter_map(|joint| Some((joint.name.as_str(), joint.mimic.as_ref()?)))
            .collect();
        let leading = bodies.iter_mut().filter(|body| !followed.contains_key(body.joint_name.as_str()));
        leading.enumerate().for_each(|(k, body)| body.coordinate = k);
        for k in 0..bodies.len() {
            let joint = bodies[k].joint_name.clone();
            let Some((leader, multiplier, offset)) = followed.get(joint.as_str()) else { continue };
            let wrong = |why| UrdfError::Mimic { joint: joint.clone(), leader: leader.clone(), why };
            if followed.contains_key(leader.as_str()) {
                return Err(wrong("follows another joint itself"));
            }
            let leading = moved.get(leader.as_str()).ok_or_else(|| wrong("does not move"))?;
            let coordinate = bodies[*leading].coordinate;
            let body = &mut bodies[k];
            (body.coordinate, body.ratio, body.offset) = (coordinate, *multiplier, *offset);
        }
        Ok(())
    }
}

impl JointElement {
    /// Returns the body that the joint moves, without its inertia.
    fn body(&self, link: &str, parent: Option<usize>, pose: Pose) -> Result<Body, UrdfError> {
        let axis = || Unit::try_new(self.axis, 1e-12).ok_or_else(|| UrdfError::Axis(self.name.clone()));
        let joint = match self.kind.as_str() {
            "revolute" | "continuous" => Joint::Revolute(axis()?),
            "prismatic" => Joint::Prismatic(axis()?),
            kind => return Err(UrdfError::Kind { joint: self.name.clone(), kind: kind.to_owned() }),
        };
        Ok(Body {
            name: link.to_owned(),
            joint_name: self.name.clone(),
            parent,
            joint,
            pose,
            coordinate: 0,
            ratio: 1.0,
            offset: 0.0,
            inertia: crate::tree::Inertia::default(),
            limits: self.limits,
        })
    }
}

/// Positions of names in their list.
fn numbered<'n>(
    kind: &str,
    names: impl Iterator<Item = &'n String>,
) -> Result<HashMap<&'n str, usize>, UrdfError> {
    let mut all = HashMap::new();
    for (k, name) in names.enumerate() {
        if all.insert(name.as_str(), k).is_some() {
            return Err(UrdfError::Twice(format!("{kind} {name}")));
        }
    }
    Ok(all)
}

fn with_mass(bodies: &[Body]) -> Result<(), UrdfError> {
    match bodies.iter().find(|body| body.inertia.mass() <= 0.0) {
        Some(body) => Err(UrdfError::NoInertia { link: body.name.clone(), joint: body.joint_name.clone() }),
        None => Ok(()),
    }
}
