//! Inertial numbers of a body, and the condition for their physical consistency.

use nalgebra::{Matrix3, Matrix4, Vector3};

/// Number of inertial parameters of a body.
pub const INERTIAL: usize = 10;

/// Inertial numbers m, m c (x, y, z), and the rotational inertia xx, xy, yy, xz, yz, zz about the origin of the body's frame, in that
/// frame: kg, kg m, kg m².
///
/// I = ∫ (|x|² 1 − x xᵀ) dm, so that the products of inertia are −∫ x y dm. The order is that of Pinocchio's `toDynamicParameters`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Inertia(pub [f64; INERTIAL]);

impl Inertia {
    /// Creates the numbers from mass m (kg), centre of mass c (m), and the inertia about the centre of mass along the axes of the frame (kg
    /// m²).
    #[must_use]
    pub fn of_centre(mass: f64, centre: Vector3<f64>, inertia: Matrix3<f64>) -> Self {
        let about_origin =
            inertia + mass * (Matrix3::identity() * centre.norm_squared() - centre * centre.transpose());
        Self::of_parts(mass, mass * centre, about_origin)
    }

    fn of_parts(mass: f64, moment: Vector3<f64>, i: Matrix3<f64>) -> Self {
        let [x, y, z] = moment.into();
        Self([mass, x, y, z, i[(0, 0)], i[(0, 1)], i[(1, 1)], i[(0, 2)], i[(1, 2)], i[(2, 2)]])
    }

    /// Mass m, kg.
    #[must_use]
    pub fn mass(&self) -> f64 {
        self.0[0]
    }

    /// First moment m c, kg m.
    #[must_use]
    pub fn moment(&self) -> Vector3<f64> {
        let [_, x, y, z, ..] = self.0;
        Vector3::new(x, y, z)
    }

    /// Rotational inertia I about the origin, kg m².
    #[must_use]
    pub fn rotational(&self) -> Matrix3<f64> {
        let [_, _, _, _, xx, xy, yy, xz, yz, zz] = self.0;
        Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
    }

    /// Pseudo-inertia ∫ (x, 1)(x, 1)ᵀ dm. The numbers are physically consistent if and only if it is positive
    /// semidefinite.
    ///
    /// Source: Wensing, Kim and Slotine, "Linear matrix inequalities for physically consistent inertial parameter identification", 2018.
    #[must_use]
    pub fn pseudo(&self) -> Matrix4<f64> {
        let i = self.rotational();
        let second = Matrix3::identity() * (i.trace() / 2.0) - i;
        let mut pseudo = Matrix4::zeros();
        pseudo.fixed_view_mut::<3, 3>(0, 0).copy_from(&second);
        pseudo.fixed_view_mut::<3, 1>(0, 3).copy_from(&self.moment());
        pseudo.fixed_view_mut::<1, 3>(3, 0).copy_from(&self.moment().transpose());
        pseudo[(3, 3)] = self.mass();
        pseudo
    }

    /// Creates the numbers from a pseudo-inertia; only its symmetric part counts.
    #[must_use]
    pub fn of_pseudo(pseudo: &Matrix4<f64>) -> Self {
        let pseudo = (pseudo + pseudo.transpose()) / 2.0;
        let second = pseudo.fixed_view::<3, 3>(0, 0).into_owned();
        let moment = pseudo.fixed_view::<3, 1>(0, 3).into_owned();
        Self::of_parts(pseudo[(3, 3)], moment, Matrix3::identity() * second.trace() - second)
    }

    /// Returns the same body relative to a frame in which the body's present frame has rotation R and translation p.
    #[must_use]
    pub fn placed(&self, rotation: &Matrix3<f64>, translation: &Vector3<f64>) -> Self {
        let mut motion = Matrix4::identity();
        motion.fixed_view_mut::<3, 3>(0, 0).copy_from(rotation);
        motion.fixed_view_mut::<3, 1>(0, 3).copy_from(translation);
        Self::of_pseudo(&(motion * self.pseudo() * motion.transpose()))
    }

