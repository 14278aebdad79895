//! Compares every elementary function of core in single precision, at every one of the 2³² inputs, with double precision. Prints the
//! largest error in units of the last place (the distance between the two f32 around the exact value, 2⁻¹⁴⁹ at least), its position, and a
//! hash of all results, which every target must give.
//!
//! `cargo run --release -p leastaction-core --example every_f32 [THREADS [FUNCTION…]]`; half an hour of one core.

use leastaction_core::scalar::Scalar;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU32, Ordering};

/// Number of inputs of a part: those that share their first byte.
const PART: u32 = 1 << 24;
const PARTS: u32 = 256;

/// A function under test: ours, and its counterpart in double precision, which is right to a thousandth of a unit.
struct Function {
    name: &'static str,
    ours: fn(f32) -> f32,
    exact: fn(f64) -> f64,
    /// The inputs for which the function is meant.
    domain: fn(f32) -> bool,
}

const FUNCTIONS: [Function; 6] = [
    Function { name: "sqrt", ours: |x| x.sqrt(), exact: f64::sqrt, domain: |x| x >= 0.0 },
    Function { name: "exp", ours: |x| Scalar::exp(x), exact: f64::exp, domain: |x| !x.is_nan() },
    Function { name: "ln_1p", ours: |x| Scalar::ln_1p(x), exact: f64::ln_1p, domain: |x| x > -1.0 },
    Function { name: "tanh", ours: |x| Scalar::tanh(x), exact: f64::tanh, domain: |x| !x.is_nan() },
    Function {
        name: "sin",
        ours: |x| Scalar::sin_cos(x).0,
        exact: f64::sin,
        domain: |x| x.abs() <= 65_536.0,
    },
    Function {
        name: "cos",
        ours: |x| Scalar::sin_cos(x).1,
        exact: f64::cos,
        domain: |x| x.abs() <= 65_536.0,
    },
];

/// The largest error so far, and its position.
#[derive(Clone, Copy, Default)]
struct Largest {
    error: f64,
    at: f32,
}

impl Largest {
    fn add(&mut self, error: f64, at: f32) {
        // NaN counts as the largest error if a number is expected.
        if error > self.error || error.is_nan() {
            *self = Self { error: if error.is_nan() { f64::INFINITY } else { error }, at };
        }
    }

    fn join(&mut self, other: Self) {
        self.add(other.error, other.at);
    }
}

/// Results of a part, or of all.
#[derive(Clone, Copy, Default)]
struct Found {
    /// Largest error everywhere, in units of the last place.
    ulp: Largest,
    /// Largest error within ±8192 where the exact result is above 0.01: away from the zeros of a sine.
    usual: Largest,
    /// Largest absolute error where the exact result is at most 1.
    absolute: Largest,
    /// Number of inputs outside the domain whose result is a number.
    beyond: u64,
    hash: u64,
}

/// The distance between the f32 around x; 2⁻¹⁴⁹ at least.
fn ulp(x: f64) -> f64 {
    let exponent = (x.abs().to_bits() >> 52) as i32 - 1023;
    2_f64.powi((exponent - 23).clamp(-149, 104))
}

fn error_in_ulp(found: f32, exact: f64) -> f64 {
    let rounded = exact as f32;
    // An infinite result is no error if the exact one rounds to infinity.
    if found == rounded {
        return (f64::from(found) - exact).abs().min(0.5 * ulp(exact)) / ulp(exact);
    }
    (f64::from(found) - exact).abs() / ulp(exact)
}

impl Function {
    fn part(&self, part: u32) -> Found {
        let mut found = Found { hash: 0xcbf2_9ce4_8422_2325, ..Found::default() };
        for bits in part * PART..=part * PART + (PART - 1) {
            let x = f32::from_bits(bits);
            let ours = (self.ours)(x);
            // NaN counts with fixed bits: they differ between processors.
            let bits = if ours.is_nan() { f32::NAN.to_bits() } else { ours.to_bits() };
            found.hash = (found.hash ^ u64::from(bits)).wrapping_mul(0x0100_0000_01b3);
            if (self.domain)(x) {
                found.compare(x, ours, (self.exact)(x.into()));
            } else if !ours.is_nan() && !x.is_nan() {
                found.beyond += 1;
            }
        }
        found
    }

    /// Runs all parts on `threads` threads.
    fn all(&self, threads: usize) -> Found {
        let (next, parts) = (AtomicU32::new(0), Mutex::new(vec![Found::default(); PARTS as usize]));
        std::thread::scope(|scope| {
            for _ in 0..threads {
                scope.spawn(|| {
                    loop {
                        let part = next.fetch_add(1, Ordering::Relaxed);
                        if part >= PARTS {
                            return;
                        }
                        let found = self.part(part);
                        parts.lock().unwrap()[part as usize] = found;
                    }
                });
            }
        });
        let parts = parts.into_inner().unwrap();
        parts.into_iter().fold(Found { hash: 0xcbf2_9ce4_8422_2325, ..Found::default() }, Found::joined)
    }
}

impl Found {
    fn compare(&mut self, x: f32, ours: f32, exact: f64) {
        let error = error_in_ulp(ours, exact);
        self.ulp.add(error, x);
        if x.abs() <= 8192.0 && exact.abs() > 0.01 {
            self.usual.add(error, x);
        }
        if exact.abs() <= 1.0 {
            self.absolute.add((f64::from(ours) - exact).abs(), x);
        }
    }

    fn joined(mut self, other: Self) -> Self {
        self.ulp.join(other.ulp);
        self.usual.join(other.usual);
        self.absolute.join(other.absolute);
        self.beyond += other.beyond;
        self.hash = (self.hash ^ other.hash).wrapping_mul(0x0100_0000_01b3);
        self
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let threads = arguments.first().and_then(|threads| threads.parse().ok()).unwrap_or(1);
    let asked = arguments.get(1..).unwrap_or(&[]);
    for function in
        FUNCTIONS.iter().filter(|function| asked.is_empty() || asked.iter().any(|name| name == function.name))
    {
        let Found { ulp, usual, absolute, beyond, hash } = function.all(threads);
        println!(
            "{}: {:.3} ulp at {:e} ({:08x}); within ±8192 and above 0.01 {:.3} ulp at {:e}; absolute, up to 1, {:.2e} at {:e}; {beyond} numbers \
             beyond the domain; hash {hash:016x}",
            function.name,
            ulp.error,
            ulp.at,
            ulp.at.to_bits(),
            usual.error,
            usual.at,
            absolute.error,
            absolute.at
        );
    }
}
