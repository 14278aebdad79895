//! The table printed after divan's: operation counts, and the achieved fraction of peak performance.

use crate::WIDTHS;
use crate::cases::{self, CARTPOLE_STEP, Network, Plain, Point, point};
use crate::chain::{self, Links, STEP};
use crate::counted::{Counted, Operations, count};
use crate::peak::{fastest, flops};
use leastaction_core::discrete::{Galerkin, Midpoint, Path};
use leastaction_core::forces::{System, Viscous};
use leastaction_core::lagrangian::Lagrangian;
use leastaction_core::scalar::Real;
use std::hint::black_box;

/// Multiplications and additions of one `tanh`, from the source; its division is not among them.
const TANH_F32: u64 = 25;
const TANH_F64: u64 = 37;
/// Multiplications and additions of one `sin_cos` in f32; in f64 it is libm's.
const SIN_COS_F32: u64 = 28;

/// Measured calls are bundled, so that the time of reading the clock is negligible.
const BUNDLE: u32 = 100;
const REPETITIONS: u32 = 200;

/// Prints peaks, then a row for every case.
pub fn print() {
    let (single, double) = (flops::<f32>(), flops::<f64>());
    println!(
        "\nmeasured peak of one thread, fused operations excluded: {} in f32, {} in f64",
        rate(single),
        rate(double)
    );
    println!(
        "multiply-adds: counted multiplications and additions, halved; divisions and elementary functions apart\n"
    );
    println!(
        "{:<24}{:>10}{:>9}{:>15}{:>11}{:>12}{:>10}",
        "", "ns", "updates", "multiply-adds", "divisions", "elementary", "of peak"
    );
    for width in WIDTHS {
        network::<f32>("f32", width, single);
        network::<f64>("f64", width, double);
    }
    pendulums::<2>(single);
    pendulums::<3>(single);
    pendulums::<4>(single);
    pendulums::<6>(single);
    pendulums::<8>(single);
    kernels(single, double);
}

fn rate(flops: f64) -> String {
    format!("{:.2}e9 multiply-adds/s", 0.5e-9 * flops)
}

struct Row {
    name: String,
    seconds: f64,
    updates: Option<u8>,
    done: Operations,
}

impl Row {
    fn print(&self, peak: f64) {
        let Operations { flops, divisions, roots, exponentials, logarithms, tangents, sines, .. } = self.done;
        let flops = flops + 2 * self.done.multiply_adds.iter().sum::<u64>();
        let divisions = divisions + roots;
        let elementary = exponentials + logarithms + tangents + sines;
        let share = 100.0 * flops as f64 / self.seconds / peak;
        println!(
            "{:<24}{:>10.0}{:>9}{:>15}{:>11}{:>12}{:>9.1}%",
            self.name,
            1e9 * self.seconds,
            self.updates.map_or(String::new(), |updates| updates.to_string()),
            flops / 2,
            divisions,
            elementary,
            share
        );
    }
}

/// Seconds of one call.
fn seconds<O>(call: impl Fn() -> O) -> f64 {
    let bundle = || (0..BUNDLE).for_each(|_| drop(black_box(call())));
    fastest(REPETITIONS, bundle) / f64::from(BUNDLE)
}

fn network<R: Plain>(scalar: &str, width: usize, peak: f64) {
    let network = Network::<R>::new(width);
    let name = format!("{scalar} 2x{width}");
    system(&name, &network.system::<R>(), &network.system(), (&point(), &point()), CARTPOLE_STEP, peak);
}

fn pendulums<const N: usize>(peak: f64) {
    let links = Links::<f32>::new();
    let (at, counted_at) = (chain::point(), chain::point());
    system(
        &format!("f32 chain {N}"),
        &links.system::<f32, N>(),
        &links.system(),
        (&at, &counted_at),
        STEP,
        peak,
    );
}

/// Prints a row for the acceleration and for a step of each order. Operations are counted on the same system in a
/// counting scalar.
fn system<R: Plain, L, C, const N: usize>(
    name: &str,
    system: &System<L, Viscous<R, N>>,
    counted: &System<C, Viscous<Counted<R>, N>>,
    (at, counted_at): (&Point<R, N>, &Point<Counted<R>, N>),
    h: f64,
    peak: f64,
) where
    L: Lagrangian<R, N>,
    C: Lagrangian<Counted<R>, N>,
{
    let (_, done) = count(|| cases::acceleration(counted, counted_at));
    let seconds = seconds(|| cases::acceleration(system, black_box(at)));
    Row { name: format!("acceleration {name}"), seconds, updates: None, done }.print(peak);
    step::<R, Midpoint, L, C, N>(name, system, counted, (at, counted_at), h, peak);
    step::<R, Galerkin, L, C, N>(name, system, counted, (at, counted_at), h, peak);
}

fn step<R: Plain, P: Path, L: Lagrangian<R, N>, C: Lagrangian<Counted<R>, N>, const N: usize>(
    name: &str,
    system: &System<L, Viscous<R, N>>,
    counted: &System<C, Viscous<Counted<R>, N>>,
    (at, counted_at): (&Point<R, N>, &Point<Counted<R>, N>),
    h: f64,
    peak: f64,
) {
    let (state, counted_state) = (cases::moving(system, at), cases::moving(counted, counted_at));
    let ((_, updates), done) = count(|| cases::del_step::<_, P, _, N>(counted, counted_state, counted_at, h));
    let seconds = seconds(|| cases::del_step::<R, P, _, N>(system, black_box(state), at, h));
    Row { name: format!("DEL order {} {name}", P::ORDER), seconds, updates: Some(updates), done }.print(peak);
}

fn kernels(single: f64, double: f64) {
    kernel("tanh f32", cases::tanh::<f32>, TANH_F32, single);
    kernel("tanh f64", cases::tanh::<f64>, TANH_F64, double);
    kernel("sin_cos f32", cases::sin_cos::<f32>, SIN_COS_F32, single);
    kernel("sin_cos f64 (libm)", cases::sin_cos::<f64>, 0, double);
}

/// 64 calls on neighbouring numbers.
fn kernel<R: Real>(name: &str, call: fn(&mut [R; 64]), flops: u64, peak: f64) {
    let mut numbers = cases::angles::<R>();
    let seconds =
        fastest(REPETITIONS, || (0..BUNDLE).for_each(|_| call(black_box(&mut numbers)))) / f64::from(BUNDLE);
    let done = Operations { flops: 64 * flops, tangents: 64, ..Operations::default() };
    Row { name: format!("64 {name}"), seconds, updates: None, done }.print(peak);
}
