//! Joints of a body.

use super::Settings;
use super::body::Member;
use super::values::wrong;
use crate::tree::{Joint, Limits, Pose};
use crate::urdf::error::UrdfError;
use crate::urdf::parts::JointElement;
use nalgebra::{Unit, Vector3};

/// A joint whose pose is relative to its body.
pub(super) struct Anchored {
    /// The joint, without its links.
    pub joint: JointElement,
    /// Anchor of the joint in the body's frame, m.
    pub anchor: Vector3<f64>,
    /// Position at which the body is where the file has it (`ref`), rad or m.
    pub zero: f64,
    /// Whether the file gives it limits of 0.
    pub has_zero_limits: bool,
}

impl Settings<'_> {
    /// Reads the joint that is number `k` among all of MuJoCo's.
    pub fn joint(&self, member: &Member, k: usize) -> Result<Anchored, UrdfError> {
        let node = member.node;
        let kind = self.kind(member)?;
        let name = node.attribute("name").map_or_else(|| format!("joint {k}"), str::to_owned);
        let mut joint = JointElement::new(name, kind, node.range());
        if kind == "floating" {
            return Ok(Anchored { joint, anchor: Vector3::zeros(), zero: 0.0, has_zero_limits: false });
        }
        let numbers = |what| self.classes.numbers::<3>(node, member.class, what);
        let number = |what| Ok::<_, UrdfError>(self.classes.number(node, member.class, what)?.unwrap_or(0.0));
        let anchor = member.frame.rotation * Vector3::from(numbers("pos")?.unwrap_or_default());
        let anchor = member.frame.translation + anchor;
        joint.axis = member.frame.rotation * Vector3::from(numbers("axis")?.unwrap_or([0.0, 0.0, 1.0]));
        joint.armature = number("armature")?;
        let has_zero_limits;
        (joint.limits, has_zero_limits) = self.limits(member, kind)?;
        let zero = self.position(kind, number("ref")?);
        joint.pose =
            Pose { translation: anchor, ..Pose::identity() }.then(&turned_back(member, &joint, zero)?);
        Ok(Anchored { joint, anchor, zero, has_zero_limits })
    }

    /// Kind of a joint in the words of URDF.
    fn kind(&self, member: &Member) -> Result<&'static str, UrdfError> {
        if member.node.has_tag_name("freejoint") {
            return Ok("floating");
        }
        match self.classes.attribute(member.node, member.class, "type")?.unwrap_or("hinge") {
            "hinge" => Ok("revolute"),
            "slide" => Ok("prismatic"),
            "ball" => Ok("ball"),
            "free" => Ok("floating"),
            other => {
                Err(wrong(member.node, format!("type = {other:?}; hinge, slide, ball and free are known")))
            }
        }
    }

    /// Position of a joint, rad or m.
    fn position(&self, kind: &str, x: f64) -> f64 {
        if kind == "revolute" { self.compiler.angle(x) } else { x }
    }

    /// Limits of a joint, without those of 0, and whether there are such.
    fn limits(&self, member: &Member, kind: &str) -> Result<(Limits, bool), UrdfError> {
        let mut limits = Limits::none();
        let position = self.range(member, ["range", "limited"])?;
        let effort = self.range(member, ["actuatorfrcrange", "actuatorfrclimited"])?;
        if let Some(range) = position.filter(is_wide) {
            limits.position = range.map(|x| self.position(kind, x));
        }
        if let Some([low, high]) = effort.filter(is_wide) {
            limits.effort = low.abs().max(high.abs());
        }
        Ok((limits, [position, effort].contains(&Some([0.0; 2]))))
    }

    /// A range, if the file limits the joint to it. One without width is none, as in MuJoCo, unless the file insists on it.
    fn range(&self, member: &Member, [what, flag]: [&str; 2]) -> Result<Option<[f64; 2]>, UrdfError> {
        let (node, class) = (member.node, member.class);
        let range = self.classes.numbers::<2>(node, class, what)?;
        let flag = self.classes.attribute(node, class, flag)?;
        match (flag, range) {
            (Some("true"), Some(range @ [low, high])) if !is_wide(&range) && range != [0.0; 2] => Err(wrong(
                node,
                format!("{what} = \"{low} {high}\": its first number should be below its second"),
            )),
            (Some("false"), _) => Ok(None),
            (Some("true"), range) => Ok(range),
            (_, range) => Ok(range.filter(|_| self.compiler.autolimits)),
        }
    }
}

/// Whether something can move between the ends of a range.
fn is_wide([low, high]: &[f64; 2]) -> bool {
    low < high
}

/// Pose of a joint's frame at q = 0 relative to that at `zero`.
fn turned_back(member: &Member, joint: &JointElement, zero: f64) -> Result<Pose, UrdfError> {
    let none = || wrong(member.node, "axis: a vector without direction");
    let axis = Unit::try_new(joint.axis, 1e-14).ok_or_else(none)?;
    Ok(match joint.kind.as_str() {
        "revolute" if zero != 0.0 => Joint::Revolute(axis).pose(-zero),
        "prismatic" => Joint::Prismatic(axis).pose(-zero),
        _ => Pose::identity(),
    })
}
