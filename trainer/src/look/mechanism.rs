//! Choice of a mechanism with few joints whose motion resembles that in the logs.

use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt::{self, Write};

/// Largest number of joints that are tried: arms with more joints are seldom planar.
pub const MOST_JOINTS: usize = 3;

/// A chain of bodies in a vertical plane, each on a link or a slide.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mechanism(Vec<Joint>);

/// Joint between a body and the body before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Joint {
    /// A revolute joint. At q = 0 the body hangs down, or continues the line of the link before it.
    Link,
    /// A prismatic joint. The first slide on the ground is horizontal, a slide on it vertical; a slide on a link is
    /// along the link.
    Slide {
        /// Whether it slides in the opposite direction.
        back: bool,
    },
}

const JOINTS: [Joint; 3] = [Joint::Link, Joint::Slide { back: false }, Joint::Slide { back: true }];

/// A body with its place in a mechanism.
struct Body {
    joint: Joint,
    /// Direction, relative to the hanging frame or to the previous link, rad.
    direction: f64,
    /// Direction of the previous body, rad.
    before: f64,
    /// Whether some earlier body turns.
    on_link: bool,
    /// Whether the body directly before turns.
    next_to_link: bool,
}

impl Mechanism {
    /// A chain of links.
    pub fn links(n: usize) -> Self {
        Self(vec![Joint::Link; n])
    }

    /// A body that slides level.
    pub fn slide() -> Self {
        Self(vec![Joint::Slide { back: false }])
    }

    /// All mechanisms with n joints; the chain of links comes first. For a single slide only one direction is listed,
    /// since both give the same motion.
    pub fn all(n: usize) -> Vec<Self> {
        let joints = (0..n).fold(vec![Vec::new()], |all: Vec<Vec<Joint>>, _| {
            let with = |before: Vec<Joint>| JOINTS.map(|joint| [before.clone(), vec![joint]].concat());
            all.into_iter().flat_map(with).collect()
        });
        joints.into_iter().map(Self).filter(|own| own.bodies().is_some()).collect()
    }

    /// Whether all joints with angles turn.
    pub fn turns_where(&self, angles: &[bool]) -> bool {
        self.0.iter().zip(angles).all(|(joint, is_angle)| *joint == Joint::Link || !is_angle)
    }

    /// Bodies; `None` if slides are parallel, or if the mechanism is equivalent to another one in [`Mechanism::all`].
    fn bodies(&self) -> Option<Vec<Body>> {
        let (mut bodies, mut slides, mut on_link, mut before) = (Vec::new(), 0, false, 0.0);
        for (i, joint) in self.0.iter().copied().enumerate() {
            let direction = match joint {
                Joint::Link => 0.0,
                Joint::Slide { back } => {
                    let level = !on_link && slides == 0;
                    let most = if on_link { 1 } else { 2 };
                    if slides == most || back && level && self.0.len() == 1 {
                        return None;
                    }
                    slides += 1;
                    match (level, back) {
                        (true, false) => FRAC_PI_2,
                        (true, true) => -FRAC_PI_2,
                        (false, false) => 0.0,
                        (false, true) => PI,
                    }
                }
            };
            let next_to_link = i > 0 && self.0[i - 1] == Joint::Link;
            bodies.push(Body { joint, direction, before, on_link, next_to_link });
            before = direction;
            if joint == Joint::Link {
                (slides, on_link) = (0, true);
            }
        }
        Some(bodies)
    }

    /// The tables of `[model]` for this mechanism: the part before friction, and the part after it. Where servos drive it, the mass of its
    /// last body is the scale of all numbers.
    pub fn tables(&self, has_servos: bool) -> [String; 2] {
        let n = self.0.len();
        let head = "family = \"bodies\" # others: leastaction train --print-defaults inertia-network, modular or graph\n";
        if !has_servos && self.0.iter().all(|joint| *joint == Joint::Link) {
            let comment = "# links on revolute joints in an upright plane; q = 0 hangs, each q relative to the link before";
            return [format!("\n[model] {comment}\n{head}chain = {n}\n"), String::new()];
        }
        let mut bodies = String::new();
        for (i, body) in self.bodies().into_iter().flatten().enumerate() {
            // Writing to a string does not fail.
            let _ = write!(bodies, "\n[[model.bodies]]{}", body.keys(i));
        }
        if has_servos {
            bodies.push_str(
                "mass = 1.0 # kg: weigh it; all masses, friction and stiffnesses are in proportion to it\n",
            );
        }
        [format!("\n[model] # {self}, in an upright plane\n{head}"), bodies]
    }
}

impl Body {
    /// Keys of the i-th body.
    fn keys(&self, i: usize) -> String {
        let slides = self.joint != Joint::Link;
        let mut keys = match self.joint {
            Joint::Link if i == 0 => " # a link; q = 0 hangs\n".to_owned(),
            Joint::Link => " # a link on it\n".to_owned(),
            Joint::Slide { .. } if i == 0 => " # a slide on a level rail\njoint = \"prismatic\"\n".to_owned(),
            Joint::Slide { .. } => " # a slide on it\njoint = \"prismatic\"\n".to_owned(),
        };
        let mut add = |key: fmt::Arguments<'_>| {
            let _ = writeln!(keys, "{key}");
        };
        if i > 0 {
            add(format_args!("on = {}", i - 1));
        }
        let angle = self.direction - self.before;
        if angle != 0.0 {
            add(format_args!("angle = {angle}"));
        }
        if self.next_to_link && !slides {
            add(format_args!("at = [\"learned\", 0.0]"));
        }
        match (slides, self.on_link) {
            // For a body that never turns, motion shows only its mass.
            (true, false) => add(format_args!("centre = [0.0, 0.0]\ninertia = 1.0")),
            (false, true) => add(format_args!("rotor = \"learned\"\ngear = 10.0")),
            _ => (),
        }
        keys
    }
}

impl fmt::Display for Mechanism {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let name = |joint: &Joint| if *joint == Joint::Link { "a link" } else { "a slide" };
        let names: Vec<&str> = self.0.iter().map(name).collect();
        let on = if names.len() > 1 { " each on the one before" } else { "" };
        match names.split_last() {
            Some((last, [])) => f.write_str(last),
            Some((last, before)) => write!(f, "{} and {last},{on}", before.join(", ")),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mechanisms_are_told_apart_once() {
        assert_eq!(Mechanism::all(1).len(), 2);
        // These are two links; a link and a slide, outwards or inwards; a slide and a link, or a vertical slide, each
        // in both directions.
        assert_eq!(Mechanism::all(2).len(), 9);
        assert_eq!(Mechanism::all(2)[0], Mechanism::links(2));
        let mut all: Vec<String> = Mechanism::all(3).iter().map(|own| own.tables(false).concat()).collect();
        let count = all.len();
        all.sort();
        all.dedup();
        assert_eq!(all.len(), count);
    }

    #[test]
    fn a_cart_with_a_pole_hangs_from_a_level_rail() {
        let cart = Mechanism(vec![Joint::Slide { back: false }, Joint::Link]);
        let [head, bodies] = cart.tables(false);
        assert!(
            head.starts_with("\n[model] # a slide and a link, each on the one before, in an upright plane\n")
        );
        assert_eq!(
            bodies,
            "\n[[model.bodies]] # a slide on a level rail\njoint = \"prismatic\"\nangle = 1.5707963267948966\ncentre = [0.0, 0.0]\n\
             inertia = 1.0\n\n[[model.bodies]] # a link on it\non = 0\nangle = -1.5707963267948966\n"
        );
    }
}
