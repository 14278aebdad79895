//! Minimum of a quadratic function of a control within limits.

use super::Limits;
use crate::linear::{Matrix, SolveError, dot, multiply, solve_definite};
use crate::scalar::Real;

/// Bound on the changes of the set of controls at a limit.
const MAX_ROUNDS: usize = 16;
/// Part of the box's width that is near a limit.
const NEAR: f64 = 1e-4;

/// The minimum of ½kᵀHk + gᵀk in a box, and the controls that stay inside it.
#[derive(Clone, Copy, Debug)]
pub struct Minimum<R, const M: usize> {
    /// The minimum k.
    pub k: [R; M],
    /// Flags of the components that are not at a limit.
    pub free: [bool; M],
}

/// Finds the minimum of ½kᵀHk + gᵀk in a box, H positive definite, by projected Newton steps from `start`.
///
/// A round keeps the components at a limit whose slope points outward, and takes Newton's step in the others, cut short by the box. A
/// component that starts all but at such a limit is moved there first: cut short at once, it would spoil the step of the others. The best
/// point of a bounded number of rounds is returned; it is always in the box.
///
/// # Errors
/// [`SolveError`] if H is not positive definite on the free components.
///
/// Source: Tassa, Mansard and Todorov 2014, section III-B; Bertsekas, "Projected Newton methods", 1982.
pub fn minimum<R: Real, const M: usize>(
    h: &Matrix<R, M>,
    g: &[R; M],
    limits: &Limits<R, M>,
    start: &[R; M],
) -> Result<Minimum<R, M>, SolveError> {
    let k = limits.clamped(start);
    let mut k = at_near_limits(&k, &slope(h, g, &k), limits);
    let mut free = [true; M];
    for _ in 0..MAX_ROUNDS {
        let slope = slope(h, g, &k);
        free = free_components(&k, &slope, limits);
        let right = core::array::from_fn(|i| if free[i] { -slope[i] } else { R::zero() });
        let [step] = solve_definite(restricted(h, &free), [right])?;
        let next = searched(h, limits, (&k, &step, &slope));
        let moved = (0..M).any(|i| next[i] != k[i]);
        k = next;
        if !moved {
            break;
        }
    }
    Ok(Minimum { k, free })
}

/// Hk + g.
fn slope<R: Real, const M: usize>(h: &Matrix<R, M>, g: &[R; M], k: &[R; M]) -> [R; M] {
    let product = multiply(h, k);
    core::array::from_fn(|i| product[i] + g[i])
}

/// Moves the components to which the slope points from within a small part of the box's width to their limit.
fn at_near_limits<R: Real, const M: usize>(k: &[R; M], slope: &[R; M], limits: &Limits<R, M>) -> [R; M] {
    core::array::from_fn(|i| {
        let (least, most) = (limits.least[i], limits.most[i]);
        let width = most - least;
        let near = if width.is_finite() { R::constant(NEAR) * width } else { R::zero() };
        match slope[i] >= R::zero() {
            true if k[i] - least <= near => least,
            false if most - k[i] <= near => most,
            _ => k[i],
        }
    })
}

fn free_components<R: Real, const M: usize>(k: &[R; M], slope: &[R; M], limits: &Limits<R, M>) -> [bool; M] {
    core::array::from_fn(|i| {
        let (low, high) = (k[i] <= limits.least[i], k[i] >= limits.most[i]);
        !(low && slope[i] >= R::zero() || high && slope[i] <= R::zero())
    })
}

/// H with the rows and columns of the components that are not free replaced by those of the identity.
pub fn restricted<R: Real, const M: usize>(h: &Matrix<R, M>, free: &[bool; M]) -> Matrix<R, M> {
    core::array::from_fn(|i| {
        core::array::from_fn(|j| match (free[i] && free[j], i == j) {
            (true, _) => h[i][j],
            (false, true) => R::one(),
            (false, false) => R::zero(),
        })
    })
}

/// The clamped point on the step that lowers the function enough; k itself if none of a few does.
fn searched<R: Real, const M: usize>(
    h: &Matrix<R, M>,
    limits: &Limits<R, M>,
    (k, step, slope): (&[R; M], &[R; M], &[R; M]),
) -> [R; M] {
    let mut part = R::one();
    for _ in 0..10 {
        let next = limits.clamped(&core::array::from_fn(|i| k[i] + part * step[i]));
        let change: [R; M] = core::array::from_fn(|i| next[i] - k[i]);
        // The change of the function, exact for a quadratic one.
        let linear = dot(slope, &change);
        let fall = linear + dot(&change, &multiply(h, &change)).half();
        if fall < R::constant(0.1) * linear {
            return next;
        }
        part = part.half();
    }
    *k
}
