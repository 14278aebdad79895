//! Trees of rigid bodies on revolute and prismatic joints, of any size, in f64, and the recursions on them.
//!
//! Conventions. Body i has one joint, to its parent (a body before it) or to the base. The joint's frame has a constant pose in the
//! parent's frame, parent_x = R x + p at q = 0; the axis is a unit vector in the joint's frame, and the body's frame is the joint's frame
//! moved by q. SI units; gravity is a vector in the base frame, normally (0, 0, −9.81) m/s².

#[cfg(test)]
mod branched;
mod dynamics;
mod inertia;
mod kinematics;
mod nearest;

#[cfg(test)]
pub(crate) use branched::branched;

pub use inertia::{INERTIAL, Inertia, LogCholesky};

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use thiserror::Error;

/// A constant pose: parent_x = R x + p.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Rotation R.
    pub rotation: Matrix3<f64>,
    /// Translation p, m.
    pub translation: Vector3<f64>,
}

impl Pose {
    /// Returns the pose of the parent itself.
    #[must_use]
    pub fn identity() -> Self {
        Self { rotation: Matrix3::identity(), translation: Vector3::zeros() }
    }

    /// Creates a pose from a translation, and from roll, pitch and yaw about the fixed axes x, y and z in that order (rad), as in URDF.
    #[must_use]
    pub fn of_rpy(translation: [f64; 3], [roll, pitch, yaw]: [f64; 3]) -> Self {
        let rotation = Rotation3::from_euler_angles(roll, pitch, yaw).into_inner();
        Self { rotation, translation: translation.into() }
    }

    /// Creates a pose from the modified Denavit–Hartenberg parameters α, a and d (rad, m): Rot_x(α) Trans_x(a) Trans_z(d), before the turn
    /// about z.
    ///
    /// Source: Craig, "Introduction to Robotics", chapter 3.
    #[must_use]
    pub fn of_modified_dh(alpha: f64, a: f64, d: f64) -> Self {
        let rotation = Rotation3::from_axis_angle(&Vector3::x_axis(), alpha).into_inner();
        Self { rotation, translation: Vector3::new(a, 0.0, 0.0) + rotation * Vector3::new(0.0, 0.0, d) }
    }

    /// Returns the pose of a frame that has the pose `inner` in this frame.
    #[must_use]
    pub fn then(&self, inner: &Self) -> Self {
        Self {
            rotation: self.rotation * inner.rotation,
            translation: self.translation + self.rotation * inner.translation,
        }
    }
}

/// Joint between a body and its parent, with a unit axis in the joint's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Joint {
    /// Turns about the axis; q in rad. Continuous joints are revolute too.
    Revolute(Unit<Vector3<f64>>),
    /// Slides along the axis; q in m.
    Prismatic(Unit<Vector3<f64>>),
}

impl Joint {
    /// Unit vector along the axis, in the joint's frame.
    #[must_use]
    pub fn axis(&self) -> Vector3<f64> {
        match self {
            Self::Revolute(axis) | Self::Prismatic(axis) => axis.into_inner(),
        }
    }

    /// Returns the pose that the joint gives to what it moves at the position q, rad or m.
    #[must_use]
    pub fn pose(&self, q: f64) -> Pose {
        let Pose { rotation, translation } = Pose::identity();
        match self {
            Self::Revolute(axis) => {
                Pose { rotation: Rotation3::from_axis_angle(axis, q).into_inner(), translation }
            }
            Self::Prismatic(axis) => Pose { rotation, translation: axis.scale(q) },
        }
    }
}

/// Limits of a joint, in rad or m; infinite if not given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Lowest and highest position.
    pub position: [f64; 2],
    /// Largest |v|.
    pub velocity: f64,
    /// Largest |τ|, N m or N.
    pub effort: f64,
}

impl Limits {
    /// Returns infinite limits.
    #[must_use]
    pub fn none() -> Self {
        let all = f64::INFINITY;
        Self { position: [-all, all], velocity: all, effort: all }
    }
}

