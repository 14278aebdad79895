use super::motion::{BadMechanism, ExactMotion, above_zero};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// A point or a direction of the plane.
type Vector = [f64; 2];

/// Largest number of Newton steps in a projection onto the rods; if the distance is only a rounding error, one step
/// suffices.
const PROJECTIONS: usize = 8;

/// Point masses in the plane, joined by springs and by rods of fixed length: q = (x₁, y₁, x₂, y₂, …), y upwards.
///
/// V = g Σ mᵢ yᵢ + Σ_springs (r² − 1)² (as in LGNN's program; its paper has ½k(r − 1)²) and Q = −c v + F. Every rod has
/// φ = ½(|d|² − ℓ²) = 0, with d the vector from one end to the other. M v̇ = −V_q + Q + Aᵀλ with A = φ_q, and λ follows
/// from A v̇ + |ḋ|² = 0 (LGNN eq. 2, as in its program).
#[derive(Clone, Debug, PartialEq)]
pub struct Truss {
    /// Masses of the nodes, kg.
    pub masses: Vec<f64>,
    /// Acceleration of gravity g along −y, m/s².
    pub gravity: f64,
    /// Springs, as pairs of nodes.
    pub springs: Vec<[usize; 2]>,
    /// The rods.
    pub rods: Vec<Rod>,
    /// Drag c ≥ 0 of every node, N s/m.
    pub drag: f64,
    /// Pulling forces F: nodes with the force on each, N.
    pub pulls: Vec<(usize, Vector)>,
}

/// A massless rod.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rod {
    /// Upper end: a node, or `None` for the origin.
    pub from: Option<usize>,
    /// Node at the other end.
    pub to: usize,
    /// Length ℓ > 0, m.
    pub length: f64,
}

impl Truss {
    /// Free nodes of 1 kg.
    pub fn free(nodes: usize) -> Self {
        Self {
            masses: vec![1.0; nodes],
            gravity: 0.0,
            springs: Vec::new(),
            rods: Vec::new(),
            drag: 0.0,
            pulls: Vec::new(),
        }
    }

    /// Checks that there are nodes with positive masses, that rods and springs connect two of them, and that pulls act on them.
    ///
    /// # Errors
    /// [`BadMechanism`].
    pub fn checked(self) -> Result<Self, BadMechanism> {
        self.masses.iter().enumerate().try_for_each(|(i, &mass)| above_zero(i, "a mass of", mass))?;
        self.rods.iter().try_for_each(|rod| above_zero(rod.to, "a rod of length", rod.length))?;
        let rods = self.rods.iter().map(|rod| [rod.from.unwrap_or(usize::MAX), rod.to]);
        let nodes = self.masses.len();
        let outside = |[a, b]: [usize; 2]| b >= nodes || a == b || (a >= nodes && a != usize::MAX);
        if nodes == 0 {
            return Err(BadMechanism::Empty);
        }
        let pulled = self.pulls.iter().map(|(node, _)| *node).find(|node| *node >= nodes);
        if let Some(element) = pulled {
            let (quantity, range) = ("a pull, but nodes there are", "on one of them");
            return Err(BadMechanism::OutOfRange { element, quantity, value: nodes as f64, range });
        }
        match rods.chain(self.springs.iter().copied()).find(|ends| outside(*ends)) {
            Some([_, to]) => Err(BadMechanism::OutOfRange {
                element: to,
                quantity: "a rod or spring between nodes, of which there are",
                value: nodes as f64,
                range: "between two different ones",
            }),
            None => Ok(self),
        }
    }

    /// Force F on every node, N.
    pub fn pull(&self) -> Vec<[f64; 2]> {
        let mut force = vec![[0.0; 2]; self.masses.len()];
        self.pulls.iter().for_each(|(node, pull)| add(&mut force[*node], 1.0, pull));
        force
    }

    /// Force −V_q + Q on every node.
    fn forces(&self, x: &[Vector], v: &[Vector]) -> Vec<Vector> {
        let own = |(mass, v): (&f64, &Vector)| [-self.drag * v[0], -self.drag * v[1] - mass * self.gravity];
        let mut forces: Vec<Vector> = self.masses.iter().zip(v).map(own).collect();
        for &[a, b] in &self.springs {
            let d = difference(&x[b], &x[a]);
            let pull = 4.0 * (dot(&d, &d) - 1.0);
            add(&mut forces[a], pull, &d);
            add(&mut forces[b], -pull, &d);
        }
        for (node, force) in &self.pulls {
            add(&mut forces[*node], 1.0, force);
        }
        forces
    }

    /// Vector along a rod, from one end to the other, computed from positions or from velocities.
    fn along(&self, rod: &Rod, x: &[Vector]) -> Vector {
        let from = rod.from.map_or([0.0; 2], |from| x[from]);
        difference(&x[rod.to], &from)
    }

    /// Entries of A x, one per rod.
    fn rates(&self, q: &[Vector], x: &[Vector]) -> Vec<f64> {
        self.rods.iter().map(|rod| dot(&self.along(rod, q), &self.along(rod, x))).collect()
    }

