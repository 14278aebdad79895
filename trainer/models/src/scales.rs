//! Scales of a log, which defaults and bounds of learned numbers with a unit follow: an axis in metres is not one in radians.

/// Scales of what a log shows of a coordinate, robust amounts of which hardly any sample has more; 0 for one that the log does not show.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Scales {
    /// Speed |v|, m/s or rad/s.
    pub speed: f64,
    /// Acceleration |v̇|, m/s² or rad/s².
    pub acceleration: f64,
    /// Force |τ| of the drive, N or N m; without a logged force, that of the inertia and the potential with which training begins.
    pub force: f64,
    /// Distance |u − q| of commanded positions from positions, m or rad.
    pub deflection: f64,
}

impl Scales {
    /// Force over speed, N s/m or N m s/rad: the scale of damping.
    pub fn damping(&self) -> f64 {
        self.force / self.speed
    }

    /// Force over deflection, N/m or N m/rad: the scale of a servo's stiffness.
    pub fn stiffness(&self) -> f64 {
        self.force / self.deflection
    }

    /// The larger of every scale.
    #[must_use]
    pub fn max(&self, other: &Self) -> Self {
        Self {
            speed: self.speed.max(other.speed),
            acceleration: self.acceleration.max(other.acceleration),
            force: self.force.max(other.force),
            deflection: self.deflection.max(other.deflection),
        }
    }
}
