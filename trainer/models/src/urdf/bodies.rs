//! Moving bodies of a description: links that are held to each other are one body.

use super::connections::{Description, Met};
use super::error::UrdfError;
use super::faults::Faults;
use super::note::{DescriptionNote, Moved};
use super::parts::JointElement;
use super::roles::Role;
use super::{Described, Inertias, Options, Roles};
use crate::tree::{Body, Inertia, Joint, Pose, Tree};
use nalgebra::Unit;
use std::collections::HashMap;

/// Tolerance for rounding in the file, relative to the inertia.
const ROUNDING: f64 = 1e-3;
/// Tolerance for rounding of the inertia about the centre, relative to the inertia about the joint.
const SHIFT: f64 = 1e-13;
/// Least principal second moment of a changed body, relative to the largest.
const THINNEST: f64 = 1e-4;

/// Bodies under construction.
struct Bodies<'d> {
    description: &'d Description,
    roles: Vec<Role>,
    bodies: Vec<Body>,
    /// Links of every body.
    links: Vec<Vec<usize>>,
    /// Body that each joint moves.
    moved: HashMap<usize, usize>,
    /// Body of every link and the link's pose in it; no body for what is fixed to the base.
    places: Vec<(Option<usize>, Pose)>,
}

/// A tree, with the parts of the description that became its bodies.
pub(super) struct Assembled {
    pub described: Described,
    /// Links of every body, the one that its joint moves first.
    pub links: Vec<Vec<usize>>,
    /// Joint of every body.
    pub joints: Vec<usize>,
}

impl Description {
    /// Returns the tree of the moving bodies.
    pub fn tree(&self, options: &Options) -> Result<Described, UrdfError> {
        Ok(self.assembled(options)?.described)
    }

    /// Returns the tree of the moving bodies, with their parts.
    pub fn assembled(&self, options: &Options) -> Result<Assembled, UrdfError> {
        let walk = self.walk()?;
        let mut roles = Roles::new(&self.joints, options, &self.links[self.root].name);
        roles.check()?;
        let mut faults = Faults::default();
        let mut all = Bodies::new(self, roles.all(&mut faults));
        for met in walk {
            let added = all.add(met);
            faults.take(added);
        }
        let mut notes = [self.notes.clone(), roles.notes].concat();
        all.judge(options.inertias, &mut faults, &mut notes);
        faults.end()?;
        all.give_coordinates();
        let joints = all.joints().into_iter().map(|(_, joint)| joint).collect();
        let links = all.links.clone();
        Ok(Assembled { described: Described { tree: all.tree()?, notes }, links, joints })
    }
}

impl<'d> Bodies<'d> {
    fn new(description: &'d Description, roles: Vec<Role>) -> Self {
        Self {
            description,
            roles,
            bodies: Vec::new(),
            links: Vec::new(),
            moved: HashMap::new(),
            places: vec![(None, Pose::identity()); description.links.len()],
        }
    }

    /// Every body with its joint, in the order of the bodies.
    fn joints(&self) -> Vec<(usize, usize)> {
        let mut joints: Vec<(usize, usize)> =
            self.moved.iter().map(|(joint, body)| (*body, *joint)).collect();
        joints.sort_unstable();
        joints
    }

    /// Adds the link on a joint, to a body of its own or to the one that carries it.
    fn add(&mut self, Met { joint: k, parent, child }: Met) -> Result<(), UrdfError> {
        let (joint, link) = (&self.description.joints[k], &self.description.links[child]);
        let (body, pose) = self.places[parent];
        let at = pose.then(&joint.pose);
        if let Role::Held(q) = self.roles[k] {
            let at = at.then(&joint.held(q)?);
            self.places[child] = (body, at);
            self.put(body, child, &at);
            return Ok(());
        }
        let number = self.bodies.len();
        self.bodies.push(joint.body(&link.name, body, at)?);
        self.links.push(Vec::new());
        self.moved.insert(k, number);
        self.places[child] = (Some(number), Pose::identity());
        self.put(Some(number), child, &Pose::identity());
        Ok(())
    }

    fn put(&mut self, body: Option<usize>, link: usize, pose: &Pose) {
        let Some(body) = body else { return };
        let own = self.description.links[link].inertia.placed(&pose.rotation, &pose.translation);
        self.bodies[body].inertia = self.bodies[body].inertia.with(&own);
        self.links[body].push(link);
    }

    /// Gives every independent joint a coordinate, and a joint that follows another one the coordinate of that joint.
    fn give_coordinates(&mut self) {
        let order = self.joints();
        let leading = order.iter().filter(|(_, joint)| self.roles[*joint] == Role::Moves);
        leading.enumerate().for_each(|(k, (body, _))| self.bodies[*body].coordinate = k);
        for (body, joint) in order {
            let Role::Follows { leader, ratio, offset } = self.roles[joint] else { continue };
            let coordinate = self.moved.get(&leader).map_or(0, |leader| self.bodies[*leader].coordinate);
            let body = &mut self.bodies[body];
            (body.coordinate, body.ratio, body.offset) = (coordinate, ratio, offset);
        }
    }

    /// Returns the tree, with the rotors of the joints.
    fn tree(self) -> Result<Tree, UrdfError> {
        let mut tree = Tree::new(self.bodies)?;
        for (joint, body) in &self.moved {
            let Body { coordinate, ratio, .. } = tree.bodies()[*body];
            tree.rotors[coordinate] += ratio * ratio * self.description.joints[*joint].armature;
        }
        tree.gravity = self.description.gravity.unwrap_or(tree.gravity);
        Ok(tree)
    }

