//! Time of one acceleration and one discrete Euler–Lagrange (DEL) step on a cart-pole network and on chains of learned
//! pendulums, and of the elementary functions, in f32 and f64.
//!
//! `cargo bench -p leastaction-core` prints divan's statistics, then a table: multiply-adds counted by running the same
//! code on a counting scalar, and their share of the peak that this machine reaches with the same target features.
//!
//! `benches/evaluation/instructions.sh` prints the instructions of one call for chains of 2 to 8 pendulums.

mod cases;
mod chain;
#[path = "../../../trainer/cost/src/counted.rs"]
mod counted;
mod instructions;
mod peak;
mod table;

use cases::{CARTPOLE_STEP, Network, del_step};
use chain::{Links, STEP};
use divan::Bencher;
use divan::counter::ItemsCount;
use leastaction_core::discrete::{Galerkin, Midpoint, Path};
use leastaction_core::scalar::Real;
use std::hint::black_box;

/// Units in each of two hidden layers.
const WIDTHS: [usize; 2] = [32, 24];

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    if instructions::run(&arguments) {
        return;
    }
    divan::main();
    // Cargo passes `--bench` for a benchmark, but not for a test.
    if arguments.iter().any(|argument| argument == "--bench") {
        table::print();
    }
}

#[divan::bench(types = [f32, f64], args = WIDTHS)]
fn acceleration<R: cases::Plain>(bencher: Bencher, width: usize) {
    let network = Network::<R>::new(width);
    let system = network.system();
    bencher.bench_local(|| cases::acceleration(&system, black_box(&cases::point::<R>())));
}

#[divan::bench(types = [f32, f64], args = WIDTHS)]
fn del_step_order_2<R: cases::Plain>(bencher: Bencher, width: usize) {
    let network = Network::<R>::new(width);
    let system = network.system();
    let at = cases::point::<R>();
    let state = cases::moving(&system, &at);
    bencher.bench_local(|| del_step::<R, Midpoint, _, 2>(&system, black_box(state), &at, CARTPOLE_STEP));
}

#[divan::bench(types = [f32, f64], args = WIDTHS)]
fn del_step_order_4<R: cases::Plain>(bencher: Bencher, width: usize) {
    let network = Network::<R>::new(width);
    let system = network.system();
    let at = cases::point::<R>();
    let state = cases::moving(&system, &at);
    bencher.bench_local(|| del_step::<R, Galerkin, _, 2>(&system, black_box(state), &at, CARTPOLE_STEP));
}

#[divan::bench(consts = [2, 3, 4, 6, 8])]
fn pendulums_acceleration<const N: usize>(bencher: Bencher) {
    let links = Links::<f32>::new();
    let system = links.system::<f32, N>();
    bencher.bench_local(|| cases::acceleration(&system, black_box(&chain::point())));
}

#[divan::bench(types = [Midpoint, Galerkin], consts = [2, 3, 4, 6, 8])]
fn pendulums_del_step<P: Path, const N: usize>(bencher: Bencher) {
    let links = Links::<f32>::new();
    let system = links.system::<f32, N>();
    let at = chain::point();
    let state = cases::moving(&system, &at);
    bencher.bench_local(|| del_step::<f32, P, _, N>(&system, black_box(state), &at, STEP));
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
