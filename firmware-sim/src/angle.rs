use leastaction_core::scalar::Real;

/// The angle in [−π, π] that differs from `x` by whole turns, rad.
pub fn wrap(x: f32) -> f32 {
    x.short_way()
}

/// `x` with its angles wrapped; `angle` marks the angles.
pub fn wrap_where<const N: usize>(x: &[f32; N], angle: &[bool; N]) -> [f32; N] {
    core::array::from_fn(|i| if angle[i] { wrap(x[i]) } else { x[i] })
}

/// The difference a − b with angles wrapped.
pub(crate) fn difference<const N: usize>(a: &[f32; N], b: &[f32; N], angle: &[bool; N]) -> [f32; N] {
    wrap_where(&core::array::from_fn(|i| a[i] - b[i]), angle)
}
