//! Links and joints as written in the file.

use super::error::UrdfError;
use super::zero_limits::without_zeros;
use crate::tree::{Inertia, Limits, Pose};
use nalgebra::{Matrix3, Vector3};
use roxmltree::Node;
use std::ops::Range;

/// A link.
pub(super) struct Link {
    pub name: String,
    /// Inertial numbers; zeros without an `<inertial>`.
    pub inertia: Inertia,
    pub has_inertial: bool,
    /// Reason why the inertia is not known, in words.
    pub unknown: Option<String>,
    /// Place of its element in the text; empty for a link that has none.
    pub at: Range<usize>,
    /// Position of the link's frame in the frame of its element, m.
    pub origin: Vector3<f64>,
}

/// A joint.
pub(super) struct JointElement {
    pub name: String,
    pub kind: String,
    pub parent: String,
    pub child: String,
    pub pose: Pose,
    pub axis: Vector3<f64>,
    pub limits: Limits,
    /// Name of the joint that it follows, with multiplier and offset.
    pub mimic: Option<(String, f64, f64)>,
    /// Position at which a constraint holds it, rad or m.
    pub rests: Option<f64>,
    /// Inertia of its rotor, kg m² or kg.
    pub armature: f64,
    /// Place of its element in the text.
    pub at: Range<usize>,
}

/// An element with its name in messages.
struct Element<'a, 'i> {
    node: Node<'a, 'i>,
    at: String,
}

impl<'a, 'i> Element<'a, 'i> {
    /// Reads the name of a link or joint.
    fn named(node: Node<'a, 'i>) -> Result<(Self, String), UrdfError> {
        let kind = node.tag_name().name();
        let missing = || UrdfError::Missing { at: format!("a {kind}"), what: "its name" };
        let name = node.attribute("name").ok_or_else(missing)?.to_owned();
        Ok((Self { node, at: format!("{kind} {name}") }, name))
    }

    fn child(&self, name: &str) -> Option<Self> {
        let node = self.node.children().find(|node| node.has_tag_name(name))?;
        Some(Self { node, at: self.at.clone() })
    }

    fn needed(&self, name: &'static str) -> Result<Self, UrdfError> {
        self.child(name).ok_or_else(|| self.missing(name))
    }

    fn missing(&self, what: &'static str) -> UrdfError {
        UrdfError::Missing { at: self.at.clone(), what }
    }

    fn text(&self, what: &'static str) -> Result<String, UrdfError> {
        self.node.attribute(what).map(str::to_owned).ok_or_else(|| self.missing(what))
    }

    /// Reads N numbers; `None` if the attribute is missing.
    fn numbers<const N: usize>(&self, what: &'static str) -> Result<Option<[f64; N]>, UrdfError> {
        let Some(text) = self.node.attribute(what) else { return Ok(None) };
        let wrong = || UrdfError::Number {
            at: self.at.clone(),
            what,
            found: text.chars().take(60).collect(),
            expected: N,
        };
        let mut numbers = [0.0; N];
        let mut words = text.split_whitespace();
        for number in &mut numbers {
            let word = words.next().ok_or_else(wrong)?;
            *number = word.parse().ok().filter(|x: &f64| x.is_finite()).ok_or_else(wrong)?;
        }
        if words.next().is_none() { Ok(Some(numbers)) } else { Err(wrong()) }
    }

    fn number(&self, what: &'static str) -> Result<Option<f64>, UrdfError> {
        Ok(self.numbers(what)?.map(|[x]| x))
    }

    fn needed_number(&self, what: &'static str) -> Result<f64, UrdfError> {
        self.number(what)?.ok_or_else(|| self.missing(what))
    }

    /// Reads the pose of its `<origin>`.
    fn pose(&self) -> Result<Pose, UrdfError> {
        let Some(origin) = self.child("origin") else { return Ok(Pose::identity()) };
        let of = |what| Ok::<_, UrdfError>(origin.numbers(what)?.unwrap_or_default());
        Ok(Pose::of_rpy(of("xyz")?, of("rpy")?))
    }
}

