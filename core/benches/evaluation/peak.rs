//! Peak rate of multiplications and additions of this machine in one thread, with the target features that the program was compiled for,
//! without fused multiply-adds: they round differently, and the crate never uses them.

use leastaction_core::scalar::Scalar;
use std::hint::black_box;
use std::time::Instant;

const ITERATIONS: u32 = 20_000;

/// Seconds of the fastest of several calls.
pub fn fastest<O>(repetitions: u32, mut call: impl FnMut() -> O) -> f64 {
    let mut once = || {
        let start = Instant::now();
        black_box(call());
        start.elapsed().as_secs_f64()
    };
    (0..repetitions).map(|_| once()).fold(f64::INFINITY, f64::min)
}

/// Multiplications and additions per second: the best of several numbers of independent chains x ← ax + b.
pub fn flops<S: Scalar>() -> f64 {
    [chains::<S, 16>(), chains::<S, 32>(), chains::<S, 48>(), chains::<S, 96>(), chains::<S, 192>()]
        .into_iter()
        .fold(0.0, f64::max)
}

fn chains<S: Scalar, const CHAINS: usize>() -> f64 {
    let seconds = fastest(50, || iterate::<S, CHAINS>(black_box([S::one(); CHAINS])));
    2.0 * CHAINS as f64 * f64::from(ITERATIONS) / seconds
}

#[inline(never)]
fn iterate<S: Scalar, const CHAINS: usize>(mut x: [S; CHAINS]) -> [S; CHAINS] {
    let (a, b) = black_box((S::constant(0.999), S::constant(1e-3)));
    for _ in 0..ITERATIONS {
        for x in &mut x {
            *x = *x * a + b;
        }
    }
    x
}
