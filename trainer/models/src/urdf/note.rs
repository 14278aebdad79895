//! Notes on a description that was read: what was changed, and what is not modelled.

use std::fmt;

/// A link, and the joint that moves it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Moved {
    /// Name of the link.
    pub link: String,
    /// Name of the joint.
    pub joint: String,
}

impl fmt::Display for Moved {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "link {}, moved by joint {}", self.link, self.joint)
    }
}

/// A note on a description. Bodies are named by the link that their joint moves; links fixed to it are part of them.
#[derive(Clone, Debug, PartialEq)]
pub enum DescriptionNote {
    /// An inertia that no body has was changed to the nearest one that a body can have.
    Inertia {
        /// The body.
        body: Moved,
        /// Principal moments about the centre of mass in the description, kg m².
        before: [f64; 3],
        /// Principal moments now, kg m².
        after: [f64; 3],
        /// Relative change of the inertia about the centre of mass.
        change: f64,
    },
    /// A body that is infinitely thin in some direction was thickened.
    Thin {
        /// The body.
        body: Moved,
        /// Relative change of the inertia about the centre of mass.
        change: f64,
    },
    /// A mass without extent became a ball.
    Extent {
        /// The body.
        body: Moved,
        /// Mass, kg.
        mass: f64,
        /// Radius of the ball, m.
        radius: f64,
    },
    /// A body has no mass, but one that it carries has.
    Massless {
        /// The body.
        body: Moved,
        /// Mass of the bodies that it carries, kg.
        carried: f64,
    },
    /// Part of an MJCF file that acts on the robot is not read.
    NotRead {
        /// The part, in words.
        what: String,
    },
    /// A link with a mass below 0 is part of a body of positive mass.
    NegativeMass {
        /// Name of the link.
        link: String,
        /// Mass as written, kg.
        mass: f64,
        /// The body.
        body: Moved,
        /// Mass of the body, kg.
        total: f64,
    },
    /// A joint that is held still cannot be at 0, and is held at its nearest limit.
    AtLimit {
        /// Name of the joint.
        joint: String,
        /// Position at which it is held, rad or m.
        at: f64,
    },
    /// A joint is held still outside its limits.
    OutsideLimits {
        /// Name of the joint.
        joint: String,
        /// Position at which it is held, rad or m.
        at: f64,
        /// Limits of the joint, rad or m.
        limits: [f64; 2],
    },
    /// Joints that could not move between their limits of 0, which are taken as not given.
    ZeroLimits {
        /// Names of the joints.
        joints: Vec<String>,
    },
    /// Joints that follow another one are held still.
    Followers {
        /// Name of the joint that they follow.
        leader: String,
        /// Whether there is such a joint.
        is_there: bool,
        /// Names of the joints, each with the position at which it is held, rad or m.
        joints: Vec<(String, f64)>,
    },
    /// A joint without a single coordinate is held still.
    Free {
        /// Name of the joint.
        joint: String,
        /// Kind as written.
        kind: String,
        /// Whether it carries the whole robot.
        is_base: bool,
    },
}

/// Relative change of an inertia above which its description is wrong beyond rounding and estimation.
pub const GROSS: f64 = 0.05;

impl fmt::Display for DescriptionNote {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Inertia { body, before, after, change } => write!(
                f,
                "{body}: {}no body has its moments of inertia about the centre of mass, {} kg m² (one is negative, or \
                 larger than the sum of the others); the model has the nearest that can be, {} kg m², a change of {}{}",
                if *change > GROSS { "GROSSLY WRONG INERTIA: " } else { "" },
                moments(before),
                moments(after),
                percent(*change),
                if *change > GROSS { "; correct the description" } else { "" },
            ),
            Self::Thin { body, change } => write!(
                f,
                "{body}: it is infinitely thin in some direction, so it was thickened, which changes its moments of \
                 inertia by {}",
                percent(*change)
            ),
            Self::Extent { body, mass, radius } => write!(
                f,
                "{body}: its {} kg have no extent (all moments of inertia about the centre of mass are 0), so a ball with \
                 a radius of {radius} m is guessed ([model] radius); give it an inertia to have another",
                short(*mass)
            ),
            Self::Massless { body, carried } => write!(
                f,
                "{body}: it has no mass, and none is given to it, nor learned; the bodies that it carries have {} kg",
                short(*carried)
            ),
            Self::NotRead { what } => write!(f, "NOT READ, and not part of the model: {what}"),
            Self::NegativeMass { link, mass, body, total } => write!(
                f,
                "link {link}: its mass is {mass} kg; together with the links fixed to it ({body}) it has {} kg",
                short(*total)
            ),
            Self::AtLimit { joint, at } => {
                write!(
                    f,
                    "joint {joint} is held still at {at}, its limit next to 0; lock sets another position"
                )
            }
            Self::OutsideLimits { joint, at, limits: [lower, upper] } => {
                write!(f, "joint {joint} is held still at {at}, outside its limits of {lower} to {upper}")
            }
            Self::ZeroLimits { joints } => write!(
                f,
                "limits of 0 (position, velocity or effort) are taken as not given: {}",
                joints.join(", ")
            ),
            Self::Followers { leader, is_there, joints } => write!(
                f,
                "joint {leader} {} (<mimic>); these are HELD STILL, and their motion is not modelled: {}; lock sets \
                 other positions",
                if *is_there {
                    "moves, and others follow it"
                } else {
                    "does not exist, but others follow it"
                },
                positions(joints)
            ),
            Self::Free { joint, kind, is_base: true } => {
                write!(f, "joint {joint} is {kind}: what it carries is taken as fixed to the base")
            }
            Self::Free { joint, kind, .. } => write!(
                f,
                "joint {joint} is {kind}, which no single coordinate describes: it is HELD STILL, and its motion is not \
                 modelled"
            ),
        }
    }
}

fn positions(joints: &[(String, f64)]) -> String {
    joints.iter().map(|(joint, at)| format!("{joint} at {at}")).collect::<Vec<_>>().join(", ")
}

fn moments(values: &[f64; 3]) -> String {
    let [a, b, c] = values.map(short);
    format!("{a}, {b} and {c}")
}

fn percent(part: f64) -> String {
    let percent = (1e4 * part).round() / 1e2;
    if percent == 0.0 { "less than 0.01 %".to_owned() } else { format!("{} %", short(percent)) }
}

/// A number with four significant digits.
fn short(x: f64) -> String {
    let rounded = format!("{x:.3e}");
    if (1e-4..1e6).contains(&x.abs()) {
        rounded.parse().map_or(rounded, |x: f64| x.to_string())
    } else {
        rounded
    }
}
