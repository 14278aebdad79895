//! One node of the backward pass.

use super::box_newton::{Minimum, minimum, restricted};
use super::riccati::symmetric;
use super::{Diagonal, Limits, Transition};
use crate::linear::{
    Matrix, SolveError, add_scaled, add_scaled_matrix, diagonal, dot, multiply, product, solve_definite,
    transpose,
};
use crate::scalar::Real;

/// Quadratic model of the cost to go: s·δx + ½δxᵀSδx.
#[derive(Clone, Copy, Debug)]
pub struct Value<R, const D: usize> {
    /// Slope s.
    pub slope: [R; D],
    /// Curvature S, symmetric.
    pub curvature: Matrix<R, D>,
}

impl<R: Real, const D: usize> Value<R, D> {
    /// Slope s + Sδx after a change of the state.
    pub fn slope_at(&self, dx: &[R; D]) -> [R; D] {
        add_scaled(&self.slope, R::one(), &multiply(&self.curvature, dx))
    }
}

/// Change of the cost that the quadratic models expect for a part α of all changes: α `linear` + ½α² `quadratic`.
#[derive(Clone, Copy, Debug)]
pub struct Expected<R> {
    linear: R,
    quadratic: R,
}

impl<R: Real> Expected<R> {
    /// No change.
    pub fn nothing() -> Self {
        Self { linear: R::zero(), quadratic: R::zero() }
    }

    /// Adds the change that a node's decision makes.
    pub fn add<const D: usize, const M: usize>(&mut self, model: &NodeModel<R, D, M>, change: &[R; M]) {
        self.linear += dot(&model.u, change);
        self.quadratic += dot(change, &multiply(&model.uu, change));
    }

    /// Expected change for a part α.
    pub fn at(&self, part: R) -> R {
        part * self.linear + part * part * self.quadratic.half()
    }
}

/// Quadratic model, in δx and δu, of a node's cost and of the cost to go at its end.
#[derive(Clone, Copy, Debug)]
pub struct NodeModel<R, const D: usize, const M: usize> {
    x: [R; D],
    u: [R; M],
    xx: Matrix<R, D>,
    ux: [[R; D]; M],
    uu: Matrix<R, M>,
}

/// Change k of a node's control, and its gain K: δu = k − K δx.
#[derive(Clone, Copy, Debug)]
pub struct Decision<R, const D: usize, const M: usize> {
    /// Change k.
    pub change: [R; M],
    /// Gain K.
    pub gain: [[R; D]; M],
}

impl<R: Real, const D: usize, const M: usize> NodeModel<R, D, M> {
    /// Model from the costs of the node's state and control, and the cost to go at its end.
    pub fn new(
        (x, u): (Diagonal<R, D>, Diagonal<R, M>),
        Transition { a, b }: &Transition<R, D, M>,
        end: &Value<R, D>,
    ) -> Self {
        let (a_t, b_t) = (transpose(a), transpose(b));
        let (a_s, b_s) = (product(&a_t, &end.curvature), product(&b_t, &end.curvature));
        Self {
            x: add_scaled(&x.0, R::one(), &multiply(&a_t, &end.slope)),
            u: add_scaled(&u.0, R::one(), &multiply(&b_t, &end.slope)),
            xx: add_scaled_matrix(&diagonal(x.1), R::one(), &product(&a_s, a)),
            ux: product(&b_s, a),
            uu: add_scaled_matrix(&diagonal(u.1), R::one(), &product(&b_s, b)),
        }
    }

    /// The change that minimises the model within `room`, and its dependence on δx, if the end of the node may be left at a cost of
    /// ½`damping`|δx⁺|².
    ///
    /// # Errors
    /// [`SolveError`] if the model is not convex in δu.
    pub fn decide(
        &self,
        damping: R,
        Transition { a, b }: &Transition<R, D, M>,
        (room, start): (&Limits<R, M>, &[R; M]),
    ) -> Result<Decision<R, D, M>, SolveError> {
        let (mut uu, mut ux) = (self.uu, self.ux);
        if damping > R::zero() {
            let b_t = transpose(b);
            uu = add_scaled_matrix(&uu, damping, &product(&b_t, b));
            ux = add_scaled_matrix(&ux, damping, &product(&b_t, a));
        }
        let Minimum { k, free } = minimum(&uu, &self.u, room, start)?;
        let gain = gain(&restricted(&uu, &free), &ux, &free)?;
        Ok(Decision { change: k, gain })
    }

    /// The change that minimises the model without limits, and its dependence on δx; components that are not `free` stay.
    ///
    /// # Errors
    /// [`SolveError`] if the model is not convex in δu.
    pub fn decide_free(&self, free: &[bool; M]) -> Result<Decision<R, D, M>, SolveError> {
        let uu = restricted(&self.uu, free);
        let [change] = solve_definite(uu, [kept(&self.u.map(|u| -u), free)])?;
        Ok(Decision { change, gain: gain(&uu, &self.ux, free)? })
    }

    /// The cost to go at the node's start under a decision.
    pub fn value(&self, Decision { change, gain }: &Decision<R, D, M>) -> Value<R, D> {
        let bent = multiply(&self.uu, change);
        let gain_t = transpose(gain);
        // With δu = k − Kδx: s = x − Kᵀ(u + uu k) + uxᵀk, S = xx + Kᵀuu K − Kᵀux − uxᵀK.
        let by_change = add_scaled(&self.u, R::one(), &bent);
        let slope = add_scaled(&self.x, -R::one(), &multiply(&gain_t, &by_change));
        let slope = add_scaled(&slope, R::one(), &multiply(&transpose(&self.ux), change));
        let half =
            add_scaled_matrix(&product(&self.uu, gain).map(|row| row.map(R::half)), -R::one(), &self.ux);
        let cross = product(&gain_t, &half);
        let cross = add_scaled_matrix(&cross, R::one(), &transpose(&cross));
        Value { slope, curvature: symmetric(&add_scaled_matrix(&self.xx, R::one(), &cross)) }
    }
}

/// Gain K = H⁻¹ u_x of the free components, H restricted to them.
fn gain<R: Real, const D: usize, const M: usize>(
    uu: &Matrix<R, M>,
    ux: &[[R; D]; M],
    free: &[bool; M],
) -> Result<[[R; D]; M], SolveError> {
    let columns = transpose(ux).map(|column| kept(&column, free));
    Ok(transpose(&solve_definite(*uu, columns)?))
}

/// The free components, 0 in place of the others.
fn kept<R: Real, const M: usize>(x: &[R; M], free: &[bool; M]) -> [R; M] {
    core::array::from_fn(|j| if free[j] { x[j] } else { R::zero() })
}
