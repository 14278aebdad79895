//! What the cross-crate tests and the peer programs share.

use leastaction_core::discrete::{Control, Del, Path, State, StepError};
use leastaction_core::energy::rigid::{Coordinate, Inertia, Rigid, Shape};
use leastaction_core::forces::System;
use leastaction_core::network::Activation;

/// Weights of a cart-pole network with layers 2 → 24 → 24 → 4.
const WEIGHTS: usize = 2 * 24 + 24 + 24 * 24 + 24 + 24 * 4 + 4;

/// Fixed pseudo-random weights in ±0.25, by integer arithmetic alone: the same bits everywhere.
pub fn fixed_weights<const P: usize>() -> [f32; P] {
    let mut x: u32 = 0x9e37_79b9;
    core::array::from_fn(|_| {
        x ^= x << 13;
        x ^= x >> 17;
        x ^= x << 5;
        (x >> 8) as f32 / 33_554_432.0 - 0.25
    })
}

/// FNV-1a over the bits of every position of `steps` f32 DEL steps of h = 10 ms of a fixed network under a square-wave
/// control.
///
/// # Errors
/// Where a step fails, which for this network none does.
pub fn trajectory_hash<P: Path>(steps: usize) -> Result<u64, StepError<f32>> {
    let weights = fixed_weights::<WEIGHTS>();
    let shape = Shape {
        coordinates: [Coordinate::Cyclic, Coordinate::Angle],
        widths: &[24, 24],
        activation: Activation::Tanh,
        inertia: Inertia::Cholesky { epsilon: 1e-9 },
    };
    let lagrangian =
        Rigid::<f32, 2, 24, 2>::take(&mut weights.as_slice(), &shape).ok_or(StepError::NotFinite)?;
    let system = System::conservative(lagrangian);
    let del = Del::<f32, P>::new(0.01);
    let mut state = State::new(&system.lagrangian, [0.1, 0.7], [0.2, -0.4])?;
    let mut hash = 0xcbf2_9ce4_8422_2325;
    for step in 0..steps {
        let u = if step / 64 % 2 == 0 { 0.25 } else { -0.25 };
        del.step(&system, &mut state, &Control::held([u, 0.0]))?;
        for q in state.q() {
            hash = q.to_bits().to_le_bytes().iter().fold(hash, |hash, byte| fnv(hash, *byte));
        }
    }
    Ok(hash)
}

fn fnv(hash: u64, byte: u8) -> u64 {
    (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
}
