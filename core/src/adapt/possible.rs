//! Bodies that are possible: pseudo-inertias J that are positive semidefinite (Wensing, Kim, Slotine 2018).
//!
//! J = [½ tr(I)·1 − I, mc; mcᵀ, m] for the ten numbers of a body in space, and [m·1, mc; mcᵀ, I] for the four of the plane.

use crate::energy::arm::INERTIAL_PARAMETERS;
use crate::linear::{Matrix, identity, transpose};
use crate::scalar::Real;

/// A direction z of unit length along which a pseudo-inertia is least, zᵀJz ≤ 0.
pub(super) struct Cut<R> {
    /// Derivatives of zᵀJz in the inertial numbers, so that zᵀJz = Σ slope_j π_j.
    pub slopes: [R; INERTIAL_PARAMETERS],
}

/// Finds the direction along which the pseudo-inertia of these numbers is most negative; `None` for a body that is possible.
pub(super) fn cut<R: Real>(numbers: &[R]) -> Option<Cut<R>> {
    let (values, vectors) = eigen(pseudo_inertia(numbers)?);
    let pairs = values.iter().zip(&vectors);
    let (least, z) = pairs.reduce(|a, b| if b.0 < a.0 { b } else { a })?;
    let is_possible = *least > R::zero();
    (!is_possible)
        .then(|| Cut { slopes: if numbers.len() == INERTIAL_PARAMETERS { space(*z) } else { plane(*z) } })
}

/// Part of the greatest eigenvalue that a repaired pseudo-inertia has in every direction, so that rounding leaves it possible.
const EDGE: f64 = 1e-5;

/// Replaces numbers by those of the nearest pseudo-inertia that is possible.
pub(super) fn repair<R: Real>(numbers: &mut [R]) {
    if let [m, x, y, i] = numbers {
        let edge = R::one() + R::constant(EDGE);
        *m = m.max(R::constant(EDGE) * (x.abs() + y.abs() + i.abs()));
        *i = i.max(edge * (*x * *x + *y * *y) / *m).max(R::constant(EDGE) * *m);
        return;
    }
    let Some(j) = pseudo_inertia(numbers) else { return };
    let (values, vectors) = eigen(j);
    let mut j = [[R::zero(); 4]; 4];
    let edge = values.iter().fold(R::zero(), |most, value| most.max(*value)) * R::constant(EDGE);
    for (value, z) in values.iter().zip(&vectors) {
        let value = value.max(edge);
        for (row, a) in j.iter_mut().zip(z) {
            row.iter_mut().zip(z).for_each(|(entry, b)| *entry += value * *a * *b);
        }
    }
    let [[a, xy, xz, x], [_, b, yz, y], [_, _, c, z], [_, _, _, m]] = j;
    let repaired = [m, x, y, z, b + c, -xy, a + c, -xz, -yz, a + b];
    numbers.iter_mut().zip(repaired).for_each(|(number, repaired)| *number = repaired);
}

fn pseudo_inertia<R: Real>(numbers: &[R]) -> Option<Matrix<R, 4>> {
    match *numbers {
        [m, x, y, z, xx, xy, yy, xz, yz, zz] => {
            let half = (xx + yy + zz).half();
            Some([[half - xx, -xy, -xz, x], [-xy, half - yy, -yz, y], [-xz, -yz, half - zz, z], [x, y, z, m]])
        }
        [m, x, y, i] => {
            let (zero, one) = (R::zero(), R::one());
            Some([[m, zero, x, zero], [zero, m, y, zero], [x, y, i, zero], [zero, zero, zero, one]])
        }
        _ => None,
    }
}

/// Derivatives of zᵀJz in ten numbers.
fn space<R: Real>([x, y, z, w]: [R; 4]) -> [R; INERTIAL_PARAMETERS] {
    let (twice, half) = (w + w, (x * x + y * y + z * z).half());
    let (minus_x, minus_y) = (-(x + x), -(y + y));
    [
        w * w,
        twice * x,
        twice * y,
        twice * z,
        half - x * x,
        minus_x * y,
        half - y * y,
        minus_x * z,
        minus_y * z,
        half - z * z,
    ]
}

/// Derivatives of zᵀJz in four numbers.
fn plane<R: Real>([x, y, z, _]: [R; 4]) -> [R; INERTIAL_PARAMETERS] {
    let mut slopes = [R::zero(); INERTIAL_PARAMETERS];
    let own = [x * x + y * y, (x + x) * z, (y + y) * z, z * z];
    slopes.iter_mut().zip(own).for_each(|(slope, own)| *slope = own);
    slopes
}

/// Sweeps of Jacobi's method: quadratic convergence makes five enough for four rows, in single and double precision.
const SWEEPS: u8 = 5;

