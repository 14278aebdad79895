//! Poses of elements.

use super::Settings;
use super::values::wrong;
use crate::tree::Pose;
use crate::urdf::error::UrdfError;
use nalgebra::{Matrix3, Quaternion, Rotation3, Unit, UnitQuaternion, Vector3};
use roxmltree::Node;

/// Ways to give an orientation.
const WAYS: [&str; 5] = ["quat", "axisangle", "xyaxes", "zaxis", "euler"];
/// Length below which a vector has no direction.
const NO_LENGTH: f64 = 1e-14;

impl Settings<'_> {
    /// Pose of an element in the frame around it.
    pub fn pose(&self, node: Node, class: Option<&str>) -> Result<Pose, UrdfError> {
        let position = self.classes.numbers::<3>(node, class, "pos")?.unwrap_or_default();
        Ok(Pose { rotation: self.rotation(node, class)?, translation: position.into() })
    }

    fn rotation(&self, node: Node, class: Option<&str>) -> Result<Matrix3<f64>, UrdfError> {
        let own: Vec<&str> = WAYS.into_iter().filter(|way| node.has_attribute(*way)).collect();
        if let [first, second, ..] = own[..] {
            return Err(wrong(node, format!("has both {first} and {second}; one orientation is enough")));
        }
        for way in if own.is_empty() { WAYS.to_vec() } else { own } {
            if self.classes.attribute(node, class, way)?.is_some() {
                return self.turned(node, class, way);
            }
        }
        Ok(Matrix3::identity())
    }

    fn turned(&self, node: Node, class: Option<&str>, way: &str) -> Result<Matrix3<f64>, UrdfError> {
        let zero = || wrong(node, format!("{way}: a vector without direction"));
        let direction = |x: [f64; 3]| Unit::try_new(Vector3::from(x), NO_LENGTH).ok_or_else(zero);
        let rotation = match way {
            "quat" => {
                let [w, x, y, z] = self.classes.numbers(node, class, way)?.unwrap_or([1.0, 0.0, 0.0, 0.0]);
                let turn =
                    UnitQuaternion::try_new(Quaternion::new(w, x, y, z), NO_LENGTH).ok_or_else(zero)?;
                turn.to_rotation_matrix()
            }
            "axisangle" => {
                let [x, y, z, angle] = self.classes.numbers(node, class, way)?.unwrap_or_default();
                Rotation3::from_axis_angle(&direction([x, y, z])?, self.compiler.angle(angle))
            }
            "xyaxes" => {
                let [a, b, c, d, e, f] = self.classes.numbers(node, class, way)?.unwrap_or_default();
                let x = direction([a, b, c])?;
                let y = Vector3::new(d, e, f);
                let y = direction((y - x.scale(x.dot(&y))).into())?;
                return Ok(Matrix3::from_columns(&[*x, *y, x.cross(&y)]));
            }
            "zaxis" => {
                return Ok(to_z(&direction(self.classes.numbers(node, class, way)?.unwrap_or_default())?));
            }
            _ => self.of_euler(self.classes.numbers(node, class, way)?.unwrap_or_default()),
        };
        Ok(rotation.into_inner())
    }

    fn of_euler(&self, angles: [f64; 3]) -> Rotation3<f64> {
        let axes = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
        let turns = self.compiler.euler.iter().zip(angles);
        turns.fold(Rotation3::identity(), |all, ((axis, moves), angle)| {
            let one = Rotation3::from_axis_angle(&axes[*axis], self.compiler.angle(angle));
            if *moves { all * one } else { one * all }
        })
    }
}

/// Least rotation that takes the z axis to a direction; half a turn about x if it is opposite.
pub(super) fn to_z(direction: &Unit<Vector3<f64>>) -> Matrix3<f64> {
    let half = || Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
    Rotation3::rotation_between(&Vector3::z(), direction).unwrap_or_else(half).into_inner()
}
