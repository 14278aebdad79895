//! Links and joints, and their connections.

use super::error::UrdfError;
use super::faults::Faults;
use super::note::DescriptionNote;
use super::parts::{JointElement, Link};
use nalgebra::Vector3;
use std::collections::{HashMap, VecDeque};

/// Links and joints that hang from one root.
pub(super) struct Description {
    pub links: Vec<Link>,
    pub joints: Vec<JointElement>,
    pub root: usize,
    /// Gravity in the base frame, m/s², if the file has it.
    pub gravity: Option<Vector3<f64>>,
    /// Whether coordinates are in the order of a depth-first walk, as in MuJoCo.
    pub is_depth_first: bool,
    /// Notes on what the file has beside links and joints.
    pub notes: Vec<DescriptionNote>,
    /// Joints on every link, each with the link that it moves.
    carried: Vec<Vec<(usize, usize)>>,
}

/// A joint, with the links that it connects.
#[derive(Clone, Copy)]
pub(super) struct Met {
    pub joint: usize,
    pub parent: usize,
    pub child: usize,
}

impl Description {
    pub fn new(links: Vec<Link>, joints: Vec<JointElement>) -> Result<Self, UrdfError> {
        let mut faults = Faults::default();
        let names = numbered("link", links.iter().map(|link| &link.name), &mut faults);
        numbered("joint", joints.iter().map(|joint| &joint.name), &mut faults);
        let mut carried = vec![Vec::new(); links.len()];
        let mut parent: Vec<Option<usize>> = vec![None; links.len()];
        for (k, joint) in joints.iter().enumerate() {
            let no_link = |link: &String| UrdfError::NoLink { joint: joint.name.clone(), link: link.clone() };
            let of = |link: &String| names.get(link.as_str()).copied().ok_or_else(|| no_link(link));
            let [from, to] = [&joint.parent, &joint.child].map(|link| faults.take(of(link)));
            let (Some(from), Some(to)) = (from, to) else { continue };
            if let Some(first) = parent[to].replace(k) {
                let [first, second] = [first, k].map(|k| joints[k].name.clone());
                faults.push(UrdfError::TwoParents { link: joint.child.clone(), first, second });
            }
            carried[from].push((k, to));
        }
        faults.end()?;
        if links.is_empty() {
            return Err(UrdfError::NoLinks);
        }
        let mut roots = (0..links.len()).filter(|link| parent[*link].is_none());
        let root = roots.next().ok_or(UrdfError::NoRoot)?;
        if let Some(second) = roots.next() {
            let [first, second] = [root, second].map(|link| links[link].name.clone());
            return Err(UrdfError::TwoRoots { first, second });
        }
        let (gravity, is_depth_first, notes) = (None, false, Vec::new());
        Ok(Self { links, joints, root, gravity, is_depth_first, notes, carried })
    }

    /// Joints in the order of the coordinates, each after those that carry it. What is held still does not change it.
    pub fn walk(&self) -> Result<Vec<Met>, UrdfError> {
        let mut met = Vec::with_capacity(self.joints.len());
        let mut is_met = vec![false; self.links.len()];
        // Links still to be visited, with the joint that carries them unless it was met with its parent.
        let mut open = VecDeque::from([(self.root, None)]);
        while let Some((parent, fixed)) = open.pop_back() {
            is_met[parent] = true;
            met.extend(fixed);
            let each = self.carried[parent].iter().map(|(joint, child)| Met {
                joint: *joint,
                parent,
                child: *child,
            });
            let is_next = |met: &Met| self.is_depth_first || self.joints[met.joint].kind == "fixed";
            let (held, moving): (Vec<Met>, Vec<Met>) = each.partition(is_next);
            // The last link pushed is visited first, so the order is reversed.
            open.extend(held.into_iter().rev().map(|met| (met.child, Some(met))));
            for joint in moving {
                met.push(joint);
                open.push_front((joint.child, None));
            }
        }
        match is_met.iter().position(|met| !met) {
            Some(link) => Err(UrdfError::Cycle(self.links[link].name.clone())),
            None => Ok(met),
        }
    }
}

/// Positions of names in their list; a name that stands twice is a fault.
fn numbered<'n>(
    kind: &str,
    names: impl Iterator<Item = &'n String>,
    faults: &mut Faults,
) -> HashMap<&'n str, usize> {
    let mut all = HashMap::new();
    for (k, name) in names.enumerate() {
        if all.insert(name.as_str(), k).is_some() {
            faults.push(UrdfError::Twice(format!("{kind} {name}")));
        }
    }
    all
}
