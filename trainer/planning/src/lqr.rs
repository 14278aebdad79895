//! Linear regulators of systems whose size is known at run time.

use nalgebra::DMatrix;
use thiserror::Error;

/// Reason why there is no regulator.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum LqrError {
    /// A matrix does not fit the others.
    #[error(
        "{name} is a matrix of {} × {} numbers; it must have {} × {}", found.0, found.1, needed.0, needed.1
    )]
    Shape {
        /// Name of the matrix.
        name: &'static str,
        /// Rows and columns given.
        found: (usize, usize),
        /// Rows and columns needed.
        needed: (usize, usize),
    },
    /// A matrix has a number that is infinite or not a number.
    #[error("{name} has a number in row {row}, column {column} (from 0) that is not finite")]
    NotFinite {
        /// Name of the matrix.
        name: &'static str,
        /// Row, from 0.
        row: usize,
        /// Column, from 0.
        column: usize,
    },
    /// Weights do not measure a cost.
    #[error("{name} must be symmetric and {needed}")]
    Weights {
        /// Name of the matrix.
        name: &'static str,
        /// Property that is missing besides symmetry.
        needed: &'static str,
    },
    /// A motion grows that no feedback reaches.
    #[error(
        "no feedback of these controls stabilises the system: they do not reach a motion that does not die out"
    )]
    NotStabilisable,
    /// A motion that does not die out costs nothing.
    #[error(
        "Q does not see a motion that does not die out by itself: give the states that it moves a weight"
    )]
    Unseen,
    /// A delay that is not between 0 and the longest one.
    #[error("a delay of {steps} steps: it must be between 0 and {MAX_DELAY} steps; take longer steps")]
    Delay {
        /// The delay, steps.
        steps: f64,
    },
    /// A step without a half.
    #[error(
        "A has a real eigenvalue that is negative or 0, so that no part of a step is known: give a delay of whole steps, or take shorter \
         steps"
    )]
    NoFraction,
    /// A time constant that is negative or not finite.
    #[error("a lag of {steps} steps: it must be finite, 0 or above")]
    Lag {
        /// The time constant, steps.
        steps: f64,
    },
    /// A step whose inside is not known.
    #[error(
        "A has a real eigenvalue that is negative or 0, so that the motion within a step, behind a lag, is not known: take shorter steps"
    )]
    NoMotion,
}

/// Longest delay, steps.
pub const MAX_DELAY: usize = 256;

/// A linear system in discrete time: x⁺ = A x + B u.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearSystem {
    pub(crate) a: DMatrix<f64>,
    pub(crate) b: DMatrix<f64>,
}

/// A regulator u = −K x, and the cost xᵀPx that remains under it.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearRegulator {
    /// Gain K.
    pub gain: DMatrix<f64>,
    /// P, symmetric.
    pub cost: DMatrix<f64>,
}

impl LinearSystem {
    /// A system from its matrices.
    ///
    /// # Errors
    /// [`LqrError::Shape`], [`LqrError::NotFinite`].
    pub fn new(a: DMatrix<f64>, b: DMatrix<f64>) -> Result<Self, LqrError> {
        let states = a.nrows();
        check("A", &a, (states, states))?;
        check("B", &b, (states, b.ncols()))?;
        Ok(Self { a, b })
    }

    /// A = ∂x⁺/∂x.
    pub fn a(&self) -> &DMatrix<f64> {
        &self.a
    }

    /// B = ∂x⁺/∂u.
    pub fn b(&self) -> &DMatrix<f64> {
        &self.b
    }

    /// A − BK.
    pub fn closed_loop(&self, gain: &DMatrix<f64>) -> DMatrix<f64> {
        &self.a - &self.b * gain
    }

    /// Regulator that minimises Σ xᵀQx + uᵀRu: P solves P = Q + AᵀP(I + BR⁻¹BᵀP)⁻¹A, by the structure-preserving doubling of
    /// [`stationary`](leastaction_core::control::riccati::stationary).
    ///
    /// # Errors
    /// [`LqrError`].
    pub fn regulator(&self, q: &DMatrix<f64>, r: &DMatrix<f64>) -> Result<LinearRegulator, LqrError> {
        let (states, controls) = self.b.shape();
        check("Q", q, (states, states))?;
        check("R", r, (controls, controls))?;
        check_symmetric("Q", "positive semidefinite", q)?;
        check_symmetric("R", "positive definite", r)?;
        let missing = LqrError::Weights { name: "Q", needed: "positive semidefinite" };
        if q.symmetric_eigenvalues().iter().any(|w| *w < -ROUNDING * q.amax()) {
            return Err(missing);
        }
        let factor = r.clone().cholesky();
        let factor = factor.ok_or(LqrError::Weights { name: "R", needed: "positive definite" })?;
        let reach = &self.b * factor.solve(&self.b.transpose());
        let cost = Doubling { a: self.a.clone(), g: symmetric(reach), p: q.clone() }.solve()?;
        self.back(q, r, &cost)
    }

