//! Roles of the joints: which of them move, and where the others are held.

use super::Options;
use super::error::UrdfError;
use super::faults::Faults;
use super::note::DescriptionNote;
use super::parts::JointElement;
use std::collections::HashMap;

/// Treatment of joints that follow a moving one (`<mimic>`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Followers {
    /// They move with the coordinate of that joint.
    #[default]
    Move,
    /// They are held still at their offsets, with a note.
    Held,
}

/// Role of a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Role {
    /// It has a coordinate.
    Moves,
    /// It moves with another joint: its position is ratio · that of the leader + offset.
    Follows { leader: usize, ratio: f64, offset: f64 },
    /// It is held at a position, rad or m.
    Held(f64),
}

/// Joint that another one follows, or its name if it does not exist: position = ratio · that of the leader + offset.
struct Led<'d> {
    leader: Result<usize, &'d str>,
    ratio: f64,
    offset: f64,
}

/// Kind of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Fixed,
    /// One coordinate.
    Single,
    /// Several coordinates.
    Free,
    Unknown,
}

impl JointElement {
    fn class(&self) -> Kind {
        match self.kind.as_str() {
            "fixed" => Kind::Fixed,
            "revolute" | "continuous" | "prismatic" => Kind::Single,
            "floating" | "planar" | "spherical" | "ball" => Kind::Free,
            _ => Kind::Unknown,
        }
    }

    /// Name of the joint that it follows, with multiplier and offset; a fixed joint follows none.
    fn leader(&self) -> Option<&(String, f64, f64)> {
        self.mimic.as_ref().filter(|_| self.class() == Kind::Single)
    }
}

/// Joints with the choice that is made among them.
pub(super) struct Roles<'d> {
    joints: &'d [JointElement],
    options: &'d Options,
    /// Name of the link that carries all.
    root: &'d str,
    numbers: HashMap<&'d str, usize>,
    pub notes: Vec<DescriptionNote>,
}

impl<'d> Roles<'d> {
    pub fn new(joints: &'d [JointElement], options: &'d Options, root: &'d str) -> Self {
        let numbers = joints.iter().enumerate().map(|(k, joint)| (joint.name.as_str(), k)).collect();
        Self { joints, options, root, numbers, notes: Vec::new() }
    }

    /// Refuses a choice that the joints do not allow.
    pub fn check(&self) -> Result<(), UrdfError> {
        let chosen = self.options.joints.iter().flatten();
        for (i, name) in chosen.clone().enumerate() {
            let wrong = |why: String| Err(UrdfError::Choice { key: "joints", joint: name.clone(), why });
            if chosen.clone().take(i).any(|other| other == name) {
                return wrong("stands in the list twice".to_owned());
            }
            if let Some(why) = self.why_no_coordinate(self.joint("joints", name)?) {
                return wrong(why);
            }
        }
        self.options.lock.iter().try_for_each(|(name, at)| self.check_lock(name, *at))
    }

    fn check_lock(&self, name: &str, at: f64) -> Result<(), UrdfError> {
        let wrong = |why: String| Err(UrdfError::Choice { key: "lock", joint: name.to_owned(), why });
        let joint = self.joint("lock", name)?;
        if joint.class() != Kind::Single {
            return wrong(format!("is {}, and has no position; leave it out", joint.kind));
        }
        if self.options.joints.iter().flatten().any(|chosen| chosen == name) {
            return wrong("stands among `joints` too; leave it out of one of them".to_owned());
        }
        if at.is_finite() { Ok(()) } else { wrong(format!("cannot be held at {at}")) }
    }

    /// Reason why a joint cannot be a coordinate.
    fn why_no_coordinate(&self, joint: &JointElement) -> Option<String> {
        match (joint.class(), joint.leader()) {
            (Kind::Single, Some((leader, ..))) => Some(format!(
                "follows {leader} (<mimic>): each joint of a model has a coordinate of its own, so only {leader} can \
                 be one; leave it out, or take the <mimic> out of the description"
            )),
            (Kind::Single, None) => None,
            _ => Some(format!("is {}, and has no single coordinate; leave it out", joint.kind)),
        }
    }

