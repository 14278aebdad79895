//! Rotor, friction and sensor offset of a joint.

use leastaction_models::NumberKind;

/// Number of parameters per joint.
pub const JOINT: usize = 9;

/// Rotor, friction and torque offset of a joint. The torque of its drive solves τ = τ_bodies + J a + b (1 + βt) v + (c (1 + δt) + l (√(τ² +
/// s²) − s)) t with t = tanh(v/ε): friction grows with the load that the model predicts, never with a measured one. The logged torque is τ + o.
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
    /// Asymmetry −1 ≤ β ≤ 1 of viscous friction.
    pub viscous_asymmetry: f64,
    /// Asymmetry −1 ≤ δ ≤ 1 of Coulomb friction.
    pub asymmetry: f64,
}

impl Default for JointNumbers {
    /// No rotor, friction or offset.
    fn default() -> Self {
        Self::of_array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, SOFTNESS, 0.0, 0.0])
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
    /// Asymmetry β.
    ViscousAsymmetry,
    /// Asymmetry δ.
    Asymmetry,
}

impl JointNumber {
    /// All of them.
    pub const ALL: [Self; JOINT] = [
        Self::Rotor,
        Self::Viscous,
        Self::Coulomb,
        Self::Load,
        Self::Width,
        Self::Offset,
        Self::Smoothing,
        Self::ViscousAsymmetry,
        Self::Asymmetry,
    ];

    /// The number of this meaning in a law; `None` for a number of no joint's friction.
    pub const fn of(kind: NumberKind) -> Option<Self> {
        match kind {
            NumberKind::Damping => Some(Self::Viscous),
            NumberKind::DampingAsymmetry => Some(Self::ViscousAsymmetry),
            NumberKind::Friction => Some(Self::Coulomb),
            NumberKind::FrictionAsymmetry => Some(Self::Asymmetry),
            NumberKind::Load => Some(Self::Load),
            NumberKind::Smoothing => Some(Self::Smoothing),
            NumberKind::Width => Some(Self::Width),
            _ => None,
        }
    }
}

/// Default smoothing s of the magnitude of a load, √(τ² + s²) − s (N m, N). The magnitude is smooth at 0, and a load
/// below 0.1 N m has almost no effect.
pub const SOFTNESS: f64 = 0.1;

impl JointNumbers {
    /// The numbers in the order of the fields.
    #[must_use]
    pub fn array(&self) -> [f64; JOINT] {
        let Self { rotor, viscous, coulomb, load, width, offset, smoothing, .. } = *self;
        [rotor, viscous, coulomb, load, width, offset, smoothing, self.viscous_asymmetry, self.asymmetry]
    }

    /// Inverse of [`JointNumbers::array`].
    #[must_use]
    pub fn of_array(numbers: [f64; JOINT]) -> Self {
        let [rotor, viscous, coulomb, load, width, offset, smoothing, viscous_asymmetry, asymmetry] = numbers;
        Self { rotor, viscous, coulomb, load, width, offset, smoothing, viscous_asymmetry, asymmetry }
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
        let [damping, level] = self.by_direction(sign);
        let rest = bodies + self.rotor * a + damping * v + level * sign;
        let k = self.load * sign;
        let (rest, part) = (rest - k * self.smoothing, 1.0 - k * k);
        (rest + k * (rest * rest + part * self.smoothing * self.smoothing).sqrt()) / part
    }

    /// b (1 + βt) and c (1 + δt).
    fn by_direction(&self, t: f64) -> [f64; 2] {
        [self.viscous * (1.0 + self.viscous_asymmetry * t), self.coulomb * (1.0 + self.asymmetry * t)]
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
        let turned = self.viscous * self.viscous_asymmetry * v + self.coulomb * self.asymmetry * sign;
        let width = (turned + self.by_direction(sign)[1] + self.load * size) * bend;
        let [viscous, coulomb] = [self.viscous_asymmetry, self.asymmetry].map(|of| 1.0 + of * sign);
        let smoothing = self.load * sign * (self.smoothing / root - 1.0);
        let friction = [viscous * v, coulomb * sign, sign * size, width].map(|slope| gain * slope);
        let [viscous, coulomb, load, width] = friction;
        let asymmetries = [self.viscous * v, self.coulomb * sign].map(|whole| gain * whole * sign);
        let [by_beta, by_delta] = asymmetries;
        let numbers = [gain * a, viscous, coulomb, load, width, 1.0, gain * smoothing, by_beta, by_delta];
        (tau + self.offset, gain, numbers)
    }
}
