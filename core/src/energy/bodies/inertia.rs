use super::{BodyParameters, Vector};
use crate::scalar::Scalar;

/// Number of numbers of a [`PlanarInertia`].
pub const PLANAR_INERTIAL_PARAMETERS: usize = 4;

/// Inertia of a rigid body in the plane about the origin of its frame: four numbers, in which its energies are linear.
///
/// A body of positive density has m > 0 and m I > |mc|².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarInertia<S> {
    /// Mass m, kg.
    pub mass: S,
    /// First moments mc, kg m: m times the vector from the origin to the centre of mass.
    pub moment: Vector<S>,
    /// Moment of inertia I about the origin, kg m².
    pub inertia: S,
}

impl<S: Scalar> PlanarInertia<S> {
    /// Creates the inertia from m, mc_x, mc_y, I.
    pub fn from_array([mass, x, y, inertia]: [S; PLANAR_INERTIAL_PARAMETERS]) -> Self {
        Self { mass, moment: [x, y], inertia }
    }

    /// Returns the numbers of the inertia in the order of [`PlanarInertia::from_array`].
    pub fn into_array(self) -> [S; PLANAR_INERTIAL_PARAMETERS] {
        let Self { mass, moment: [x, y], inertia } = self;
        [mass, x, y, inertia]
    }

    /// Inertia of a body about the origin of its frame.
    pub fn of_body(body: &BodyParameters<S>) -> Self {
        let (m, [x, y]) = (body.mass, body.centre);
        Self { mass: m, moment: [m * x, m * y], inertia: body.inertia + m * (x * x + y * y) }
    }

    /// Returns the body with this inertia in place of its own; all else stays. The mass must not be 0.
    #[must_use]
    pub fn given_to(&self, body: &BodyParameters<S>) -> BodyParameters<S> {
        let [x, y] = self.moment.map(|moment| moment / self.mass);
        let inertia = self.inertia - self.mass * (x * x + y * y);
        BodyParameters { mass: self.mass, centre: [x, y], inertia, ..*body }
    }
}