    fn joint(&self, key: &'static str, name: &str) -> Result<&'d JointElement, UrdfError> {
        let known = || {
            let moving = self.joints.iter().filter(|joint| joint.class() == Kind::Single);
            moving.map(|joint| joint.name.as_str()).collect::<Vec<_>>().join(", ")
        };
        let found = self.numbers.get(name).map(|k| &self.joints[*k]);
        found.ok_or_else(|| UrdfError::NoJoint { key, name: name.to_owned(), known: known() })
    }

    /// Returns the role of every joint.
    pub fn all(&mut self, faults: &mut Faults) -> Vec<Role> {
        let mut roles: Vec<Role> = (0..self.joints.len()).map(|k| self.own(k, faults)).collect();
        for k in 0..self.joints.len() {
            if self.follows(k) {
                let led = self.led(k).map(|led| self.follower(k, led, &roles));
                roles[k] = faults.take(led).unwrap_or(Role::Held(0.0));
            }
        }
        roles
    }

    /// Whether a joint follows another one and is not locked itself.
    fn follows(&self, k: usize) -> bool {
        let joint = &self.joints[k];
        joint.leader().is_some() && !self.options.lock.contains_key(&joint.name)
    }

    /// Role of a joint that follows no other.
    fn own(&mut self, k: usize, faults: &mut Faults) -> Role {
        let joint = &self.joints[k];
        let (name, kind) = (joint.name.clone(), joint.kind.clone());
        match joint.class() {
            Kind::Fixed => Role::Held(0.0),
            Kind::Free => {
                self.notes.push(DescriptionNote::Free {
                    joint: name,
                    kind,
                    is_base: joint.parent == self.root,
                });
                Role::Held(0.0)
            }
            Kind::Unknown => {
                faults.push(UrdfError::Kind { joint: name, kind });
                Role::Held(0.0)
            }
            Kind::Single if self.follows(k) => Role::Held(0.0),
            Kind::Single => joint.rests.or_else(|| self.chosen(joint)).map_or(Role::Moves, Role::Held),
        }
    }

    /// Position at which the choice holds a joint, if it does.
    fn chosen(&mut self, joint: &JointElement) -> Option<f64> {
        let [lower, upper] = joint.limits.position;
        let name = joint.name.clone();
        if let Some(at) = self.options.lock.get(&name).copied() {
            if at < lower || at > upper {
                self.notes.push(DescriptionNote::OutsideLimits { joint: name, at, limits: [lower, upper] });
            }
            return Some(at);
        }
        if self.options.joints.as_ref()?.contains(&name) {
            return None;
        }
        let at = 0.0_f64.min(upper).max(lower);
        if at != 0.0 {
            self.notes.push(DescriptionNote::AtLimit { joint: name, at });
        }
        Some(at)
    }

    /// The joint at the head of those that a joint follows, with ratio and offset; the name of one that does not exist.
    fn led(&self, k: usize) -> Result<Led<'d>, UrdfError> {
        let (mut at, mut ratio, mut offset) = (k, 1.0, 0.0);
        for _ in 0..=self.joints.len() {
            let Some((leader, multiplier, more)) = self.joints[at].leader().filter(|_| self.follows(at))
            else {
                return Ok(Led { leader: Ok(at), ratio, offset });
            };
            (ratio, offset) = (ratio * multiplier, ratio * more + offset);
            match self.numbers.get(leader.as_str()) {
                Some(leader) => at = *leader,
                None => return Ok(Led { leader: Err(leader), ratio, offset }),
            }
        }
        Err(UrdfError::Mimic(self.joints[k].name.clone()))
    }

    fn follower(&mut self, k: usize, led: Led, roles: &[Role]) -> Role {
        let Led { leader, ratio, offset } = led;
        let joint = self.joints[k].name.clone();
        match leader.map(|leader| (leader, roles[leader])) {
            Ok((_, Role::Held(at))) => Role::Held(ratio * at + offset),
            Ok((leader, _)) if self.options.followers == Followers::Move => {
                Role::Follows { leader, ratio, offset }
            }
            Ok((leader, _)) => self.held(&self.joints[leader].name, true, (joint, offset)),
            Err(leader) => self.held(leader, false, (joint, offset)),
        }
    }

    /// Role of a joint that is held still because it follows another one, with a note for all that follow that one.
    fn held(&mut self, leader: &str, is_there: bool, (joint, at): (String, f64)) -> Role {
        let others = self.notes.iter_mut().find_map(|note| match note {
            DescriptionNote::Followers { leader: other, joints, .. } if other == leader => Some(joints),
            _ => None,
        });
        let leader = leader.to_owned();
        match others {
            Some(joints) => joints.push((joint, at)),
            None => {
                self.notes.push(DescriptionNote::Followers { leader, is_there, joints: vec![(joint, at)] });
            }
        }
        Role::Held(at)
    }
}
