use super::Limits;
use crate::scalar::Real;

/// Fills controls with a random command for every `piece` of them, uniform within limits: a guess that
/// [`RecedingHorizon::propose`](super::RecedingHorizon::propose) may take.
///
/// Numbers of a seed are the same on every machine. A control that is not limited at both sides is 0, or the limit next to it.
pub fn sample<R: Real, const M: usize>(
    seed: u64,
    piece: usize,
    limits: &Limits<R, M>,
    controls: &mut [[R; M]],
) {
    let mut bits = seed;
    for controls in controls.chunks_mut(piece.max(1)) {
        let u = core::array::from_fn(|j| within(limits.least[j], limits.most[j], uniform(&mut bits)));
        controls.fill(u);
    }
}

/// The number that lies a part of the way between two limits.
fn within<R: Real>(least: R, most: R, part: R) -> R {
    let width = most - least;
    if width.is_finite() {
        return least + part * width;
    }
    let [nearest] = Limits { least: [least], most: [most] }.clamped(&[R::zero()]);
    nearest
}

/// The next number in [0, 1), of 24 random bits.
///
/// Source: Steele, Lea and Flood, "Fast splittable pseudorandom number generators", 2014 (SplitMix64).
fn uniform<R: Real>(state: &mut u64) -> R {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^= z >> 31;
    R::constant(((z >> 40) as u32).into()) * R::constant(1.0 / f64::from(1_u32 << 24))
}
