//! Exact systems of particles: masses, uniform gravity, springs, a kinetic energy that need not be quadratic, and drag.

use leastaction_core::constraints::{Constrained, Holonomic};
use leastaction_core::discrete::rattle::{ParticleState, Rattle};
use leastaction_core::lagrangian::Energies;
use leastaction_core::linear::dot;
use leastaction_core::particles::Particles;
use leastaction_core::scalar::Real;

/// V = ½k(|d| − ℓ)² between two nodes.
#[derive(Clone, Copy, Debug)]
pub struct Spring<R> {
    pub nodes: [usize; 2],
    pub stiffness: R,
    pub rest: R,
}

/// T = Σ ½m|v|² + ¼s|v|⁴, V = −Σ m g·q + springs, Q = −(a v + b v³) by component.
#[derive(Clone, Debug)]
pub struct Exact<R, const D: usize> {
    pub masses: Vec<R>,
    pub gravity: [R; D],
    pub springs: Vec<Spring<R>>,
    pub stiffening: R,
    pub drag: [R; 2],
}

impl<R: Real, const D: usize> Exact<R, D> {
    /// Masses under gravity along the second axis.
    pub fn under_gravity(masses: &[f64], gravity: f64) -> Self {
        Self {
            masses: masses.iter().map(|m| R::constant(*m)).collect(),
            gravity: core::array::from_fn(|i| R::constant(if i == 1 { -gravity } else { 0.0 })),
            springs: vec![],
            stiffening: R::zero(),
            drag: [R::zero(); 2],
        }
    }

    /// A ring of springs of 1 m between neighbours.
    pub fn ring(nodes: usize) -> Self {
        let mut ring = Self::under_gravity(&vec![1.0; nodes], 0.0);
        ring.springs = (0..nodes)
            .map(|i| Spring { nodes: [i, (i + 1) % nodes], stiffness: R::constant(7.0), rest: R::one() })
            .collect();
        ring
    }

    /// This system with nonzero s and drag.
    pub fn hard(mut self) -> Self {
        self.stiffening = R::constant(0.3);
        self.drag = [R::constant(0.2), R::constant(0.05)];
        self
    }

    /// The system in double precision.
    pub fn in_f64(&self) -> Exact<f64, D> {
        let spring =
            |s: &Spring<R>| Spring { nodes: s.nodes, stiffness: s.stiffness.to_f64(), rest: s.rest.to_f64() };
        Exact {
            masses: self.masses.iter().map(|m| m.to_f64()).collect(),
            gravity: self.gravity.map(R::to_f64),
            springs: self.springs.iter().map(spring).collect(),
            stiffening: self.stiffening.to_f64(),
            drag: self.drag.map(R::to_f64),
        }
    }
}

fn apart<R: Real, const D: usize>(q: &[[R; D]], [a, b]: [usize; 2]) -> ([R; D], R) {
    let d: [R; D] = core::array::from_fn(|i| q[a][i] - q[b][i]);
    (d, dot(&d, &d).sqrt())
}

impl<R: Real, const D: usize> Particles<R, D> for Exact<R, D> {
    fn nodes(&self) -> usize {
        self.masses.len()
    }

    fn workspace(&self) -> usize {
        0
    }

    fn energies(&self, q: &[[R; D]], v: &[[R; D]], _: &mut [R]) -> Energies<R> {
        let mut e = Energies { kinetic: R::zero(), potential: R::zero() };
        for ((q, v), m) in q.iter().zip(v).zip(&self.masses) {
            let square = dot(v, v);
            e.kinetic += (*m * square + self.stiffening.half() * square * square).half();
            e.potential -= *m * dot(q, &self.gravity);
        }
        for spring in &self.springs {
            let stretch = apart(q, spring.nodes).1 - spring.rest;
            e.potential += spring.stiffness.half() * stretch * stretch;
        }
        e
    }

    fn l_q(&self, q: &[[R; D]], _: &mut [R], l_q: &mut [[R; D]]) {
        for (l_q, m) in l_q.iter_mut().zip(&self.masses) {
            *l_q = self.gravity.map(|g| *m * g);
        }
        for spring in &self.springs {
            let (d, length) = apart(q, spring.nodes);
            let factor = spring.stiffness * (length - spring.rest) / length;
            for i in 0..D {
                l_q[spring.nodes[0]][i] -= factor * d[i];
                l_q[spring.nodes[1]][i] += factor * d[i];
            }
        }
    }

    fn l_v(&self, node: usize, v: &[R; D]) -> [R; D] {
        let m = self.masses[node] + self.stiffening * dot(v, v);
        v.map(|v| m * v)
    }

    fn mass(&self, node: usize, v: &[R; D]) -> [[R; D]; D] {
        let m = self.masses[node] + self.stiffening * dot(v, v);
        let twice = self.stiffening + self.stiffening;
        core::array::from_fn(|i| {
            core::array::from_fn(|j| twice * v[i] * v[j] + if i == j { m } else { R::zero() })
        })
    }

