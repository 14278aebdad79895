//! Instruction counts of the parts that make up evaluations.
#![no_std]
#![no_main]

use core::hint::black_box;
use leastaction_chip::instructions::mean;
use leastaction_chip::{image, print};
use leastaction_core::energy::NetworkShape;
use leastaction_core::energy::inertia_network::Coordinate;
use leastaction_core::forces::{
    Coulomb, Dissipation, DryFriction, Forces, PotentialCorrection, Seen, Viscous,
};
use leastaction_core::model::checksum;
use leastaction_core::network::{Activation, Dense, Jet, Units};
use leastaction_core::scalar::{Scalar, WeightFormat, f16};
use leastaction_fpu as fpu;
use micromath::F32Ext;

/// Number of units of a layer.
const UNITS: usize = 32;
const CALLS: u32 = 200;

/// Prints the instructions of a layer of 32 × 32 with T tangents, forward and back.
fn layer<W: WeightFormat<Wide = f32>, const T: usize>(names: [&[u8]; 2], dense: &Dense<'_, W>) {
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

/// Prints the instructions of an activation per unit, for 32 units with two tangents.
#[inline(always)]
fn activation(name: &[u8], activation: Activation) {
    let Some(z) = Units::<_, 2, UNITS>::of(&black_box([Jet { value: 0.3_f32, tangent: [0.1; 2] }; UNITS]))
    else {
        return;
    };
    let (mut units, mut slopes) = (z.clone(), z);
    let count = mean(CALLS, || {
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

/// Prints the instructions of a law of force, for its value and for its value with derivatives, divided by its N coordinates.
#[inline(always)]
fn law<F: Forces<f32, N>, const N: usize>(names: [&[u8]; 2], law: &F) {
    let [value, both] = instructions_of(law);
    print::number(names[0], value / N as u32);
    print::number(names[1], both / N as u32);
}

/// Prints the instructions of a law of force, not divided.
fn law_of_all<F: Forces<f32, N>, const N: usize>(names: [&[u8]; 2], law: &F) {
    let [value, both] = instructions_of(law);
    print::number(names[0], value);
    print::number(names[1], both);
}

/// Instructions of a law of force: for its value, and for its value with derivatives.
#[inline(always)]
fn instructions_of<F: Forces<f32, N>, const N: usize>(law: &F) -> [u32; 2] {
    let at = [core::array::from_fn(|i| 0.3 - 0.1 * i as f32); 3];
    let value = mean(CALLS, || {
        let [q, v, tau] = black_box(&at);
        black_box(black_box(law).force(q, v, tau));
    });
    let both = mean(CALLS, || {
        let ([q, v, tau], law) = (black_box(&at), black_box(law));
        black_box((law.force(q, v, tau), law.derivatives(q, v, tau)));
    });
    [value, both]
}

/// Laws of force of six coordinates: none, damping, and damping with dry friction that grows with the load.
fn laws() {
    const N: usize = 6;
    let viscous = Viscous { coefficients: [0.1; N] };
    let friction = DryFriction { constant: 0.5, load: 0.2, smoothing: 0.1, width: 0.05 };
    law::<_, N>([b"viscous", b"viscous_with_derivatives"], &viscous);
    let friction = (viscous, Coulomb { coordinates: [friction; N] });
    law::<_, N>([b"friction", b"friction_with_derivatives"], &friction);
}

/// Laws of force of two angles with networks of 8 units: dissipation of one angle and of both, and a potential of both.
fn network_laws() -> Option<()> {
    static WEIGHTS: [f32; 96] = [0.125; 96];
    let (one, both) = ([None, Some(Coordinate::Angle)], [Some(Coordinate::Angle); 2]);
    let shape = |inputs, outputs| NetworkShape::new(inputs, &[8], outputs, Activation::Tanh);
    let dissipation = |seen, inputs, outputs| {
        let mut weights = black_box(&WEIGHTS[..]);
        Dissipation::<f32, 2, 8, 1>::take(&mut weights, Seen::new(seen).ok()?, &shape(inputs, outputs)?)
            .ok()?
    };
    let first: [&[u8]; 2] = [b"dissipation_of_one", b"dissipation_of_one_with_derivatives"];
    law_of_all::<_, 2>(first, &dissipation(one, 3, 1)?);
    let second: [&[u8]; 2] = [b"dissipation_of_two", b"dissipation_of_two_with_derivatives"];
    law_of_all::<_, 2>(second, &dissipation(both, 6, 3)?);
    let mut weights = black_box(&WEIGHTS[..]);
    let seen = Seen::new(both).ok()?;
    let potential = PotentialCorrection::<f32, 2, 8, 1>::take(&mut weights, seen, &shape(4, 1)?).ok()??;
    law_of_all::<_, 2>([b"potential_of_two", b"potential_of_two_with_derivatives"], &potential);
    Some(())
}

/// Prints the instructions of our elementary functions, and of micromath's.
fn elementary() {
    let both = |(sin, cos): (f32, f32)| {
        black_box(cos);
        sin
    };
    scalar(b"sin_cos", |x| both(Scalar::sin_cos(x)));
    scalar(b"micromath_sin_cos", |x| both(F32Ext::sin_cos(x)));
    scalar(b"sqrt", Scalar::sqrt);
    scalar(b"micromath_sqrt", F32Ext::sqrt);
    scalar(b"exp", Scalar::exp);
    scalar(b"micromath_exp", F32Ext::exp);
    scalar(b"ln_1p", Scalar::ln_1p);
    scalar(b"micromath_ln", F32Ext::ln);
    scalar(b"nothing", |x| x);
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

/// Checks that the loops in the processor's instructions give the bits of plain Rust, for 0 … 24 inputs, and for
/// weights in half precision at any address. Also checks that both widen every number in half precision to the same
/// bits, and that roots, sines and cosines agree.
fn loops_agree() -> bool {
    let (weights, x) = (black_box(numbers::<{ 24 * 8 }>()), black_box(numbers::<24>()));
    let halves: [f16; 24 * 8 + 1] =
        black_box(core::array::from_fn(|i| f16::from_bits((i * 331 % 0x7c00) as u16)));
    let wide =
        (0..=u16::MAX).map(f16::from_bits).all(|w| same(&[fpu::widened(w)], &[fpu::portable::widened(w)]));
    let roots = x.iter().all(|x| same(&[fpu::sqrt(*x)], &[fpu::portable::sqrt(*x)]));
    let angles = (0..4_000).map(|i| (i as f32 - 2_000.0) * 0.123_456 * if i % 3 == 0 { 41.0 } else { 1.0 });
    let mut angles = angles.chain([0.0, 65_536.0, 65_537.0, f32::INFINITY, f32::NAN]);
    let sines = angles.all(|x| {
        let ((sin, cos), (plain_sin, plain_cos)) = (fpu::sin_cos(x), fpu::portable::sin_cos(x));
        same(&[sin, cos], &[plain_sin, plain_cos])
    });
    wide && sines
        && roots
        && (0..=24).all(|n| {
            let x = x.get(..n).unwrap_or(&x);
            singles_agree(&weights, x) && (0..2).all(|i| halves_agree(halves.get(i..).unwrap_or(&halves), x))
        })
}

/// The loops over weights of one precision.
macro_rules! panels_agree {
    ($name:ident, $precision:ident, $weight:ty, $wide:expr) => {
        fn $name(weights: &[$weight], x: &[f32]) -> bool {
            use fpu::portable::{accumulate, transposed};
            use fpu::$precision::{accumulate_4, accumulate_8, transposed_4, transposed_8};
            let (mut a, mut b) = ([0.5; 8], [0.5; 8]);
            accumulate_8(weights.as_chunks().0, x, &mut a);
            accumulate(weights.as_chunks().0, x, &mut b, $wide);
            let (mut c, mut d) = ([0.25; 4], [0.25; 4]);
            accumulate_4(weights.as_chunks().0, x, &mut c);
            accumulate(weights.as_chunks().0, x, &mut d, $wide);
            let (mut e, mut f, mut g, mut h) = ([1.0; 24], [1.0; 24], [1.0; 24], [1.0; 24]);
            let n = x.len();
            transposed_8(weights.as_chunks().0, &a, first(&mut e, n));
            transposed(weights.as_chunks().0, &b, first(&mut f, n), $wide);
            transposed_4(weights.as_chunks().0, &c, first(&mut g, n));
            transposed(weights.as_chunks().0, &d, first(&mut h, n), $wide);
            same(&a, &b) && same(&c, &d) && same(&e, &f) && same(&g, &h)
        }
    };
}
panels_agree!(singles_agree, single, f32, |w| w);
panels_agree!(halves_agree, half, f16, fpu::portable::widened);

fn first(x: &mut [f32], n: usize) -> &mut [f32] {
    x.get_mut(..n).unwrap_or_default()
}

/// Whether two slices have the same bits; all NaN count as equal.
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
    layer::<_, 0>([b"forward_0", b"adjoint_0"], &dense);
    layer::<_, 1>([b"forward_1", b"adjoint_1"], &dense);
    layer::<_, 2>([b"forward_2", b"adjoint_2"], &dense);
    /// Weights at a multiple of four bytes, like the first layer of a model file; weights at other addresses would be
    /// copied a few rows at a time.
    #[repr(align(4))]
    struct Aligned([f16; UNITS * (UNITS + 1)]);
    static HALVES: Aligned = Aligned([f16::from_bits(0x3000); UNITS * (UNITS + 1)]);
    let dense =
        Dense::take(&mut black_box(&HALVES.0[..]), UNITS, UNITS).ok_or(b"too few weights".as_slice())?;
    layer::<_, 0>([b"forward_f16_0", b"adjoint_f16_0"], &dense);
    layer::<_, 2>([b"forward_f16_2", b"adjoint_f16_2"], &dense);
    activation(b"tanh", Activation::Tanh);
    activation(b"softplus", Activation::Softplus);
    activation(b"squareplus", Activation::Squareplus);
    activation(b"isru", Activation::Isru);
    static BYTES: [u8; 1024] = [0x5a; 1024];
    print::number(b"checksum_of_1024_bytes", mean(CALLS, || _ = black_box(checksum(black_box(&BYTES)))));
    elementary();
    laws();
    network_laws().ok_or(b"a law's network does not fit".as_slice())
}

image!(run);