/// A rigid body on its joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Name of the link, in messages.
    pub name: String,
    /// Name of its joint.
    pub joint_name: String,
    /// Number of the body that carries it, which precedes it; `None` for the base.
    pub parent: Option<usize>,
    /// Joint between the body and its parent.
    pub joint: Joint,
    /// Pose of the joint's frame in the parent's.
    pub pose: Pose,
    /// Number of the coordinate that moves it. The position of its joint is ratio · q + offset, with ratio 1 and offset
    /// 0 except for joints that follow another one.
    pub coordinate: usize,
    /// See `coordinate`.
    pub ratio: f64,
    /// See `coordinate`, rad or m.
    pub offset: f64,
    /// Inertial numbers of the body.
    pub inertia: Inertia,
    /// Limits of the joint itself.
    pub limits: Limits,
}

/// Tolerance within which two frames or axes belong to the same joint, m or 1.
const SAME: f64 = 1e-4;

impl Body {
    /// Whether the joints of both bodies differ at most by the rounding of single precision.
    #[must_use]
    pub fn has_joint_of(&self, other: &Self) -> bool {
        let rotation = (self.pose.rotation - other.pose.rotation).amax();
        let place = (self.pose.translation - other.pose.translation).amax();
        let axis = (self.joint.axis() - other.joint.axis()).amax();
        self.parent == other.parent && rotation.max(place).max(axis) < SAME
    }
}

/// End of a body with this mass (kg) and first moment about its joint (kg m): twice as far from the joint as the centre of mass, as that of an
/// even rod, or the centre itself of a body that slides; m.
#[must_use]
pub fn reach((mass, moment): (f64, Vector3<f64>), turns: bool) -> Vector3<f64> {
    let factor = if turns { 2.0 } else { 1.0 };
    if mass > 0.0 { moment * (factor / mass) } else { Vector3::zeros() }
}

/// A tree of rigid bodies with rotors, on a resting base.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree {
    bodies: Vec<Body>,
    /// Rotor inertia J reflected to every coordinate, kg m² or kg; it adds ½ J v² to the kinetic energy.
    pub rotors: Vec<f64>,
    /// Gravity in the base frame, m/s².
    pub gravity: Vector3<f64>,
}

/// Reason why bodies do not form a tree.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TreeError {
    /// A parent that does not precede its child.
    #[error("body {body} ({name}): its parent {parent} does not stand before it")]
    Parent {
        /// Number of the child.
        body: usize,
        /// Name of the child.
        name: String,
        /// Parent as given.
        parent: usize,
    },
    /// A coordinate that moves nothing.
    #[error("coordinate {0} moves no body")]
    Unused(usize),
    /// A number that is not finite.
    #[error("body {0}: a number is not finite")]
    NotFinite(String),
    /// No body moves.
    #[error("no body moves")]
    Empty,
}

impl Tree {
    /// Creates a tree under the usual gravity, (0, 0, −9.81) m/s², without rotors.
    ///
    /// # Errors
    /// [`TreeError`].
    pub fn new(bodies: Vec<Body>) -> Result<Self, TreeError> {
        let coordinates = bodies.iter().map(|body| body.coordinate + 1).max().ok_or(TreeError::Empty)?;
        for (i, body) in bodies.iter().enumerate() {
            if let Some(parent) = body.parent.filter(|parent| *parent >= i) {
                return Err(TreeError::Parent { body: i, name: body.name.clone(), parent });
            }
            let pose = body.pose.rotation.iter().chain(&body.pose.translation);
            let numbers = pose.chain(&body.inertia.0).chain([&body.ratio, &body.offset]);
            if !numbers.copied().all(f64::is_finite) {
                return Err(TreeError::NotFinite(body.name.clone()));
            }
        }
        // A large coordinate number would make later code allocate room for all numbers below it.
        let is_used = |k: &usize| bodies.iter().any(|body| body.coordinate == *k);
        if let Some(k) = (0..coordinates).find(|k| !is_used(k)) {
            return Err(TreeError::Unused(k));
        }
        Ok(Self { bodies, rotors: vec![0.0; coordinates], gravity: Vector3::new(0.0, 0.0, -9.81) })
    }

    /// Number of coordinates n.
    #[must_use]
    pub fn coordinates(&self) -> usize {
        self.rotors.len()
    }

    /// Bodies, each after its parent.
    #[must_use]
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// All inertial parameters: ten numbers for every body, then a rotor inertia for every coordinate.
    #[must_use]
    pub fn parameters(&self) -> Vec<f64> {
        self.bodies.iter().flat_map(|body| body.inertia.0).chain(self.rotors.iter().copied()).collect()
    }

