//! nalgebra's static vectors and matrices at the public interface, with the feature `nalgebra`.
//!
//! Internally, vectors and matrices are plain arrays, matrices row by row. nalgebra converts vectors from and to arrays itself, but takes
//! the arrays of a matrix for its **columns**: [`matrix`] and [`rows`] keep rows as rows. States, derivatives, controls, transitions and
//! regulators have conversion methods of their own; [`acceleration`] and [`inverse_dynamics`] take and return vectors. Every conversion is
//! a copy on the stack; no number changes.
//!
//! ```
//! use leastaction_core::discrete::{Control, Del, Midpoint, State};
//! use leastaction_core::energy::trigonometric::CARTPOLE;
//! use leastaction_core::forces::System;
//! use leastaction_core::lagrangian::Lagrangian;
//! use leastaction_core::static_vectors::acceleration;
//! use nalgebra::{SVector, vector};
//!
//! let system = System::conservative(CARTPOLE);
//! let (q, v) = (vector![0.0_f32, 0.3], vector![0.1, -0.2]);
//! // M is symmetric, and p = Mv.
//! let mut state = State::from_vectors(&system.lagrangian, &q, &v).unwrap();
//! let mass = system.lagrangian.hessian(&q.into(), &v.into()).mass_matrix();
//! assert!((state.p_vector() - mass * v).norm() < 1e-6);
//!
//! let u = vector![1.0, 0.0];
//! let a: SVector<f32, 2> = acceleration(&system, &q, &v, &u).unwrap();
//! assert!(a.iter().all(|a| a.is_finite()));
//! Del::<f32, Midpoint>::new(0.01).step(&system, &mut state, &Control::from(u)).unwrap();
//! assert!((state.q_vector() - (q + 0.01 * v)).norm() < 1e-3);
//! ```

use crate::continuous::{self, ContinuousState};
use crate::control::{Transition, riccati};
use crate::discrete::{State, StepError};
use crate::forces::{Control, Forces, System};
use crate::lagrangian::{Dynamics, Gradient, Hessian, Lagrangian};
use crate::linear::SolveError;
use crate::scalar::{Real, Scalar};
use nalgebra::{SMatrix, SVector, Scalar as Entry};

/// Creates a matrix from its rows.
pub fn matrix<S: Copy + Entry, const R: usize, const C: usize>(rows: &[[S; C]; R]) -> SMatrix<S, R, C> {
    SMatrix::from_fn(|i, j| rows[i][j])
}

/// The rows of a matrix.
pub fn rows<S: Copy + Entry, const R: usize, const C: usize>(matrix: &SMatrix<S, R, C>) -> [[S; C]; R] {
    core::array::from_fn(|i| core::array::from_fn(|j| matrix[(i, j)]))
}

/// [`continuous::acceleration`] at vectors q, v under the control force u, N or N m.
///
/// # Errors
/// An error if the mass matrix is singular or a number is not finite.
pub fn acceleration<R: Real + Entry, L: Lagrangian<R, N>, F: Forces<R, N>, const N: usize>(
    system: &System<L, F>,
    q: &SVector<R, N>,
    v: &SVector<R, N>,
    u: &SVector<R, N>,
) -> Result<SVector<R, N>, SolveError> {
    continuous::acceleration(system, &array(q), &array(v), &array(u)).map(SVector::from)
}

/// [`continuous::inverse_dynamics`] at vectors: the control force, N or N m, that gives the acceleration.
///
/// # Errors
/// An error if no such control force can be computed.
pub fn inverse_dynamics<R: Real + Entry, L: Lagrangian<R, N>, F: Forces<R, N>, const N: usize>(
    system: &System<L, F>,
    q: &SVector<R, N>,
    v: &SVector<R, N>,
    acceleration: &SVector<R, N>,
) -> Result<SVector<R, N>, StepError<R>> {
    continuous::inverse_dynamics(system, &array(q), &array(v), &array(acceleration)).map(SVector::from)
}

fn array<S: Copy + Entry, const N: usize>(x: &SVector<S, N>) -> [S; N] {
    (*x).into()
}

impl<R: Real + Entry, const N: usize> ContinuousState<R, N> {
    /// Creates the state at q and v.
    pub fn from_vectors(q: &SVector<R, N>, v: &SVector<R, N>) -> Self {
        Self { q: array(q), v: array(v) }
    }

    /// Position q.
    pub fn q_vector(&self) -> SVector<R, N> {
        self.q.into()
    }

    /// Velocity v.
    pub fn v_vector(&self) -> SVector<R, N> {
        self.v.into()
    }
}

impl<R: Real + Entry, const N: usize> State<R, N> {
    /// [`State::new`] at vectors q and v.
    ///
    /// # Errors
    /// An error if a number is not finite.
    pub fn from_vectors<L: Lagrangian<R, N>>(
        lagrangian: &L,
        q: &SVector<R, N>,
        v: &SVector<R, N>,
    ) -> Result<Self, StepError<R>> {
        Self::new(lagrangian, array(q), array(v))
    }

    /// Position q.
    pub fn q_vector(&self) -> SVector<R, N> {
        self.q().into()
    }

    /// Momentum p.
    pub fn p_vector(&self) -> SVector<R, N> {
        self.p().into()
    }
}

impl<S: Scalar + Entry, const N: usize> Gradient<S, N> {
    /// L_q.
    pub fn l_q_vector(&self) -> SVector<S, N> {
        self.l_q.into()
    }

    /// p = L_v.
    pub fn l_v_vector(&self) -> SVector<S, N> {
        self.l_v.into()
    }
}

impl<S: Scalar + Entry, const N: usize> Dynamics<S, N> {
    /// Mass matrix M.
    pub fn mass_matrix(&self) -> SMatrix<S, N, N> {
        matrix(&self.mass)
    }
}

impl<S: Scalar + Entry, const N: usize> Hessian<S, N> {
    /// Mass matrix M = L_vv.
    pub fn mass_matrix(&self) -> SMatrix<S, N, N> {
        matrix(&self.l_vv)
    }

    /// L_qq.
    pub fn l_qq_matrix(&self) -> SMatrix<S, N, N> {
        matrix(&self.l_qq)
    }

    /// L_vq, entry (i, j) = ∂²L/∂v_i∂q_j.
    pub fn l_vq_matrix(&self) -> SMatrix<S, N, N> {
        matrix(&self.l_vq)
    }
}

impl<R: Real + Entry, const D: usize, const M: usize> Transition<R, D, M> {
    /// A = ∂x⁺/∂x.
    pub fn a_matrix(&self) -> SMatrix<R, D, D> {
        matrix(&self.a)
    }

    /// B = ∂x⁺/∂u.
    pub fn b_matrix(&self) -> SMatrix<R, D, M> {
        matrix(&self.b)
    }
}

impl<R: Real + Entry, const D: usize, const M: usize> riccati::Regulator<R, D, M> {
    /// Gain K.
    pub fn gain_matrix(&self) -> SMatrix<R, M, D> {
        matrix(&self.gain)
    }

    /// P, symmetric.
    pub fn cost_matrix(&self) -> SMatrix<R, D, D> {
        matrix(&self.cost)
    }
}

/// Control held over a step.
impl<R: Real + Entry, const N: usize> From<SVector<R, N>> for Control<R, N> {
    fn from(u: SVector<R, N>) -> Self {
        Self::held(array(&u))
    }
}
