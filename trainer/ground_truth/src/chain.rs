use super::motion::{BadMechanism, ExactMotion, above_zero};
use nalgebra::{Cholesky, DMatrix, DVectorViewMut, Dyn};

/// Acceleration of gravity in ModLaNet's experiments, m/s².
const GRAVITY: f64 = 9.8;

/// One rigid link of a chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// Mass, kg.
    pub mass: f64,
    /// Distance from the pivot to the next pivot, m.
    pub length: f64,
    /// Distance from the pivot to the centre of mass, along the line to the next pivot, m.
    pub centre: f64,
    /// Moment of inertia about the centre of mass, kg m².
    pub inertia: f64,
}

impl Link {
    /// A mass at the end of a massless rod.
    pub fn point(mass: f64, length: f64) -> Self {
        Self { mass, length, centre: length, inertia: 0.0 }
    }

    /// A thin homogeneous rod: c = l/2, I = m l²/12.
    pub fn rod(mass: f64, length: f64) -> Self {
        Self { mass, length, centre: 0.5 * length, inertia: mass * length * length / 12.0 }
    }

    fn check(&self, element: usize) -> Result<(), BadMechanism> {
        above_zero(element, "a mass of", self.mass)?;
        above_zero(element, "a length of", self.length)?;
        let centre = BadMechanism::OutOfRange {
            element,
            quantity: "its centre of mass at",
            value: self.centre,
            range: "finite",
        };
        if !self.centre.is_finite() {
            return Err(centre);
        }
        let (quantity, range) = ("a moment of inertia of", "finite, and above 0 for a mass in its pivot");
        let good = self.inertia.is_finite()
            && self.inertia >= 0.0
            && self.mass * self.centre * self.centre + self.inertia > 0.0;
        let bad = BadMechanism::OutOfRange { element, quantity, value: self.inertia, range };
        if good { Ok(()) } else { Err(bad) }
    }
}

/// A chain of pendulums, hanging from a fixed point or from a cart that slides along x without friction; g = 9.8 m/s².
///
/// q = (θ₁, …) or (x, θ₁, …): absolute angles from the downward vertical, rad, and the cart's position, m. rᵢⱼ is the
/// lever of link j in the position of link i's centre of mass (lⱼ for j < i, cᵢ for j = i, else 0). With Aⱼₖ = Σᵢ mᵢ
/// rᵢⱼ rᵢₖ + δⱼₖ Iⱼ and Bⱼ = Σᵢ mᵢ rᵢⱼ,
///
///   Σₖ Aⱼₖ (cos(θⱼ−θₖ) θ̈ₖ + sin(θⱼ−θₖ) θ̇ₖ²) + Bⱼ (cos θⱼ ẍ + g sin θⱼ) = 0,
///   (M + Σm) ẍ + Σⱼ Bⱼ (cos θⱼ θ̈ⱼ − sin θⱼ θ̇ⱼ²) = 0,   V = −g Σⱼ Bⱼ cos θⱼ.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    links: Vec<Link>,
    cart: Option<f64>,
    /// Matrix A.
    pub(super) inertia: DMatrix<f64>,
    /// Vector B.
    pub(super) moments: Vec<f64>,
}

impl Chain {
    /// A chain of links from the top down, with a cart of this mass (kg) if given.
    ///
    /// # Errors
    /// [`BadMechanism`] if there is no link, if a mass or a length is not finite and above 0, or if a link has no inertia about its pivot.
    pub fn new(links: Vec<Link>, cart: Option<f64>) -> Result<Self, BadMechanism> {
        cart.map_or(Ok(()), |mass| above_zero(0, "a cart's mass of", mass))?;
        links.iter().enumerate().try_for_each(|(i, link)| link.check(i))?;
        if links.is_empty() {
            return Err(BadMechanism::Empty);
        }
        let lever = |i: usize, j: usize| match i.cmp(&j) {
            std::cmp::Ordering::Greater => links[j].length,
            std::cmp::Ordering::Equal => links[i].centre,
            std::cmp::Ordering::Less => 0.0,
        };
        let n = links.len();
        let sum = |term: &dyn Fn(usize) -> f64| (0..n).map(|i| links[i].mass * term(i)).sum::<f64>();
        let own = |j: usize, k: usize| if j == k { links[j].inertia } else { 0.0 };
        let inertia = DMatrix::from_fn(n, n, |j, k| sum(&|i| lever(i, j) * lever(i, k)) + own(j, k));
        let moments = (0..n).map(|j| sum(&|i| lever(i, j))).collect();
        Ok(Self { inertia, moments, cart, links })
    }