    /// Adds M⁻¹Aᵀλ.
    fn add_rods(&self, q: &[Vector], lambda: &DVector<f64>, x: &mut [Vector]) {
        for (rod, lambda) in self.rods.iter().zip(lambda.iter()) {
            let d = self.along(rod, q);
            add(&mut x[rod.to], lambda / self.masses[rod.to], &d);
            if let Some(from) = rod.from {
                add(&mut x[from], -lambda / self.masses[from], &d);
            }
        }
    }

    /// A M⁻¹ Aᵀ, factored; `None` if rods contradict each other.
    fn compliance(&self, q: &[Vector]) -> Option<Cholesky<f64, Dyn>> {
        let of = |rod: &Rod, node: usize| f64::from(rod.to == node) - f64::from(rod.from == Some(node));
        let entry = |i: usize, j: usize| {
            let (a, b) = (&self.rods[i], &self.rods[j]);
            let nodes = [Some(a.to), a.from].into_iter().flatten();
            let shared: f64 = nodes.map(|node| of(a, node) * of(b, node) / self.masses[node]).sum();
            shared * dot(&self.along(a, q), &self.along(b, q))
        };
        Cholesky::new(DMatrix::from_fn(self.rods.len(), self.rods.len(), entry))
    }

    /// Accelerations v̇ and the rods' multipliers λ (N/m: force over length); `None` if rods contradict each other.
    fn motion(&self, q: &[Vector], v: &[Vector]) -> Option<(Vec<Vector>, DVector<f64>)> {
        let forces = self.forces(q, v);
        let mut a: Vec<Vector> = forces.iter().zip(&self.masses).map(|(f, m)| [f[0] / m, f[1] / m]).collect();
        if self.rods.is_empty() {
            return Some((a, DVector::zeros(0)));
        }
        let (bent, pulled) = (self.rates(v, v), self.rates(q, &a));
        let rate = bent.iter().zip(pulled).map(|(bent, pulled)| -(bent + pulled));
        let lambda = self.compliance(q)?.solve(&DVector::from_iterator(self.rods.len(), rate));
        self.add_rods(q, &lambda, &mut a);
        Some((a, lambda))
    }

    /// Tension of each rod, −λℓ, N: positive if the rod pulls its ends together. `None` if rods contradict each other.
    pub fn tensions(&self, q: &[f64], v: &[f64]) -> Option<Vec<f64>> {
        let (_, lambda) = self.motion(q.as_chunks().0, v.as_chunks().0)?;
        Some(lambda.iter().zip(&self.rods).map(|(lambda, rod)| -lambda * rod.length).collect())
    }

    fn project_positions(&self, q: &mut [Vector]) -> Option<()> {
        for _ in 0..PROJECTIONS {
            let phi = |rod: &Rod| {
                let d = self.along(rod, q);
                0.5 * (rod.length * rod.length - dot(&d, &d))
            };
            let missing = DVector::from_iterator(self.rods.len(), self.rods.iter().map(phi));
            if missing.amax() <= f64::EPSILON {
                break;
            }
            let lambda = self.compliance(q)?.solve(&missing);
            let from = q.to_vec();
            self.add_rods(&from, &lambda, q);
        }
        Some(())
    }
}

impl ExactMotion for Truss {
    fn coordinates(&self) -> usize {
        2 * self.masses.len()
    }

    fn is_angle(&self, _i: usize) -> bool {
        false
    }

    fn acceleration(&self, q: &[f64], v: &[f64], out: &mut [f64]) -> Option<()> {
        let n = self.coordinates();
        let (q, v) = (q.get(..n)?.as_chunks().0, v.get(..n)?.as_chunks().0);
        let (a, _) = self.motion(q, v)?;
        out.get_mut(..n)?.copy_from_slice(a.as_flattened());
        Some(())
    }

    fn kinetic_energy(&self, _q: &[f64], v: &[f64]) -> f64 {
        let squares = v.as_chunks::<2>().0.iter().map(|v| dot(v, v));
        self.masses.iter().zip(squares).map(|(m, square)| 0.5 * m * square).sum()
    }

    fn potential_energy(&self, q: &[f64]) -> f64 {
        let x = q.as_chunks::<2>().0;
        let heights: f64 = self.masses.iter().zip(x).map(|(m, x)| m * x[1]).sum();
        let spring = |&[a, b]: &[usize; 2]| {
            let d = difference(&x[b], &x[a]);
            (dot(&d, &d) - 1.0).powi(2)
        };
        self.gravity * heights + self.springs.iter().map(spring).sum::<f64>()
    }

    fn project(&self, state: &mut [f64]) -> Option<()> {
        if self.rods.is_empty() {
            return Some(());
        }
        let (q, v) = state.split_at_mut_checked(self.coordinates())?;
        let (q, v) = (q.as_chunks_mut().0, v.as_chunks_mut().0);
        self.project_positions(q)?;
        let rates = DVector::from_vec(self.rates(q, v));
        let lambda = self.compliance(q)?.solve(&-rates);
        self.add_rods(q, &lambda, v);
        Some(())
    }
}

fn difference(a: &Vector, b: &Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1]]
}

fn dot(a: &Vector, b: &Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn add(x: &mut Vector, c: f64, y: &Vector) {
    *x = [x[0] + c * y[0], x[1] + c * y[1]];
}
