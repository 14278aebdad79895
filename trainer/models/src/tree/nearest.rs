//! Physically consistent bodies near given numbers.

use super::Inertia;
use nalgebra::{Matrix3, SymmetricEigen, Vector3};

impl Inertia {
    /// Centre of mass c, m; the origin for a body without mass.
    #[must_use]
    pub fn centre(&self) -> Vector3<f64> {
        if self.mass() == 0.0 { Vector3::zeros() } else { self.moment() / self.mass() }
    }

    /// Rotational inertia about the centre of mass along the axes of the frame, kg m².
    #[must_use]
    pub fn about_centre(&self) -> Matrix3<f64> {
        let c = self.centre();
        self.rotational() - self.mass() * (Matrix3::identity() * c.norm_squared() - c * c.transpose())
    }

    /// Principal moments of inertia about the centre of mass in rising order, kg m².
    #[must_use]
    pub fn principal_moments(&self) -> [f64; 3] {
        rising(&self.about_centre())
    }

    /// Principal second moments about the centre of mass in rising order, kg m²: the eigenvalues of Σ = ½ tr(I) 1 − I.
    /// All are positive if and only if a body of positive mass is physically consistent.
    #[must_use]
    pub fn principal_spreads(&self) -> [f64; 3] {
        rising(&turned_over(&self.about_centre()))
    }

    /// Returns the body with this mass and centre whose second moments about the centre are nearest (in the Frobenius
    /// norm) among all bodies with principal second moments of at least `least`, kg m².
    #[must_use]
    pub fn nearest(&self, least: f64) -> Self {
        let own = SymmetricEigen::new(turned_over(&self.about_centre()));
        let values = Matrix3::from_diagonal(&own.eigenvalues.map(|value| value.max(least)));
        let second = own.eigenvectors * values * own.eigenvectors.transpose();
        let second = (second + second.transpose()) / 2.0;
        let about_centre = Matrix3::identity() * second.trace() - second;
        Self::of_centre(self.mass(), self.centre(), about_centre)
    }

    /// Returns a ball of this mass, centre and radius (m).
    #[must_use]
    pub fn as_ball(&self, radius: f64) -> Self {
        let moment = 0.4 * self.mass() * radius * radius;
        Self::of_centre(self.mass(), self.centre(), Matrix3::identity() * moment)
    }

    /// Change of the inertia about the centre of mass from this body to another one, relative to this body's, in the
    /// Frobenius norm.
    #[must_use]
    pub fn change_to(&self, other: &Self) -> f64 {
        let own = self.about_centre();
        (other.about_centre() - own).norm() / own.norm()
    }
}

/// Second moments of an inertia.
fn turned_over(inertia: &Matrix3<f64>) -> Matrix3<f64> {
    Matrix3::identity() * (inertia.trace() / 2.0) - inertia
}

fn rising(symmetric: &Matrix3<f64>) -> [f64; 3] {
    let mut values: [f64; 3] = symmetric.symmetric_eigenvalues().into();
    values.sort_by(f64::total_cmp);
    values
}