impl Link {
    pub fn read(node: Node) -> Result<Self, UrdfError> {
        let (element, name) = Element::named(node)?;
        let inertial = element.child("inertial");
        let inertia = inertial.as_ref().map(Self::inertia).transpose()?;
        let has_inertial = inertial.is_some();
        Ok(Self { has_inertial, inertia: inertia.unwrap_or_default(), ..Self::empty(&name, node.range()) })
    }

    /// Creates a link without mass.
    pub fn empty(name: &str, at: Range<usize>) -> Self {
        let (inertia, origin) = (Inertia::default(), Vector3::zeros());
        Self { name: name.to_owned(), inertia, has_inertial: false, unknown: None, at, origin }
    }

    /// Returns the link in a frame whose position in the present one is `origin`.
    pub fn seen_from(self, origin: Vector3<f64>) -> Self {
        Self { inertia: self.inertia.placed(&Matrix3::identity(), &-origin), origin, ..self }
    }

    fn inertia(inertial: &Element) -> Result<Inertia, UrdfError> {
        let mass = inertial.needed("mass")?.needed_number("value")?;
        let entries = inertial.needed("inertia")?;
        let of = |what| entries.needed_number(what);
        let (xx, xy, xz) = (of("ixx")?, of("ixy")?, of("ixz")?);
        let (yy, yz, zz) = (of("iyy")?, of("iyz")?, of("izz")?);
        let about_centre = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        let pose = inertial.pose()?;
        let own = Inertia::of_centre(mass, Vector3::zeros(), about_centre);
        Ok(own.placed(&pose.rotation, &pose.translation))
    }
}

impl JointElement {
    pub fn read(node: Node) -> Result<Self, UrdfError> {
        let (element, name) = Element::named(node)?;
        let kind = element.text("type")?;
        let axis = element.child("axis").map(|axis| axis.numbers("xyz")).transpose()?.flatten();
        let mimic = element.child("mimic").map(|mimic| {
            let of = |what, usual| Ok::<_, UrdfError>(mimic.number(what)?.unwrap_or(usual));
            Ok::<_, UrdfError>((mimic.text("joint")?, of("multiplier", 1.0)?, of("offset", 0.0)?))
        });
        Ok(Self {
            parent: element.needed("parent")?.text("link")?,
            child: element.needed("child")?.text("link")?,
            pose: element.pose()?,
            axis: Vector3::from(axis.unwrap_or([1.0, 0.0, 0.0])),
            limits: Self::limits(&element, &kind)?,
            mimic: mimic.transpose()?,
            ..Self::new(name, &kind, node.range())
        })
    }

    /// Creates a joint without links, in the frame of what carries it.
    pub fn new(name: String, kind: &str, at: Range<usize>) -> Self {
        Self {
            name,
            kind: kind.to_owned(),
            parent: String::new(),
            child: String::new(),
            pose: Pose::identity(),
            axis: Vector3::x(),
            limits: Limits::none(),
            mimic: None,
            rests: None,
            armature: 0.0,
            at,
        }
    }

    /// Creates a fixed joint, named by the link that it carries.
    pub fn fixed([parent, child]: [&str; 2], pose: Pose) -> Self {
        let own = Self::new(format!("{child} (fixed)"), "fixed", 0..0);
        Self { parent: parent.to_owned(), child: child.to_owned(), pose, ..own }
    }

    fn limits(element: &Element, kind: &str) -> Result<Limits, UrdfError> {
        let Some(limit) = element.child("limit") else { return Ok(Limits::none()) };
        let none = f64::INFINITY;
        let lower = limit.number("lower")?;
        let upper = limit.number("upper")?;
        // If only one of the limits is given, the other is 0.
        let position = match (kind, lower, upper) {
            ("continuous", ..) | (_, None, None) => [-none, none],
            (_, lower, upper) => [lower.unwrap_or(0.0), upper.unwrap_or(0.0)],
        };
        let of = |what| Ok::<_, UrdfError>(limit.number(what)?.unwrap_or(none));
        Ok(without_zeros(Limits { position, velocity: of("velocity")?, effort: of("effort")? }))
    }
}
