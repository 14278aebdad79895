//! Masses and inertias of geoms.

use super::Settings;
use super::body::Member;
use super::pose::to_z;
use super::values::{self, name, wrong};
use crate::tree::{Inertia, Pose};
use crate::urdf::error::UrdfError;
use nalgebra::{Matrix3, Unit, Vector3};
use std::f64::consts::PI;

/// Density of a geom without one, kg/m³.
const WATER: f64 = 1000.0;

/// Volume of a shape, m³, and mean squares of its points' coordinates along its axes, m².
type Shape = (f64, [f64; 3]);

impl Settings<'_> {
    /// Inertia of a geom in the frame of its body, or the reason why it is not known.
    pub fn geom(&self, member: &Member) -> Result<Result<Inertia, String>, UrdfError> {
        let (node, class) = (member.node, member.class);
        let number = |what| self.classes.number(node, class, what);
        let group = number("group")?.unwrap_or(0.0);
        let [mass, density] = [number("mass")?, number("density")?];
        let kind = self.classes.attribute(node, class, "type")?.unwrap_or("sphere");
        let is_counted = (self.compiler.groups[0]..=self.compiler.groups[1]).contains(&group);
        if !is_counted || ["plane", "hfield"].contains(&kind) || mass.or(density) == Some(0.0) {
            return Ok(Ok(Inertia::default()));
        }
        if let Some(reason) = self.unknown(member, kind)? {
            return Ok(Err(reason));
        }
        let (sizes, pose) = self.placed_sizes(member, kind)?;
        let (volume, squares) =
            shape(kind, sizes).ok_or_else(|| wrong(node, format!("type = {kind:?} is not known")))?;
        let pose = member.frame.then(&pose);
        let own = solid(mass.unwrap_or(density.unwrap_or(WATER) * volume), squares);
        Ok(Ok(own.placed(&pose.rotation, &pose.translation)))
    }

    /// Reason why the inertia of a geom is not known.
    fn unknown(&self, member: &Member, kind: &str) -> Result<Option<String>, UrdfError> {
        let (node, whose) = (member.node, name(member.node));
        let attribute = |what| self.classes.attribute(node, member.class, what);
        if ["mesh", "sdf"].contains(&kind) || attribute("mesh")?.is_some() {
            return Ok(Some(format!(
                "its geom {whose} is a mesh, whose volume is not read; give the body an <inertial>"
            )));
        }
        let is_shell = attribute("shellinertia")? == Some("true");
        Ok(is_shell.then(|| format!("its geom {whose} is a shell; give the body an <inertial>")))
    }

    /// Sizes and pose of a geom; the ends of `fromto` give its length and its z axis.
    fn placed_sizes(&self, member: &Member, kind: &str) -> Result<([f64; 3], Pose), UrdfError> {
        let (node, class) = (member.node, member.class);
        let ends = self.classes.numbers::<6>(node, class, "fromto")?;
        let text = self.classes.attribute(node, class, "size")?.unwrap_or_default();
        let given = values::numbers(node, ("size", text), 0..=3)?;
        let mut sizes: [f64; 3] = std::array::from_fn(|k| given.get(k).copied().unwrap_or(0.0));
        let Some([a, b, c, d, e, f]) = ends else {
            self.check(member, kind, &sizes)?;
            return Ok((sizes, self.pose(node, class)?));
        };
        let (from, to) = (Vector3::new(a, b, c), Vector3::new(d, e, f));
        let (axis, length) = Unit::try_new_and_get(from - to, 1e-14)
            .ok_or_else(|| wrong(node, "fromto: both ends are the same point"))?;
        // MuJoCo makes the shapes of `fromto` round, whatever other sizes are given.
        sizes = if ["capsule", "cylinder"].contains(&kind) {
            [sizes[0], length / 2.0, 0.0]
        } else {
            [sizes[0], sizes[0], length / 2.0]
        };
        self.check(member, kind, &sizes)?;
        Ok((sizes, Pose { rotation: to_z(&axis), translation: (from + to) / 2.0 }))
    }

    fn check(&self, member: &Member, kind: &str, sizes: &[f64; 3]) -> Result<(), UrdfError> {
        let needed = match kind {
            "sphere" => 1,
            "capsule" | "cylinder" => 2,
            _ => 3,
        };
        if sizes[..needed].iter().all(|size| *size > 0.0) {
            return Ok(());
        }
        Err(wrong(member.node, format!("size: a {kind} needs {needed} number(s) above 0")))
    }
}

/// Inertia of a mass about its centre; `squares` are the mean squares of its points' coordinates, m².
fn solid(mass: f64, squares: [f64; 3]) -> Inertia {
    let squares = Vector3::from(squares) * mass;
    let inertia = Matrix3::from_diagonal(&squares.map(|x| squares.sum() - x));
    Inertia::of_centre(mass, Vector3::zeros(), inertia)
}

fn shape(kind: &str, [a, b, c]: [f64; 3]) -> Option<Shape> {
    let ball = |[a, b, c]: [f64; 3]| (4.0 / 3.0 * PI * a * b * c, [a, b, c].map(|x| x * x / 5.0));
    let (tube, round) = (2.0 * PI * a * a * b, a * a / 4.0);
    Some(match kind {
        "sphere" => ball([a; 3]),
        "ellipsoid" => ball([a, b, c]),
        "box" => (8.0 * a * b * c, [a, b, c].map(|x| x * x / 3.0)),
        "cylinder" => (tube, [round, round, b * b / 3.0]),
        "capsule" => {
            let (caps, [across, ..]) = ball([a; 3]);
            let volume = tube + caps;
            let mean = |of_tube: f64, of_caps: f64| (tube * of_tube + caps * of_caps) / volume;
            let along = mean(b * b / 3.0, b * b + 0.75 * b * a + across);
            (volume, [mean(round, across), mean(round, across), along])
        }
        _ => return None,
    })
}
