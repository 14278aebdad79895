//! Time of one acceleration and one discrete Euler–Lagrange (DEL) step on a cart-pole network, and of the elementary
//! functions, in f32 and f64.
//!
//! `cargo bench -p leastaction-core` prints divan's statistics, then a table: multiply-adds counted by running the same
//! code on a counting scalar, and their share of the peak that this machine reaches with the same target features.

mod cases;
mod counted;
mod peak;
mod table;

use cases::{Network, del_step};
use divan::Bencher;
use divan::counter::ItemsCount;
use leastaction_core::discrete::{Galerkin, Midpoint};
use leastaction_core::scalar::Real;
use std::hint::black_box;

/// Units in each of two hidden layers.
const WIDTHS: [usize; 2] = [32, 24];

fn main() {
    divan::main();
    // Cargo passes it when it benchmarks, and not when it tests.
    if std::env::args().any(|argument| argument == "--bench") {
        table::print();
    }
}

#[divan::bench(types = [f32, f64], args = WIDTHS)]
fn acceleration<R: cases::Plain>(bencher: Bencher, width: usize) {
    let network = Network::<R>::new(width);
    let system = network.system();
    bencher.bench_local(|| cases::acceleration::<R>(&system, black_box(&cases::state())));
}

#[divan::bench(types = [f32, f64], args = WIDTHS)]
fn del_step_order_2<R: cases::Plain>(bencher: Bencher, width: usize) {
    let network = Network::<R>::new(width);
    let system = network.system();
    let state = cases::moving(&system);
    bencher.bench_local(|| del_step::<R, Midpoint>(&system, black_box(state)));
}

#[divan::bench(types = [f32, f64], args = WIDTHS)]
fn del_step_order_4<R: cases::Plain>(bencher: Bencher, width: usize) {
    let network = Network::<R>::new(width);
    let system = network.system();
    let state = cases::moving(&system);
    bencher.bench_local(|| del_step::<R, Galerkin>(&system, black_box(state)));
}

#[divan::bench(types = [f32, f64])]
fn tanh<R: Real>(bencher: Bencher) {
    let mut angles = cases::angles::<R>();
    bencher.counter(ItemsCount::new(angles.len())).bench_local(move || cases::tanh(black_box(&mut angles)));
}

#[divan::bench(types = [f32, f64])]
fn sin_cos<R: Real>(bencher: Bencher) {
    let mut angles = cases::angles::<R>();
    bencher
        .counter(ItemsCount::new(angles.len()))
        .bench_local(move || cases::sin_cos(black_box(&mut angles)));
}