    /// Returns both bodies as one.
    #[must_use]
    pub fn with(&self, other: &Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] + other.0[k]))
    }

    /// Smallest eigenvalue of the pseudo-inertia after its rows and columns are scaled to a unit diagonal: positive if the body is
    /// physically consistent. NaN if the diagonal is not positive.
    #[must_use]
    pub fn consistency(&self) -> f64 {
        let pseudo = self.pseudo();
        let scale = pseudo.diagonal().map(|d| 1.0 / d.sqrt());
        let scaled = Matrix4::from_fn(|i, j| pseudo[(i, j)] * scale[i] * scale[j]);
        if scaled.iter().all(|x| x.is_finite()) { scaled.symmetric_eigenvalues().min() } else { f64::NAN }
    }
}

/// Log-Cholesky parameters θ of a body relative to another body, the prior. The pseudo-inertia of the body is U₀ U(θ)
/// U(θ)ᵀ U₀ᵀ, where U₀ U₀ᵀ is that of the prior, and U(θ) is upper triangular with the diagonal e^θ₀ … e^θ₃ and θ₄ … θ₉
/// above it, row by row. Every θ gives a physically consistent body, every body with a positive definite pseudo-inertia
/// has exactly one θ, the prior has θ = 0, and θ has no unit.
///
/// Source: Rucker and Wensing, "Smooth parameterization of rigid-body inertia", 2022.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogCholesky {
    root: Matrix4<f64>,
}

/// Positions of θ₄ … θ₉ in U(θ).
const ABOVE: [(usize, usize); 6] = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)];

impl LogCholesky {
    /// Creates parameters relative to this body; `None` if its pseudo-inertia is not positive definite.
    #[must_use]
    pub fn around(prior: &Inertia) -> Option<Self> {
        upper_root(&prior.pseudo()).map(|root| Self { root })
    }

    /// Returns the body for these parameters.
    #[must_use]
    pub fn inertia(&self, theta: &[f64; INERTIAL]) -> Inertia {
        let root = self.root * triangle(theta);
        Inertia::of_pseudo(&(root * root.transpose()))
    }

    /// ∂(inertial number j)/∂θ_k as \[k\]\[j\].
    #[must_use]
    pub fn slopes(&self, theta: &[f64; INERTIAL]) -> [[f64; INERTIAL]; INERTIAL] {
        let upper = triangle(theta);
        let root = self.root * upper;
        std::array::from_fn(|k| {
            let mut change = Matrix4::zeros();
            let (i, j) = if k < 4 { (k, k) } else { ABOVE[k - 4] };
            change[(i, j)] = if k < 4 { upper[(k, k)] } else { 1.0 };
            // `of_pseudo` takes the symmetric part, so twice one term of the product rule gives the sum of both.
            Inertia::of_pseudo(&(2.0 * self.root * change * root.transpose())).0
        })
    }

    /// Returns the parameters of a body; `None` if its pseudo-inertia is not positive definite.
    #[must_use]
    pub fn numbers(&self, inertia: &Inertia) -> Option<[f64; INERTIAL]> {
        let upper = self.root.try_inverse()? * upper_root(&inertia.pseudo())?;
        Some(std::array::from_fn(|k| if k < 4 { upper[(k, k)].ln() } else { upper[ABOVE[k - 4]] }))
    }
}

fn triangle(theta: &[f64; INERTIAL]) -> Matrix4<f64> {
    let mut upper = Matrix4::from_diagonal(&nalgebra::Vector4::from_fn(|k, _| theta[k].exp()));
    ABOVE.iter().zip(&theta[4..]).for_each(|(at, x)| upper[*at] = *x);
    upper
}

/// Returns U of P = U Uᵀ with a positive diagonal: the Cholesky factor of P in reversed order.
fn upper_root(pseudo: &Matrix4<f64>) -> Option<Matrix4<f64>> {
    let reversed = |m: &Matrix4<f64>| Matrix4::from_fn(|i, j| m[(3 - i, 3 - j)]);
    let root = reversed(pseudo).cholesky().map(|factor| reversed(&factor.l()))?;
    root.iter().all(|x| x.is_finite()).then_some(root)
}
