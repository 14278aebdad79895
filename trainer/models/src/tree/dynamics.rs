//! Newton–Euler recursions: inverse dynamics, its regressor, mass matrix and energies.
//!
//! Source: Featherstone, "Rigid Body Dynamics Algorithms", 2008; the regressor: Atkeson, An and Hollerbach 1986.

use super::{Body, Joint, Tree};
use super::{INERTIAL, Inertia};
use nalgebra::{Matrix3, Rotation3, Vector3};

/// Motion of a body's frame, expressed in that frame.
struct Motion {
    /// Rotation of the body relative to its parent.
    rotation: Matrix3<f64>,
    /// Position of the body's origin relative to the parent's, in the parent's frame (m).
    offset: Vector3<f64>,
    /// Angular velocity (rad/s).
    angular: Vector3<f64>,
    /// Velocity of the origin (m/s).
    linear: Vector3<f64>,
    /// Angular acceleration (rad/s²).
    angular_rate: Vector3<f64>,
    /// Acceleration of the origin less gravity (m/s²).
    linear_rate: Vector3<f64>,
}

/// Force (N) and moment about a frame's origin (N m), in that frame.
#[derive(Clone, Copy, Default)]
struct Wrench {
    force: Vector3<f64>,
    moment: Vector3<f64>,
}

impl Wrench {
    fn plus(&self, other: &Self) -> Self {
        Self { force: self.force + other.force, moment: self.moment + other.moment }
    }
}

impl Motion {
    /// Motion of the base, which rests in a gravity field.
    fn of_base(gravity: Vector3<f64>) -> Self {
        let zero = Vector3::zeros();
        let (rotation, offset) = (Matrix3::identity(), zero);
        Self { rotation, offset, angular: zero, linear: zero, angular_rate: zero, linear_rate: -gravity }
    }

    /// Motion of a body carried by this one, with its joint at q, velocity v and acceleration a.
    fn carried(&self, body: &Body, [q, v, a]: [f64; 3]) -> Self {
        let (turn, slide, [turn_v, turn_a], [slide_v, slide_a]) = match body.joint {
            Joint::Revolute(axis) => {
                let turn = Rotation3::from_axis_angle(&axis, q).into_inner();
                (turn, Vector3::zeros(), [v, a].map(|x| axis.scale(x)), [Vector3::zeros(); 2])
            }
            Joint::Prismatic(axis) => {
                (Matrix3::identity(), axis.scale(q), [Vector3::zeros(); 2], [v, a].map(|x| axis.scale(x)))
            }
        };
        let rotation = body.pose.rotation * turn;
        let offset = body.pose.translation + body.pose.rotation * slide;
        let back = rotation.transpose();
        let (carried, carried_rate) = (back * self.angular, back * self.angular_rate);
        let at = self.linear + self.angular.cross(&offset);
        let at_rate = self.linear_rate
            + self.angular_rate.cross(&offset)
            + self.angular.cross(&self.angular.cross(&offset));
        Self {
            rotation,
            offset,
            angular: carried + turn_v,
            linear: back * at + slide_v,
            angular_rate: carried_rate + carried.cross(&turn_v) + turn_a,
            linear_rate: back * at_rate + 2.0 * carried.cross(&slide_v) + slide_a,
        }
    }

    /// Wrench that causes this motion for a body with the given inertia.
    fn wrench(&self, inertia: &Inertia) -> Wrench {
        let (moment, rotational, w) = (inertia.moment(), inertia.rotational(), &self.angular);
        Wrench {
            force: inertia.mass() * self.linear_rate
                + self.angular_rate.cross(&moment)
                + w.cross(&w.cross(&moment)),
            moment: moment.cross(&self.linear_rate)
                + rotational * self.angular_rate
                + w.cross(&(rotational * w)),
        }
    }

    /// Converts a wrench on this body into one on its parent.
    fn on_parent(&self, wrench: &Wrench) -> Wrench {
        let force = self.rotation * wrench.force;
        Wrench { force, moment: self.rotation * wrench.moment + self.offset.cross(&force) }
    }
}

impl Body {
    /// Component of a wrench along the body's coordinate.
    fn felt(&self, wrench: &Wrench) -> f64 {
        self.ratio
            * match self.joint {
                Joint::Revolute(axis) => axis.dot(&wrench.moment),
                Joint::Prismatic(axis) => axis.dot(&wrench.force),
            }
    }
}

