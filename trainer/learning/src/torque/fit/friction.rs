//! Rotor, friction and sensor offset of a joint.

/// Number of parameters per joint.
pub const JOINT: usize = 7;

/// Rotor, friction and torque offset of a joint. The torque of its drive solves τ = τ_bodies + J a + b v + (c + l (√(τ² + s²) − s))
/// tanh(v/ε): friction grows with the load that the model predicts, never with a measured one. The logged torque is τ + o.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointNumbers {
    /// Rotor inertia J ≥ 0, reflected to the joint (kg m², kg).
    pub rotor: f64,
    /// Viscous friction b ≥ 0 (N m s/rad, N s/m).
    pub viscous: f64,
    /// Coulomb friction c ≥ 0 (N m, N).
    pub coulomb: f64,
    /// Load coefficient 0 ≤ l < 1: the fraction of the load's size that is added to c.
    pub load: f64,
    /// Width ε > 0 of the transition at v = 0 (rad/s, m/s).
    pub width: f64,
    /// Offset o of the logged torque (N m, N).
    pub offset: f64,
    /// Smoothing s > 0 (N m, N): the effect of a load below s is quadratic.
    pub smoothing: f64,
}

impl Default for JointNumbers {
    /// No rotor, friction or offset.
    fn default() -> Self {
        Self::of_array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, SOFTNESS])
    }
}

/// The fields of [`JointNumbers`], in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointNumber {
    /// Rotor inertia J.
    Rotor,
    /// Viscous friction b.
    Viscous,
    /// Coulomb friction c.
    Coulomb,
    /// Load coefficient l.
    Load,
    /// Width ε.
    Width,
    /// Offset o.
    Offset,
    /// Smoothing s.
    Smoothing,
}

impl JointNumber {
    /// All of them.
    pub const ALL: [Self; JOINT] =
        [Self::Rotor, Self::Viscous, Self::Coulomb, Self::Load, Self::Width, Self::Offset, Self::Smoothing];
}

/// Default smoothing s of the magnitude of a load, √(τ² + s²) − s (N m, N). The magnitude is smooth at 0, and a load
/// below 0.1 N m has almost no effect.
pub const SOFTNESS: f64 = 0.1;

impl JointNumbers {
    /// The numbers in the order of the fields.
    #[must_use]
    pub fn array(&self) -> [f64; JOINT] {
        let Self { rotor, viscous, coulomb, load, width, offset, smoothing } = *self;
        [rotor, viscous, coulomb, load, width, offset, smoothing]
    }

    /// Inverse of [`JointNumbers::array`].
    #[must_use]
    pub fn of_array([rotor, viscous, coulomb, load, width, offset, smoothing]: [f64; JOINT]) -> Self {
        Self { rotor, viscous, coulomb, load, width, offset, smoothing }
    }

    /// The logged torque, given the torque `bodies` of the bodies alone, at velocity v and acceleration a.
    #[must_use]
    pub fn torque(&self, bodies: f64, v: f64, a: f64) -> f64 {
        self.drive(bodies, v, a) + self.offset
    }

    /// The drive's torque τ: of the two roots of its equation, the one whose difference from the frictionless torque has the sign of the
    /// friction.
    fn drive(&self, bodies: f64, v: f64, a: f64) -> f64 {
        let sign = (v / self.width).tanh();
        let rest = bodies + self.rotor * a + self.viscous * v + self.coulomb * sign;
        let k = self.load * sign;
        let (rest, part) = (rest - k * self.smoothing, 1.0 - k * k);
        (rest + k * (rest * rest + part * self.smoothing * self.smoothing).sqrt()) / part
    }

    /// The logged torque, its derivative with respect to `bodies`, and its derivatives with respect to the numbers.
    #[must_use]
    pub fn slopes(&self, bodies: f64, v: f64, a: f64) -> (f64, f64, [f64; JOINT]) {
        let tau = self.drive(bodies, v, a);
        let sign = (v / self.width).tanh();
        let root = tau.hypot(self.smoothing);
        let size = root - self.smoothing;
        let gain = 1.0 / (1.0 - self.load * sign * tau / root);
        let bend = -(v / (self.width * self.width)) * (1.0 - sign * sign);
        let width = (self.coulomb + self.load * size) * bend;
        let smoothing = self.load * sign * (self.smoothing / root - 1.0);
        let numbers =
            [gain * a, gain * v, gain * sign, gain * sign * size, gain * width, 1.0, gain * smoothing];
        (tau + self.offset, gain, numbers)
    }
}
