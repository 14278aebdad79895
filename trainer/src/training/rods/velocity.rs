//! The velocity at a position, which drag acts with: the second line of a RATTLE step.

use super::blocks::{block, column, finite, set, set_column, set_row};
use super::{Failed, MAX_ITERATIONS, SETTLED};
use crate::architecture::Constraint;
use faer::Mat;
use faer::linalg::solvers::{DenseSolveCore, Solve};
use leastaction_core::forces::{Forces, System};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::linear::{Matrix, add_scaled, add_scaled_matrix, dot, multiply};
use leastaction_core::scalar::max_abs;

/// v with L_v(v) = p + ½h Q(v) + Aᵀμ and A v = 0, the drag, and how v moves.
pub(super) struct Velocity<const N: usize> {
    pub v: [f64; N],
    /// Q(v).
    pub drag: [f64; N],
    /// ∂Q/∂v.
    pub slope: Matrix<f64, N>,
    /// ∂v/∂p.
    pub v_p: Matrix<f64, N>,
    /// ∂v/∂q by the constraints, p held.
    pub v_q: Matrix<f64, N>,
}

/// What determines it.
pub(super) struct Arrival<'a, const N: usize> {
    /// Where.
    pub q: &'a [f64; N],
    /// The constraints there.
    pub constraints: &'a [Constraint<N>],
    /// ½h of the step that arrives, s.
    pub half: f64,
    /// p, kg m/s: what the step has brought but for drag and the constraints.
    pub momentum: [f64; N],
    /// The first guess of v.
    pub guess: [f64; N],
}

impl<const N: usize> Arrival<'_, N> {
    /// Newton's method for v and μ together.
    pub fn velocity<L, F>(&self, system: &System<L, F>) -> Result<Velocity<N>, Failed>
    where
        L: Lagrangian<f64, N>,
        F: Forces<f64, N>,
    {
        let (mut v, mut mu) = (self.guess, vec![0.0; self.constraints.len()]);
        let mut scale = max_abs(&self.momentum);
        for _ in 0..MAX_ITERATIONS {
            let d = system.lagrangian.dynamics(self.q, &v);
            // The drag of graphs does not see the control force.
            let slope = system.forces.derivatives(self.q, &v, &[0.0; N]).1;
            let drag = system.forces.force(self.q, &v, &[0.0; N]);
            scale = scale.max(max_abs(&d.l_v));
            let matrix = self.matrix(&add_scaled_matrix(&d.mass, -self.half, &slope)).partial_piv_lu();
            let change = finite(matrix.solve(self.owed(&d.l_v, &drag, &v, &mu)))?;
            let dv = column(&change, (0, 0));
            v = add_scaled(&v, 1.0, &dv);
            mu.iter_mut().enumerate().for_each(|(k, mu)| *mu -= change[(N + k, 0)]);
            if max_abs(&multiply(&d.mass, &dv)) <= SETTLED * scale {
                let inverse = finite(matrix.inverse())?;
                let (v_p, v_q) = (block(&inverse, (0, 0)), self.v_q(&inverse, &v, &mu));
                return Ok(Velocity { v, drag: system.forces.force(self.q, &v, &[0.0; N]), slope, v_p, v_q });
            }
        }
        Err(Failed)
    }

    /// [[M − ½h Q_v, Aᵀ], [A, 0]], of v and −μ.
    fn matrix(&self, mass: &Matrix<f64, N>) -> Mat<f64> {
        let size = N + self.constraints.len();
        let mut matrix = Mat::zeros(size, size);
        set(&mut matrix, (0, 0), mass);
        for (k, constraint) in (N..).zip(self.constraints) {
            set_row(&mut matrix, (k, 0), &constraint.gradient);
            set_column(&mut matrix, (0, k), &constraint.gradient);
        }
        matrix
    }

    /// What both equations still lack.
    fn owed(&self, l_v: &[f64; N], drag: &[f64; N], v: &[f64; N], mu: &[f64]) -> Mat<f64> {
        let mut owed = Mat::zeros(N + mu.len(), 1);
        let mut momentum = add_scaled(&add_scaled(&self.momentum, self.half, drag), -1.0, l_v);
        for ((k, constraint), mu) in self.constraints.iter().enumerate().zip(mu) {
            momentum = add_scaled(&momentum, *mu, &constraint.gradient);
            owed[(N + k, 0)] = -dot(&constraint.gradient, v);
        }
        set_column(&mut owed, (0, 0), &momentum);
        owed
    }

    /// As q moves, Aᵀμ turns, and so does what A v is to vanish.
    fn v_q(&self, inverse: &Mat<f64>, v: &[f64; N], mu: &[f64]) -> Matrix<f64, N> {
        let compliance: Matrix<f64, N> = block(inverse, (0, 0));
        let turned = turned(self.constraints, mu);
        let mut v_q = std::array::from_fn(|i| multiply(&turned, &compliance[i]));
        for (k, constraint) in self.constraints.iter().enumerate() {
            let (lever, rate): ([f64; N], _) =
                (column(inverse, (0, N + k)), multiply(&constraint.hessian, v));
            for (row, lever) in v_q.iter_mut().zip(lever) {
                *row = add_scaled(row, -lever, &rate);
            }
        }
        v_q
    }
}

/// ∂(Aᵀλ)/∂q = Σ λ φ_qq, symmetric.
pub(super) fn turned<const N: usize>(constraints: &[Constraint<N>], lambda: &[f64]) -> Matrix<f64, N> {
    let add = |sum, (constraint, lambda): (&Constraint<N>, &f64)| {
        add_scaled_matrix(&sum, *lambda, &constraint.hessian)
    };
    constraints.iter().zip(lambda).fold([[0.0; N]; N], add)
}
