//! Instructions of the parts that evaluations are made of.
#![no_std]
#![no_main]

use core::hint::black_box;
use leastaction_chip::instructions::mean;
use leastaction_chip::{image, print};
use leastaction_core::network::{Activation, Dense, Jet};
use leastaction_core::scalar::Scalar;
use leastaction_fpu as fpu;

/// Units of a layer.
const UNITS: usize = 32;
const CALLS: u32 = 200;

/// Prints the instructions of a layer of 32 × 32 with T tangents, forward and back.
fn layer<const T: usize>(names: [&[u8]; 2], dense: &Dense<'_, f32>) {
    let x = black_box([Jet { value: 0.3_f32, tangent: [0.1; T] }; UNITS]);
    let mut y = [Jet::zero(); UNITS];
    let forward = mean(CALLS, || {
        dense.forward(&x, &mut y);
        black_box(&mut y);
    });
    let adjoint = mean(CALLS, || {
        dense.adjoint(&x, &mut y);
        black_box(&mut y);
    });
    print::number(names[0], forward);
    print::number(names[1], adjoint);
}

/// Prints the instructions of one unit of an activation, of 32 with two tangents.
#[inline(always)]
fn activation(name: &[u8], activation: Activation) {
    let z = black_box([Jet { value: 0.3_f32, tangent: [0.1; 2] }; UNITS]);
    let mut slopes = z;
    let count = mean(CALLS, || {
        let mut units = z;
        activation.apply(&mut units, &mut slopes);
        black_box((&mut units, &mut slopes));
    });
    print::number(name, count / UNITS as u32);
}

#[inline(always)]
fn scalar(name: &[u8], mut f: impl FnMut(f32) -> f32) {
    let x = black_box(0.7_f32);
    print::number(name, mean(CALLS, || _ = black_box(f(black_box(x)))));
}

/// Numbers of both signs and many sizes.
fn numbers<const N: usize>() -> [f32; N] {
    let mut bits = 1_u32;
    core::array::from_fn(|_| {
        bits = bits.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let sign_and_fraction = bits & 0x807f_ffff;
        f32::from_bits(sign_and_fraction | (120 + (bits >> 24 & 15)) << 23)
    })
}

/// Whether the loops in the processor's instructions give the bits of plain Rust, for 0 … 24 inputs.
fn loops_agree() -> bool {
    let (weights, x) = (black_box(numbers::<{ 24 * 8 }>()), black_box(numbers::<24>()));
    (0..=24).all(|n| panels_agree(&weights, x.get(..n).unwrap_or(&x)))
}

fn panels_agree(weights: &[f32], x: &[f32]) -> bool {
    let (mut a, mut b) = ([0.5; 8], [0.5; 8]);
    fpu::accumulate_8(weights.as_chunks().0, x, &mut a);
    fpu::portable::accumulate(weights.as_chunks().0, x, &mut b, |w| w);
    let (mut c, mut d) = ([0.25; 4], [0.25; 4]);
    fpu::accumulate_4(weights.as_chunks().0, x, &mut c);
    fpu::portable::accumulate(weights.as_chunks().0, x, &mut d, |w| w);
    let (mut e, mut f, mut g, mut h) = ([1.0; 24], [1.0; 24], [1.0; 24], [1.0; 24]);
    let n = x.len();
    fpu::transposed_8(weights.as_chunks().0, &a, first(&mut e, n));
    fpu::portable::transposed(weights.as_chunks().0, &b, first(&mut f, n), |w| w);
    fpu::transposed_4(weights.as_chunks().0, &c, first(&mut g, n));
    fpu::portable::transposed(weights.as_chunks().0, &d, first(&mut h, n), |w| w);
    let root = x.iter().all(|x| same(&[fpu::sqrt(*x)], &[fpu::portable::sqrt(*x)]));
    root && same(&a, &b) && same(&c, &d) && same(&e, &f) && same(&g, &h)
}

fn first(x: &mut [f32], n: usize) -> &mut [f32] {
    x.get_mut(..n).unwrap_or_default()
}

/// Whether two slices have the same bits; one NaN is as good as another.
fn same(a: &[f32], b: &[f32]) -> bool {
    a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan()))
}

fn run() -> Result<(), &'static [u8]> {
    if !loops_agree() {
        return Err(b"the loops in the processor's instructions differ from plain Rust");
    }
    static WEIGHTS: [f32; UNITS * (UNITS + 1)] = [0.125; UNITS * (UNITS + 1)];
    let dense =
        Dense::take(&mut black_box(&WEIGHTS[..]), UNITS, UNITS).ok_or(b"too few weights".as_slice())?;
    layer::<0>([b"forward_0", b"adjoint_0"], &dense);
    layer::<1>([b"forward_1", b"adjoint_1"], &dense);
    layer::<2>([b"forward_2", b"adjoint_2"], &dense);
    activation(b"tanh", Activation::Tanh);
    activation(b"softplus", Activation::Softplus);
    activation(b"squareplus", Activation::Squareplus);
    activation(b"isru", Activation::Isru);
    scalar(b"sin_cos", |x| {
        let (sin, cos) = Scalar::sin_cos(x);
        black_box(cos);
        sin
    });
    scalar(b"sin", |x| Scalar::sin_cos(x).0);
    scalar(b"sqrt", Scalar::sqrt);
    scalar(b"nothing", |x| x);
    Ok(())
}

image!(run);