    fn drag(&self, _: usize, v: &[R; D]) -> [R; D] {
        v.map(|v| -(self.drag[0] * v + self.drag[1] * v * v * v))
    }

    fn drag_slope(&self, _: usize, v: &[R; D]) -> [R; D] {
        v.map(|v| -(self.drag[0] + R::constant(3.0) * self.drag[1] * v * v))
    }
}

/// Rods of these lengths from node to node; if `anchored`, the first rod hangs from the origin.
pub fn rods<R: Real, const D: usize>(lengths: &[f64], anchored: bool) -> Vec<Holonomic<R, D>> {
    let length = |k: usize| R::constant(lengths[k]);
    let first = usize::from(anchored);
    let anchor = Holonomic::Anchor { node: 0, to: [R::zero(); D], length: length(0) };
    let rod = |k: usize| Holonomic::Rod { nodes: [k - first, k + 1 - first], length: length(k) };
    let rods = (first..lengths.len()).map(rod);
    anchored.then_some(anchor).into_iter().chain(rods).collect()
}

/// Positions and velocities of a pendulum of rods with the given angles from the downward vertical, and their rates.
pub fn hanging(lengths: &[f64], angles: &[f64], rates: &[f64]) -> (Vec<[f64; 2]>, Vec<[f64; 2]>) {
    let (mut q, mut v) = ([0.0; 2], [0.0; 2]);
    let links = lengths.iter().zip(angles).zip(rates);
    let links = links.map(|((length, angle), rate)| {
        let (sin, cos) = angle.sin_cos();
        q = [q[0] + length * sin, q[1] - length * cos];
        v = [v[0] + length * cos * rate, v[1] + length * sin * rate];
        (q, v)
    });
    links.unzip()
}

/// Vectors in the scalar of a test.
pub fn rounded<R: Real, const D: usize>(x: &[[f64; D]]) -> Vec<[R; D]> {
    x.iter().map(|x| x.map(R::constant)).collect()
}

/// Vectors in double precision.
pub fn exact<R: Real, const D: usize>(x: &[[R; D]]) -> Vec<[f64; D]> {
    x.iter().map(|x| x.map(R::to_f64)).collect()
}

/// T + V in f64 of a state with a quadratic kinetic energy, from position and momentum with their carries.
pub fn energy<R: Real, const D: usize>(system: &Exact<f64, D>, state: &ParticleState<R, D>) -> f64 {
    let whole = |x: &[[R; D]], carry: &[[R; D]]| -> Vec<[f64; D]> {
        let pairs = x.iter().zip(carry);
        pairs.map(|(x, c)| core::array::from_fn(|i| x[i].to_f64() + c[i].to_f64())).collect()
    };
    let (q, p) = (whole(state.q(), state.q_carry()), whole(state.p(), state.p_carry()));
    let v: Vec<_> = p.iter().zip(&system.masses).map(|(p, m)| p.map(|p| p / m)).collect();
    let e = system.energies(&q, &v, &mut []);
    e.kinetic + e.potential
}

/// The largest ||d| − ℓ|/ℓ in f64 of the positions, without their carries.
pub fn rod_error<R: Real, const D: usize>(constraints: &[Holonomic<R, D>], q: &[[R; D]]) -> f64 {
    let q = exact(q);
    let errors = constraints.iter().map(|constraint| match constraint {
        Holonomic::Rod { nodes, length } => apart(&q, *nodes).1 / length.to_f64() - 1.0,
        Holonomic::Anchor { node, to, length } => {
            apart(&[q[*node], to.map(R::to_f64)], [0, 1]).1 / length.to_f64() - 1.0
        }
        Holonomic::Held { node, axis, at } => q[*node][*axis] - at.to_f64(),
    });
    errors.fold(0.0, |largest, error| error.abs().max(largest))
}

/// The workspaces of a state and of the steps, on the host.
pub fn workspaces<R: Real, const D: usize>(
    mechanism: &Constrained<R, Exact<R, D>, [Holonomic<R, D>], D>,
) -> (Vec<R>, Vec<R>) {
    let state = ParticleState::<R, D>::workspace(mechanism.system().nodes(), mechanism.equations());
    (vec![R::zero(); state], vec![R::zero(); Rattle::workspace(mechanism)])
}

/// A⁻¹b by Gaussian elimination with partial pivoting, of any size.
pub fn solve_dense(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    for k in 0..n {
        let pivot = (k..n).max_by(|i, j| a[*i][k].abs().total_cmp(&a[*j][k].abs())).unwrap();
        a.swap(k, pivot);
        b.swap(k, pivot);
        for i in k + 1..n {
            let factor = a[i][k] / a[k][k];
            let above = a[k].clone();
            a[i].iter_mut().zip(above).for_each(|(entry, above)| *entry -= factor * above);
            b[i] -= factor * b[k];
        }
    }
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|j| a[i][j] * b[j]).sum();
        b[i] = (b[i] - known) / a[i][i];
    }
    b
}