/// Eigenvalues of a symmetric matrix, and its unit eigenvectors as rows, by Jacobi's method.
fn eigen<R: Real>(mut a: Matrix<R, 4>) -> ([R; 4], Matrix<R, 4>) {
    let mut vectors = identity();
    for _ in 0..SWEEPS {
        turn::<R, 0, 1>(&mut a, &mut vectors);
        turn::<R, 0, 2>(&mut a, &mut vectors);
        turn::<R, 0, 3>(&mut a, &mut vectors);
        turn::<R, 1, 2>(&mut a, &mut vectors);
        turn::<R, 1, 3>(&mut a, &mut vectors);
        turn::<R, 2, 3>(&mut a, &mut vectors);
    }
    ([a[0][0], a[1][1], a[2][2], a[3][3]], transpose(&vectors))
}

/// Turns rows and columns P and Q so that the entry between them vanishes.
fn turn<R: Real, const P: usize, const Q: usize>(a: &mut Matrix<R, 4>, vectors: &mut Matrix<R, 4>) {
    let between = a[P][Q];
    if between.abs() <= R::zero() {
        return;
    }
    let one = R::one();
    let ratio = (a[Q][Q] - a[P][P]) / (between + between);
    let size = one / (ratio.abs() + (ratio * ratio + one).sqrt());
    let tangent = if ratio < R::zero() { -size } else { size };
    let cos = one / (tangent * tangent + one).sqrt();
    let sin = tangent * cos;
    for row in a.iter_mut().chain(vectors) {
        (row[P], row[Q]) = (cos * row[P] - sin * row[Q], sin * row[P] + cos * row[Q]);
    }
    let (p, q) = (a[P], a[Q]);
    for i in 0..4 {
        (a[P][i], a[Q][i]) = (cos * p[i] - sin * q[i], sin * p[i] + cos * q[i]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// zᵀJz by the slopes, which is linear in the numbers.
    fn along(cut: &Cut<f64>, numbers: &[f64]) -> f64 {
        cut.slopes.iter().zip(numbers).map(|(slope, number)| slope * number).sum()
    }

    const IMPOSSIBLE: [[f64; 10]; 4] = [
        [-0.1, 0.0, 0.0, 0.0, 0.1, 0.0, 0.1, 0.0, 0.0, 0.1],
        // The first moments are too large for the inertia.
        [2.0, 2.0, 0.0, 0.0, 0.1, 0.0, 0.1, 0.0, 0.0, 0.1],
        // A moment of inertia is more than the sum of the others.
        [2.0, 0.0, 0.0, 0.0, 0.9, 0.0, 0.1, 0.0, 0.0, 0.1],
        [2.0, 0.0, 0.0, 0.0, 0.1, 0.3, 0.1, 0.0, 0.0, 0.1],
    ];
    const IMPOSSIBLE_IN_THE_PLANE: [[f64; 4]; 3] =
        [[-0.1, 0.0, 0.0, 0.1], [2.0, 2.0, 0.1, 0.1], [2.0, 0.0, 0.0, -0.1]];

    #[test]
    fn possible_bodies_have_no_cut() {
        assert!(cut(&[2.0, 0.2, -0.1, 0.3, 0.2, 0.0, 0.25, -0.03, 0.01, 0.15]).is_none());
        assert!(cut(&[2.0, 0.2, -0.1, 0.03]).is_none());
    }

    #[test]
    fn impossible_bodies_are_cut_where_they_are_negative() {
        for numbers in IMPOSSIBLE {
            assert!(along(&cut(&numbers).expect("a cut"), &numbers) < 0.0, "{numbers:?}");
        }
        for numbers in IMPOSSIBLE_IN_THE_PLANE {
            assert!(along(&cut(&numbers).expect("a cut"), &numbers) < 0.0, "{numbers:?}");
        }
    }

    #[test]
    fn impossible_bodies_are_repaired() {
        let least = |numbers: &[f64]| cut(numbers).map_or(0.0, |cut| along(&cut, numbers));
        for mut numbers in IMPOSSIBLE {
            repair(&mut numbers);
            assert!(least(&numbers) > -1e-14, "{numbers:?}");
        }
        for mut numbers in IMPOSSIBLE_IN_THE_PLANE {
            repair(&mut numbers);
            assert!(least(&numbers) > -1e-14, "{numbers:?}");
        }
        let possible = [2.0, 0.2, -0.1, 0.3, 0.2, 0.0, 0.25, -0.03, 0.01, 0.15];
        let mut repaired = possible;
        repair(&mut repaired);
        assert!(possible.iter().zip(repaired).all(|(a, b): (&f64, f64)| (a - b).abs() < 1e-14));
    }
}
