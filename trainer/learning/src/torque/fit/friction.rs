//! Friction of a joint and what its sensor adds.

/// Numbers of a coordinate beside its bodies.
pub const JOINT: usize = 7;

/// A joint's rotor and friction. The torque of its drive solves τ = τ_bodies + J a + b v + (c + l (√(τ² + s²) − s)) tanh(v/ε): friction grows with the
/// load that the model itself predicts, never with a measured one. The log has τ + o.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointNumbers {
    /// J ≥ 0, reflected to the joint (kg m², kg).
    pub rotor: f64,
    /// b ≥ 0 (N m s/rad, N s/m).
    pub viscous: f64,
    /// c ≥ 0 (N m, N).
    pub coulomb: f64,
    /// 0 ≤ l < 1: how much of the load's size is added to c.
    pub load: f64,
    /// ε > 0 (rad/s, m/s).
    pub width: f64,
    /// o (N m, N).
    pub offset: f64,
    /// s > 0 (N m, N): below it a load counts by its square.
    pub smoothing: f64,
}

impl Default for JointNumbers {
    /// Neither rotor nor friction nor offset.
    fn default() -> Self {
        Self::of_array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, SOFTNESS])
    }
}

/// The numbers of [`JointNumbers`], in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointNumber {
    /// J.
    Rotor,
    /// b.
    Viscous,
    /// c.
    Coulomb,
    /// l.
    Load,
    /// ε.
    Width,
    /// o.
    Offset,
    /// s.
    Smoothing,
}

impl JointNumber {
    /// All of them.
    pub const ALL: [Self; JOINT] =
        [Self::Rotor, Self::Viscous, Self::Coulomb, Self::Load, Self::Width, Self::Offset, Self::Smoothing];
}

/// The usual s of a load's size √(τ² + s²) − s (N m, N): smooth at 0, and below a tenth of a newton metre as good as none.
pub const SOFTNESS: f64 = 0.1;

impl JointNumbers {
    /// In the order of the fields.
    #[must_use]
    pub fn array(&self) -> [f64; JOINT] {
        let Self { rotor, viscous, coulomb, load, width, offset, smoothing } = *self;
        [rotor, viscous, coulomb, load, width, offset, smoothing]
    }

    /// See [`JointNumbers::array`].
    #[must_use]
    pub fn of_array([rotor, viscous, coulomb, load, width, offset, smoothing]: [f64; JOINT]) -> Self {
        Self { rotor, viscous, coulomb, load, width, offset, smoothing }
    }

    /// The logged torque where bodies alone take `bodies`, at velocity v and acceleration a.
    #[must_use]
    pub fn torque(&self, bodies: f64, v: f64, a: f64) -> f64 {
        self.drive(bodies, v, a) + self.offset
    }

    /// The drive's torque τ: the root of its equation whose difference from the rest has the sign of the friction.
    fn drive(&self, bodies: f64, v: f64, a: f64) -> f64 {
        let sign = (v / self.width).tanh();
        let rest = bodies + self.rotor * a + self.viscous * v + self.coulomb * sign;
        let k = self.load * sign;
        let (rest, part) = (rest - k * self.smoothing, 1.0 - k * k);
        (rest + k * (rest * rest + part * self.smoothing * self.smoothing).sqrt()) / part
    }

    /// The logged torque, its derivative in `bodies`, and those in the numbers.
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