    /// Judges masses and inertias of the bodies, and changes inertias that no body has.
    fn judge(&mut self, inertias: Inertias, faults: &mut Faults, notes: &mut Vec<DescriptionNote>) {
        for k in 0..self.bodies.len() {
            let Moved { link, joint } = moved(&self.bodies[k]);
            let mass = self.bodies[k].inertia.mass();
            if let Some(found) = self.unknown(k).filter(|_| inertias == Inertias::Required || mass != 0.0) {
                faults.push(UrdfError::NoInertia { link, joint, found });
            } else if mass > 0.0 {
                notes.extend(self.negative_masses(k));
                notes.extend(consistent(&mut self.bodies[k]));
            } else if mass < 0.0 {
                faults.push(UrdfError::NegativeMass { link, joint, mass });
            } else if inertias == Inertias::Required {
                notes.extend(faults.take(self.massless(k)).flatten());
            }
        }
    }

    /// Reason why the inertia of a body is not known.
    fn unknown(&self, k: usize) -> Option<String> {
        self.links[k].iter().find_map(|link| self.description.links[*link].unknown.clone())
    }

    /// Returns a note on a body without mass that carries mass, unless it only stands between two joints of an MJCF body;
    /// refuses one that carries none.
    fn massless(&self, k: usize) -> Result<Option<DescriptionNote>, UrdfError> {
        let body = moved(&self.bodies[k]);
        let carried = carried_mass(&self.bodies, k);
        let mut links = self.links[k].iter().map(|link| &self.description.links[*link]);
        if carried > 0.0 {
            let note = DescriptionNote::Massless { body, carried };
            return Ok(links.any(|link| !link.at.is_empty()).then_some(note));
        }
        let found =
            if links.any(|link| link.has_inertial) { "its <mass> is 0" } else { "<inertial> is missing" };
        Err(UrdfError::NoInertia { link: body.link, joint: body.joint, found: found.to_owned() })
    }

    fn negative_masses(&self, k: usize) -> impl Iterator<Item = DescriptionNote> {
        let (body, total) = (moved(&self.bodies[k]), self.bodies[k].inertia.mass());
        let links = self.links[k].iter().map(|link| &self.description.links[*link]);
        links.filter(|link| link.inertia.mass() < 0.0).map(move |link| DescriptionNote::NegativeMass {
            link: link.name.clone(),
            mass: link.inertia.mass(),
            body: body.clone(),
            total,
        })
    }
}

/// Mass of all bodies that a body carries, kg.
fn carried_mass(bodies: &[Body], k: usize) -> f64 {
    let mut is_carried = vec![false; bodies.len()];
    let mut mass = 0.0;
    for (i, body) in bodies.iter().enumerate().skip(k + 1) {
        is_carried[i] = body.parent.is_some_and(|parent| parent == k || is_carried[parent]);
        mass += if is_carried[i] { body.inertia.mass().max(0.0) } else { 0.0 };
    }
    mass
}

/// Names of a body and its joint.
pub(crate) fn moved(body: &Body) -> Moved {
    Moved { link: body.name.clone(), joint: body.joint_name.clone() }
}

/// Changes an inertia that no body has, beyond rounding, to the nearest one that a body can have.
fn consistent(body: &mut Body) -> Option<DescriptionNote> {
    let given = body.inertia;
    let [least, _, most] = given.principal_spreads();
    let tolerance = ROUNDING * given.about_centre().norm() + SHIFT * given.rotational().norm();
    if least >= -tolerance {
        return None;
    }
    body.inertia = given.nearest(thinnest(most));
    let [before, after] = [given, body.inertia].map(|inertia| inertia.principal_moments());
    Some(DescriptionNote::Inertia {
        body: moved(body),
        before,
        after,
        change: given.change_to(&body.inertia),
    })
}

/// Least principal second moment of a changed body whose largest is `most`.
fn thinnest(most: f64) -> f64 {
    THINNEST * most.max(0.0)
}

/// Returns a body of positive mass with a positive definite pseudo-inertia, and a note on its change if there is one:
/// a body that is too thin is thickened, and a mass without extent becomes a ball of this radius (m).
pub(crate) fn with_extent(body: &Body, radius: f64) -> (Inertia, Option<DescriptionNote>) {
    let given = body.inertia;
    let [least, _, most] = given.principal_spreads();
    if most <= 1e-12 * given.mass() * radius * radius + SHIFT * given.rotational().norm() {
        let note = DescriptionNote::Extent { body: moved(body), mass: given.mass(), radius };
        return (given.as_ball(radius), Some(note));
    }
    if least >= thinnest(most) {
        return (given, None);
    }
    let thick = given.nearest(thinnest(most));
    (thick, Some(DescriptionNote::Thin { body: moved(body), change: given.change_to(&thick) }))
}

impl JointElement {
    /// Pose that the joint gives to what it carries when it is held at the position q.
    fn held(&self, q: f64) -> Result<Pose, UrdfError> {
        if q == 0.0 { Ok(Pose::identity()) } else { Ok(self.joint()?.pose(q)) }
    }

    fn joint(&self) -> Result<Joint, UrdfError> {
        let axis = Unit::try_new(self.axis, 1e-12).ok_or_else(|| UrdfError::Axis(self.name.clone()))?;
        Ok(if self.kind == "prismatic" { Joint::Prismatic(axis) } else { Joint::Revolute(axis) })
    }

    /// Returns the body that the joint moves, without its inertia.
    fn body(&self, link: &str, parent: Option<usize>, pose: Pose) -> Result<Body, UrdfError> {
        Ok(Body {
            name: link.to_owned(),
            joint_name: self.name.clone(),
            parent,
            joint: self.joint()?,
            pose,
            coordinate: 0,
            ratio: 1.0,
            offset: 0.0,
            inertia: Inertia::default(),
            limits: self.limits,
        })
    }
}