    /// Count of the inertial parameters.
    #[must_use]
    pub fn parameter_count(&self) -> usize {
        INERTIAL * self.bodies.len() + self.coordinates()
    }

    /// Returns this tree with other bodies and rotors.
    ///
    /// # Panics
    /// If the number of parameters differs.
    #[must_use]
    pub fn with_parameters(&self, parameters: &[f64]) -> Self {
        assert_eq!(parameters.len(), self.parameter_count(), "parameters of another tree");
        let (bodies, rotors) = parameters.split_at(INERTIAL * self.bodies.len());
        let mut tree = self.clone();
        let (numbers, _) = bodies.as_chunks();
        tree.bodies.iter_mut().zip(numbers).for_each(|(body, numbers)| body.inertia = Inertia(*numbers));
        tree.rotors = rotors.to_vec();
        tree
    }

    /// Names of the parameters, for messages and tables.
    #[must_use]
    pub fn parameter_names(&self) -> Vec<String> {
        const NUMBERS: [&str; INERTIAL] = ["m", "mx", "my", "mz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz"];
        let of_body = |body: &Body| NUMBERS.map(|number| format!("{} {number}", body.name));
        let rotors = (0..self.coordinates()).map(|k| format!("rotor {}", self.coordinate_name(k)));
        self.bodies.iter().flat_map(of_body).chain(rotors).collect()
    }

    /// Name of the joint to which coordinate k belongs: the first joint that the coordinate moves with ratio 1 and
    /// offset 0, or else the first joint that it moves.
    #[must_use]
    pub fn coordinate_name(&self, k: usize) -> &str {
        let mut moved = self.bodies.iter().filter(|body| body.coordinate == k);
        let own = moved.clone().find(|body| body.ratio == 1.0 && body.offset == 0.0);
        own.or_else(|| moved.next()).map_or("", |body| &body.joint_name)
    }

    /// Returns the same kinematics with guessed bodies in place of those without mass. `mass` (kg) is shared among them
    /// in proportion to their lengths. Each is spread evenly along the line between its frame and the frames that it
    /// carries, and has the radius `radius` (m) in all directions.
    #[must_use]
    pub fn with_guessed_inertias(&self, mass: f64, radius: f64) -> Self {
        let mut tree = self.clone();
        let ends: Vec<Vector3<f64>> = (0..self.bodies.len()).map(|i| self.end(i)).collect();
        let length = |i: usize| ends[i].norm() + 2.0 * radius;
        let unknown: Vec<usize> = (0..ends.len()).filter(|i| self.bodies[*i].inertia.mass() == 0.0).collect();
        let total: f64 = unknown.iter().map(|i| length(*i)).sum();
        for i in unknown {
            let (mass, centre) = (mass * length(i) / total, ends[i] / 2.0);
            // Second moments about the centre: those of a rod, plus those of a ball around every point of the rod.
            let second = ends[i] * ends[i].transpose() / 12.0 + Matrix3::identity() * (radius * radius / 5.0);
            let inertia = mass * (Matrix3::identity() * second.trace() - second);
            tree.bodies[i].inertia = Inertia::of_centre(mass, centre, inertia);
        }
        tree
    }

    /// Mean position of the joints that a body carries, in its frame; its own origin if it carries none.
    fn end(&self, body: usize) -> Vector3<f64> {
        let carried = || self.bodies.iter().filter(move |other| other.parent == Some(body));
        let sum: Vector3<f64> = carried().map(|other| other.pose.translation).sum();
        sum / carried().count().max(1) as f64
    }

    /// Limits of a coordinate: position and velocity respect all joints that it moves; the effort is that of the joint
    /// to which it belongs.
    #[must_use]
    pub fn limits(&self, coordinate: usize) -> Limits {
        let mut all = Limits::none();
        for body in self.bodies().iter().filter(|body| body.coordinate == coordinate && body.ratio != 0.0) {
            let mut ends = body.limits.position.map(|x| (x - body.offset) / body.ratio);
            ends.sort_by(f64::total_cmp);
            all.position = [all.position[0].max(ends[0]), all.position[1].min(ends[1])];
            all.velocity = all.velocity.min(body.limits.velocity / body.ratio.abs());
            if body.joint_name == self.coordinate_name(coordinate) {
                all.effort = body.limits.effort;
            }
        }
        all
    }
}
