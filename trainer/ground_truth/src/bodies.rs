use super::motion::{BadMechanism, ExactMotion, above_zero};

/// Point masses in the plane that attract each other: q = (x₁, y₁, x₂, y₂, …), V = −Σ_{i<j} k mᵢ mⱼ / rᵢⱼ.
#[derive(Clone, Debug, PartialEq)]
pub struct Bodies {
    masses: Vec<f64>,
    k: f64,
}

impl Bodies {
    /// Bodies of these masses (kg) with the attraction constant k (N m²/kg²); if it is negative they repel.
    ///
    /// # Errors
    /// [`BadMechanism`] if there is no mass, if a mass is not finite and above 0, or if k is not finite.
    pub fn new(masses: Vec<f64>, k: f64) -> Result<Self, BadMechanism> {
        masses.iter().enumerate().try_for_each(|(i, &mass)| above_zero(i, "a mass of", mass))?;
        if masses.is_empty() {
            return Err(BadMechanism::Empty);
        }
        let (quantity, range) = ("an attraction of", "finite");
        let bad = BadMechanism::OutOfRange { element: 0, quantity, value: k, range };
        if k.is_finite() { Ok(Self { masses, k }) } else { Err(bad) }
    }

    /// Equal masses of 1 kg and k = 1, as in ModLaNet's experiments.
    ///
    /// # Errors
    /// [`BadMechanism`] if `count` is 0.
    pub fn uniform(count: usize) -> Result<Self, BadMechanism> {
        Self::new(vec![1.0; count], 1.0)
    }

    /// The masses, kg.
    pub fn masses(&self) -> &[f64] {
        &self.masses
    }

    /// The attraction constant, N m²/kg².
    pub fn attraction(&self) -> f64 {
        self.k
    }
}

impl ExactMotion for Bodies {
    fn coordinates(&self) -> usize {
        2 * self.masses.len()
    }

    fn is_angle(&self, _i: usize) -> bool {
        false
    }

    fn acceleration(&self, q: &[f64], _v: &[f64], out: &mut [f64]) -> Option<()> {
        let out = out.get_mut(..self.coordinates())?.as_chunks_mut::<2>().0;
        let x = q.get(..self.coordinates())?.as_chunks::<2>().0;
        for (i, a) in out.iter_mut().enumerate() {
            *a = [0.0; 2];
            for (j, mass) in self.masses.iter().enumerate().filter(|&(j, _)| j != i) {
                let d = [x[j][0] - x[i][0], x[j][1] - x[i][1]];
                let squared = d[0] * d[0] + d[1] * d[1];
                let pull = self.k * mass / (squared * squared.sqrt());
                *a = [a[0] + pull * d[0], a[1] + pull * d[1]];
            }
        }
        out.as_flattened().iter().all(|a| a.is_finite()).then_some(())
    }

    fn kinetic_energy(&self, _q: &[f64], v: &[f64]) -> f64 {
        let speeds = v.as_chunks::<2>().0.iter().map(|[x, y]| x * x + y * y);
        self.masses.iter().zip(speeds).map(|(m, squared)| 0.5 * m * squared).sum()
    }

    fn potential_energy(&self, q: &[f64]) -> f64 {
        let bodies: Vec<_> = self.masses.iter().zip(q.as_chunks::<2>().0).collect();
        let below = |j: usize| bodies[..j].iter().map(move |i| (i, j));
        let pairs = (0..bodies.len()).flat_map(below);
        let energy = |((m_i, x_i), j): (&(&f64, &[f64; 2]), usize)| {
            let (m_j, x_j) = bodies[j];
            -self.k * *m_i * m_j / (x_i[0] - x_j[0]).hypot(x_i[1] - x_j[1])
        };
        pairs.map(energy).sum()
    }
}
