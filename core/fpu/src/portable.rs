//! The loops in plain Rust, for panels of any width: what the instructions are held against.

/// See [`sqrt`](crate::sqrt).
#[inline(always)]
pub fn sqrt(x: f32) -> f32 {
    libm::sqrtf(x)
}

/// See [`accumulate_8`](crate::accumulate_8).
#[inline]
pub fn accumulate<const P: usize>(rows: &[[f32; P]], x: &[f32], sum: &mut [f32; P]) {
    for (row, x) in rows.iter().zip(x) {
        for (sum, w) in sum.iter_mut().zip(row) {
            *sum += *w * *x;
        }
    }
}

/// See [`transposed_8`](crate::transposed_8).
#[inline]
pub fn transposed<const P: usize>(rows: &[[f32; P]], y_bar: &[f32; P], x_bar: &mut [f32]) {
    for (x, row) in x_bar.iter_mut().zip(rows) {
        *x += dot(row, y_bar);
    }
}

/// Σ_l a_l b_l, added in halves.
#[inline(always)]
fn dot<const P: usize>(a: &[f32; P], b: &[f32; P]) -> f32 {
    let mut product = *a;
    for (p, b) in product.iter_mut().zip(b) {
        *p *= *b;
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
