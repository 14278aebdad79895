//! Numbers and names as text.

use crate::tree::Inertia;
use nalgebra::Matrix3;

/// Numbers with all their digits, separated by blanks.
pub(super) fn numbers<'x>(values: impl IntoIterator<Item = &'x f64>) -> String {
    values.into_iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(" ")
}

/// Text inside an attribute.
pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

/// `<inertial>` of MJCF.
pub(super) fn inertial_of_mjcf(inertia: &Inertia) -> String {
    let [xx, xy, yy, xz, yz, zz] = moments(inertia);
    format!(
        "<inertial pos=\"{}\" mass=\"{:?}\" fullinertia=\"{}\"/>",
        numbers(&inertia.centre()),
        inertia.mass(),
        numbers(&[xx, yy, zz, xy, xz, yz])
    )
}

/// `<inertial>` of URDF.
pub(super) fn inertial_of_urdf(inertia: &Inertia) -> String {
    let [xx, xy, yy, xz, yz, zz] = moments(inertia);
    format!(
        "<inertial><origin xyz=\"{}\" rpy=\"0 0 0\"/><mass value=\"{:?}\"/><inertia ixx=\"{xx:?}\" ixy=\"{xy:?}\" \
         ixz=\"{xz:?}\" iyy=\"{yy:?}\" iyz=\"{yz:?}\" izz=\"{zz:?}\"/></inertial>",
        numbers(&inertia.centre()),
        inertia.mass()
    )
}

/// Inertia about the centre of mass: xx, xy, yy, xz, yz, zz.
fn moments(inertia: &Inertia) -> [f64; 6] {
    let i = inertia.about_centre();
    [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)].map(|at| i[at])
}

/// Roll, pitch and yaw of a rotation. The roll makes up for the error of the yaw near a pitch of a quarter turn, where
/// the yaw is not determined.
pub(super) fn roll_pitch_yaw(r: &Matrix3<f64>) -> [f64; 3] {
    let yaw = r[(1, 0)].atan2(r[(0, 0)]);
    let (sine, cosine) = yaw.sin_cos();
    let pitch = (-r[(2, 0)]).atan2(cosine * r[(0, 0)] + sine * r[(1, 0)]);
    let roll = (sine * r[(0, 2)] - cosine * r[(1, 2)]).atan2(cosine * r[(1, 1)] - sine * r[(0, 1)]);
    [roll, pitch, yaw]
}
