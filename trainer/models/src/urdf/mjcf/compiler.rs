//! Settings of the compiler, and gravity.

use super::values::{self, wrong};
use crate::tree::Inertia;
use crate::urdf::error::UrdfError;
use crate::urdf::parts::Link;
use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use roxmltree::Node;

/// Source of the inertia of a body.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum FromGeoms {
    /// Geoms count for bodies without `<inertial>`.
    Auto,
    Always,
    Never,
}

/// `<compiler>`.
pub(super) struct Compiler {
    pub is_degrees: bool,
    /// Axes of Euler angles, from 0, and whether each turn is about the axes that the turns before it have moved.
    pub euler: [(usize, bool); 3],
    pub autolimits: bool,
    pub from_geoms: FromGeoms,
    pub groups: [f64; 2],
    balances: bool,
    least_mass: f64,
    least_inertia: f64,
    total_mass: f64,
}

impl Compiler {
    pub fn read(root: Node) -> Result<Self, UrdfError> {
        let of = |what: &str| attribute(root, "compiler", what);
        if let Some((node, "global")) = of("coordinate") {
            return Err(wrong(
                node,
                "coordinate = \"global\" is not read, nor by MuJoCo since 2.3.3; use local",
            ));
        }
        let number = |what| of(what).map_or(Ok(0.0), |(node, text)| single(node, what, text));
        Ok(Self {
            is_degrees: of("angle").is_none_or(|(_, angle)| angle != "radian"),
            euler: of("eulerseq")
                .map_or(Ok([0, 1, 2].map(|k| (k, true))), |(node, text)| sequence(node, text))?,
            autolimits: of("autolimits").is_none_or(|(_, value)| value != "false"),
            from_geoms: match of("inertiafromgeom").map(|(_, value)| value) {
                Some("true") => FromGeoms::Always,
                Some("false") => FromGeoms::Never,
                _ => FromGeoms::Auto,
            },
            groups: match of("inertiagrouprange") {
                Some((node, text)) => values::exactly(node, ("inertiagrouprange", text))?,
                None => [0.0, f64::INFINITY],
            },
            balances: of("balanceinertia").is_some_and(|(_, value)| value == "true"),
            least_mass: number("boundmass")?,
            least_inertia: number("boundinertia")?,
            total_mass: if of("settotalmass").is_some() { number("settotalmass")? } else { -1.0 },
        })
    }

    /// Angle in rad.
    pub fn angle(&self, angle: f64) -> f64 {
        if self.is_degrees { angle.to_radians() } else { angle }
    }

    /// Whether masses and inertias can be other than those of `<inertial>`.
    pub fn changes_inertials(&self) -> bool {
        let bounds = self.balances || self.least_mass > 0.0 || self.least_inertia > 0.0;
        bounds || self.total_mass > 0.0 || self.from_geoms == FromGeoms::Always
    }

    /// Inertia within the bounds, and balanced if that is asked for.
    pub fn bounded(&self, given: Inertia) -> Inertia {
        let is_free = !self.balances && self.least_inertia <= 0.0;
        if is_free && given.mass() >= self.least_mass {
            return given;
        }
        let own = SymmetricEigen::new(given.about_centre());
        let mut moments = own.eigenvalues.map(|moment| moment.max(self.least_inertia));
        if self.balances && moments.sum() < 2.0 * moments.max() {
            moments = Vector3::repeat(moments.mean());
        }
        let turned = own.eigenvectors * Matrix3::from_diagonal(&moments) * own.eigenvectors.transpose();
        Inertia::of_centre(given.mass().max(self.least_mass), given.centre(), turned)
    }

    /// Scales all bodies to the total mass, if one is set.
    pub fn scale(&self, links: &mut [Link]) {
        let all: f64 = links.iter().map(|link| link.inertia.mass()).sum();
        if self.total_mass > 0.0 && all > 0.0 {
            let factor = self.total_mass / all;
            links.iter_mut().for_each(|link| link.inertia = Inertia(link.inertia.0.map(|x| factor * x)));
        }
    }
}

/// Gravity in the base frame, m/s².
pub(in crate::urdf) fn gravity(root: Node) -> Result<Vector3<f64>, UrdfError> {
    let flag = root.descendants().filter(|node| node.has_tag_name("flag"));
    if flag.filter_map(|node| node.attribute("gravity")).any(|value| value == "disable") {
        return Ok(Vector3::zeros());
    }
    let given = attribute(root, "option", "gravity");
    let given = given.map(|(node, text)| values::exactly(node, ("gravity", text))).transpose()?;
    Ok(given.unwrap_or([0.0, 0.0, -9.81]).into())
}

/// Last value of an attribute of the elements of a name.
fn attribute<'a, 'i>(root: Node<'a, 'i>, tag: &str, what: &str) -> Option<(Node<'a, 'i>, &'a str)> {
    let all = root.children().filter(|node| node.has_tag_name(tag));
    all.filter_map(|node| Some((node, node.attribute(what)?))).next_back()
}

fn single(node: Node, what: &str, text: &str) -> Result<f64, UrdfError> {
    values::exactly(node, (what, text)).map(|[x]| x)
}

fn sequence(node: Node, text: &str) -> Result<[(usize, bool); 3], UrdfError> {
    let axis = |letter: char| {
        let k = "xyz".find(letter.to_ascii_lowercase())?;
        Some((k, letter.is_ascii_lowercase()))
    };
    let axes: Option<Vec<(usize, bool)>> = text.chars().map(axis).collect();
    let axes = axes.and_then(|axes| axes.first_chunk().copied().filter(|_| axes.len() == 3));
    axes.ok_or_else(|| {
        wrong(node, format!("eulerseq = {text:?} should be three of the letters x, y, z, X, Y, Z"))
    })
}