impl Tree {
    fn motions(&self, [q, v, a]: [&[f64]; 3], gravity: Vector3<f64>) -> Vec<Motion> {
        for state in [q, v, a] {
            assert_eq!(state.len(), self.coordinates(), "a state of another number of coordinates");
        }
        let base = Motion::of_base(gravity);
        let mut motions: Vec<Motion> = Vec::with_capacity(self.bodies().len());
        for body in self.bodies() {
            let (k, ratio) = (body.coordinate, body.ratio);
            let joint = [ratio * q[k] + body.offset, ratio * v[k], ratio * a[k]];
            let parent = body.parent.map_or(&base, |parent| &motions[parent]);
            let motion = parent.carried(body, joint);
            motions.push(motion);
        }
        motions
    }

    fn forces(&self, state: [&[f64]; 3], gravity: Vector3<f64>) -> Vec<f64> {
        let motions = self.motions(state, gravity);
        let mut forces: Vec<f64> = self.rotors.iter().zip(state[2]).map(|(rotor, a)| rotor * a).collect();
        let mut wrenches = vec![Wrench::default(); motions.len()];
        for (i, (body, motion)) in self.bodies().iter().zip(&motions).enumerate().rev() {
            let wrench = wrenches[i].plus(&motion.wrench(&body.inertia));
            forces[body.coordinate] += body.felt(&wrench);
            if let Some(parent) = body.parent {
                wrenches[parent] = wrenches[parent].plus(&motion.on_parent(&wrench));
            }
        }
        forces
    }

    /// Force τ (N m, N) under which the tree at q, v accelerates by a: M a + C v + ∂V/∂q, without friction.
    ///
    /// # Panics
    /// If the length of q, v or a differs from the number of coordinates. All functions of this module do.
    #[must_use]
    pub fn inverse_dynamics(&self, q: &[f64], v: &[f64], a: &[f64]) -> Vec<f64> {
        self.forces([q, v, a], self.gravity)
    }

    /// Regressor Y(q, v, a), \[n\]\[parameters\]: τ = Y π, π = [`Tree::parameters`].
    #[must_use]
    pub fn regressor(&self, q: &[f64], v: &[f64], a: &[f64]) -> Vec<Vec<f64>> {
        let motions = self.motions([q, v, a], self.gravity);
        let mut rows = vec![vec![0.0; self.parameter_count()]; self.coordinates()];
        for (i, motion) in motions.iter().enumerate() {
            for number in 0..INERTIAL {
                let unit = Inertia(std::array::from_fn(|k| f64::from(u8::from(k == number))));
                let (mut wrench, mut at) = (motion.wrench(&unit), Some(i));
                while let Some(body) = at {
                    let carrier = &self.bodies()[body];
                    rows[carrier.coordinate][INERTIAL * i + number] += carrier.felt(&wrench);
                    wrench = motions[body].on_parent(&wrench);
                    at = carrier.parent;
                }
            }
        }
        let rotors = INERTIAL * motions.len();
        rows.iter_mut().zip(a).enumerate().for_each(|(k, (row, a))| row[rotors + k] = *a);
        rows
    }

    /// Mass matrix M(q), \[n\]\[n\], kg m²: each column is the force for a unit acceleration at rest without gravity.
    #[must_use]
    pub fn mass_matrix(&self, q: &[f64]) -> Vec<Vec<f64>> {
        let n = self.coordinates();
        let rest = vec![0.0; n];
        let unit = |j: usize| -> Vec<f64> { (0..n).map(|k| f64::from(u8::from(k == j))).collect() };
        (0..n).map(|j| self.forces([q, &rest, &unit(j)], Vector3::zeros())).collect()
    }

    /// Kinetic energy T including that of the rotors, and potential energy V (J); V is 0 for a body whose centre of mass is at the origin
    /// of the base.
    #[must_use]
    pub fn energies(&self, q: &[f64], v: &[f64]) -> [f64; 2] {
        let motions = self.motions([q, v, &vec![0.0; v.len()]], self.gravity);
        let mut poses: Vec<super::Pose> = Vec::with_capacity(motions.len());
        let mut kinetic: f64 = self.rotors.iter().zip(v).map(|(rotor, v)| rotor * v * v / 2.0).sum();
        let mut potential = 0.0;
        for (body, motion) in self.bodies().iter().zip(&motions) {
            let own = super::Pose { rotation: motion.rotation, translation: motion.offset };
            let pose = body.parent.map_or(own, |parent| poses[parent].then(&own));
            let (mass, moment, w) = (body.inertia.mass(), body.inertia.moment(), &motion.angular);
            kinetic += mass * motion.linear.norm_squared() / 2.0
                + motion.linear.dot(&w.cross(&moment))
                + w.dot(&(body.inertia.rotational() * w)) / 2.0;
            potential -= self.gravity.dot(&(mass * pose.translation + pose.rotation * moment));
            poses.push(pose);
        }
        [kinetic, potential]
    }
}