    /// Point masses (kg) on massless rods (m), hanging from a fixed point.
    ///
    /// # Errors
    /// [`BadMechanism`] as for [`Chain::new`], and for lists of different lengths.
    pub fn of_points(masses: &[f64], lengths: &[f64]) -> Result<Self, BadMechanism> {
        if masses.len() != lengths.len() {
            return Err(BadMechanism::Unpaired { masses: masses.len(), lengths: lengths.len() });
        }
        Self::new(masses.iter().zip(lengths).map(|(&m, &l)| Link::point(m, l)).collect(), None)
    }

    /// Point masses of 1 kg on rods of 1 m, as in ModLaNet's experiments.
    ///
    /// # Errors
    /// [`BadMechanism`] if `count` is 0.
    pub fn uniform(count: usize) -> Result<Self, BadMechanism> {
        Self::new(vec![Link::point(1.0, 1.0); count], None)
    }

    /// The links, from the top down.
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// The cart's mass, kg.
    pub fn cart(&self) -> Option<f64> {
        self.cart
    }

    /// Number of coordinates before the first angle: 1 with a cart.
    fn offset(&self) -> usize {
        usize::from(self.cart.is_some())
    }

    fn mass_matrix(&self, angles: &[(f64, f64)]) -> DMatrix<f64> {
        let first = self.offset();
        let total = || self.cart.unwrap_or(0.0) + self.links.iter().map(|link| link.mass).sum::<f64>();
        DMatrix::from_fn(self.coordinates(), self.coordinates(), |row, column| {
            match (row.checked_sub(first), column.checked_sub(first)) {
                (Some(j), Some(k)) => {
                    let ((s_j, c_j), (s_k, c_k)) = (angles[j], angles[k]);
                    self.inertia[(j, k)] * (c_j * c_k + s_j * s_k)
                }
                (Some(j), None) | (None, Some(j)) => self.moments[j] * angles[j].1,
                (None, None) => total(),
            }
        })
    }

    /// Right-hand side of M v̇ = …: gravity and the terms in v².
    fn write_forces(&self, angles: &[(f64, f64)], v: &[f64], out: &mut [f64]) {
        let (cart, joints) = out.split_at_mut(self.offset());
        let squares = || v.iter().skip(self.offset()).map(|v| v * v);
        for (j, out) in joints.iter_mut().enumerate() {
            let (s_j, c_j) = angles[j];
            let turning = angles.iter().zip(squares()).enumerate();
            let turning = turning.map(|(k, ((s, c), v2))| self.inertia[(j, k)] * (s_j * c - c_j * s) * v2);
            let turning: f64 = turning.sum();
            *out = -turning - GRAVITY * self.moments[j] * s_j;
        }
        if let [x] = cart {
            *x = self.moments.iter().zip(angles).zip(squares()).map(|((b, (s, _)), v2)| b * s * v2).sum();
        }
    }

    fn angles(&self, q: &[f64]) -> Vec<(f64, f64)> {
        q.iter().skip(self.offset()).take(self.links.len()).map(|q| q.sin_cos()).collect()
    }
}

impl ExactMotion for Chain {
    fn coordinates(&self) -> usize {
        self.links.len() + self.offset()
    }

    fn is_angle(&self, i: usize) -> bool {
        i >= self.offset()
    }

    fn acceleration(&self, q: &[f64], v: &[f64], out: &mut [f64]) -> Option<()> {
        let n = self.coordinates();
        let (q, v, out) = (q.get(..n)?, v.get(..n)?, out.get_mut(..n)?);
        let angles = self.angles(q);
        self.write_forces(&angles, v, out);
        let factor: Cholesky<f64, Dyn> = Cholesky::new(self.mass_matrix(&angles))?;
        factor.solve_mut(&mut DVectorViewMut::from_slice(out, n));
        Some(())
    }

    fn kinetic_energy(&self, q: &[f64], v: &[f64]) -> f64 {
        let mass = self.mass_matrix(&self.angles(q));
        let momentum = |i: usize| mass.column(i).iter().zip(v).map(|(m, v)| m * v).sum::<f64>();
        v.iter().enumerate().take(self.coordinates()).map(|(i, v)| 0.5 * v * momentum(i)).sum()
    }

    fn potential_energy(&self, q: &[f64]) -> f64 {
        let heights = self.angles(q).into_iter().map(|(_, c)| -c);
        self.moments.iter().zip(heights).map(|(b, y)| GRAVITY * b * y).sum()
    }
}
