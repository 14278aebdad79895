//! The loops in plain Rust, for any scalar and panels of any width: the reference for the instruction loops.

pub use crate::trigonometry::sin_cos;
use core::ops::{AddAssign, Mul};

/// See [`sqrt`](crate::sqrt).
#[inline(always)]
pub fn sqrt(x: f32) -> f32 {
    libm::sqrtf(x)
}

/// See [`widened`](crate::widened).
#[inline(always)]
pub fn widened(w: crate::f16) -> f32 {
    w.to_f32()
}

/// See [`accumulate_8`](crate::single::accumulate_8); `scalar` converts a stored weight.
#[inline(always)]
pub fn accumulate<S, W, const P: usize>(rows: &[[W; P]], x: &[S], sum: &mut [S; P], scalar: impl Fn(W) -> S)
where
    S: Copy + Mul<Output = S> + AddAssign,
    W: Copy,
{
    let mut add = |row: &[W; P], x: &S| {
        for (sum, w) in sum.iter_mut().zip(row) {
            *sum += scalar(*w) * *x;
        }
    };
    // With a single sum the loop body would be too short, so it takes four inputs per turn.
    let (row_fours, row_rest) = if P == 1 { rows.as_chunks::<4>() } else { (&[][..], rows) };
    let (x_fours, x_rest) = if P == 1 { x.as_chunks::<4>() } else { (&[][..], x) };
    for (rows, x) in row_fours.iter().zip(x_fours) {
        rows.iter().zip(x).for_each(|(row, x)| add(row, x));
    }
    row_rest.iter().zip(x_rest).for_each(|(row, x)| add(row, x));
}

/// See [`transposed_8`](crate::single::transposed_8); `scalar` converts a stored weight.
#[inline(always)]
pub fn transposed<S, W, const P: usize>(
    rows: &[[W; P]],
    y_bar: &[S; P],
    x_bar: &mut [S],
    scalar: impl Fn(W) -> S,
) where
    S: Copy + Mul<Output = S> + AddAssign,
    W: Copy,
{
    for (x, row) in x_bar.iter_mut().zip(rows) {
        *x += dot(&row.map(&scalar), y_bar);
    }
}

/// Σ_l a_l b_l, added in halves: lane l with lane l + P/2, and so on; the order in which vector registers fold.
#[inline(always)]
pub fn dot<S: Copy + Mul<Output = S> + AddAssign, const P: usize>(a: &[S; P], b: &[S; P]) -> S {
    let mut product = *a;
    for (p, b) in product.iter_mut().zip(b) {
        *p = *p * *b;
    }
    let mut width = P / 2;
    while width > 0 {
        for l in 0..width {
            product[l] += product[l + width];
        }
        width /= 2;
    }
    product[0]
}