    /// One step backwards in time: K = (R + BᵀPB)⁻¹BᵀPA, P ← Q + AᵀP(A − BK).
    fn back(
        &self,
        q: &DMatrix<f64>,
        r: &DMatrix<f64>,
        end: &DMatrix<f64>,
    ) -> Result<LinearRegulator, LqrError> {
        let to_end = self.b.transpose() * end;
        let factor = symmetric(r + &to_end * &self.b).cholesky().ok_or(LqrError::NotStabilisable)?;
        let gain = factor.solve(&(to_end * &self.a));
        let cost = symmetric(q + self.a.transpose() * end * self.closed_loop(&gain));
        Ok(LinearRegulator { gain, cost })
    }
}

/// Relative asymmetry and negative eigenvalues that count as rounding.
const ROUNDING: f64 = 1e-9;

pub(crate) fn check(
    name: &'static str,
    matrix: &DMatrix<f64>,
    needed: (usize, usize),
) -> Result<(), LqrError> {
    let found = matrix.shape();
    if found != needed {
        return Err(LqrError::Shape { name, found, needed });
    }
    match matrix.iter().position(|x| !x.is_finite()) {
        Some(place) => Err(LqrError::NotFinite { name, row: place % found.0, column: place / found.0 }),
        None => Ok(()),
    }
}

fn check_symmetric(name: &'static str, needed: &'static str, matrix: &DMatrix<f64>) -> Result<(), LqrError> {
    let skew = (matrix - matrix.transpose()).amax();
    if skew <= ROUNDING * matrix.amax() { Ok(()) } else { Err(LqrError::Weights { name, needed }) }
}

/// ½(X + Xᵀ), so that rounding cannot build up an antisymmetric part.
fn symmetric(x: DMatrix<f64>) -> DMatrix<f64> {
    0.5 * (&x + x.transpose())
}

/// State of structure-preserving doubling: after k of them P is the cost of 2ᵏ steps, and A their closed loop.
struct Doubling {
    a: DMatrix<f64>,
    g: DMatrix<f64>,
    p: DMatrix<f64>,
}

/// Maximum number of doublings: 40 look 2⁴⁰ steps ahead.
const MAX_DOUBLINGS: usize = 40;
/// Largest entry of the closed loop over all steps that counts as none. It falls quadratically.
const VANISHED: f64 = 1e-8;

impl Doubling {
    /// P, when it no longer changes and no motion is left.
    fn solve(mut self) -> Result<DMatrix<f64>, LqrError> {
        let mut settled = false;
        for _ in 0..MAX_DOUBLINGS {
            let Some(change) = self.double() else { break };
            settled = change <= 16.0 * f64::EPSILON * self.p.amax() && self.p.iter().all(|x| x.is_finite());
            if settled && self.a.amax() <= VANISHED {
                return Ok(self.p);
            }
            if !self.a.iter().chain(&self.g).chain(&self.p).all(|x| x.is_finite()) {
                break;
            }
        }
        Err(if settled { LqrError::Unseen } else { LqrError::NotStabilisable })
    }

    /// With W = (I + GP)⁻¹: A ← AWA, G ← G + AWGAᵀ, P ← P + AᵀPWA. Returns the largest change of P; `None` if W does not exist.
    fn double(&mut self) -> Option<f64> {
        let size = self.a.nrows();
        let through = DMatrix::identity(size, size) + &self.g * &self.p;
        let solved = through.lu();
        let (wa, wg) = (solved.solve(&self.a)?, solved.solve(&self.g)?);
        let added = symmetric(self.a.transpose() * (&self.p * &wa));
        self.g = symmetric(&self.g + &self.a * wg * self.a.transpose());
        self.p += &added;
        self.a = &self.a * wa;
        Some(added.amax())
    }
}
