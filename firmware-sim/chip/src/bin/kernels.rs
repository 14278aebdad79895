//! Instructions of the parts that evaluations are made of.
#![no_std]
#![no_main]

use core::hint::black_box;
use leastaction_chip::instructions::mean;
use leastaction_chip::{image, print};
use leastaction_core::network::{Activation, Dense, Jet};
use leastaction_core::scalar::Scalar;

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

fn scalar(name: &[u8], mut f: impl FnMut(f32) -> f32) {
    let x = black_box(0.7_f32);
    print::number(name, mean(CALLS, || _ = black_box(f(black_box(x)))));
}

fn run() -> Result<(), &'static [u8]> {
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
