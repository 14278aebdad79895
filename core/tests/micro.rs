//! Errors of micromath's functions as [`Micro`] uses them; the table of core/README.md. Print it with
//! `cargo test -p leastaction-core --features micromath --test micro -- --nocapture`.
#![cfg(feature = "micromath")]

use leastaction_core::scalar::{Micro, Scalar};

/// One row: a function of `Micro`, the exact one, a range, and the largest absolute and relative error allowed.
struct Row {
    name: &'static str,
    approximate: fn(Micro) -> Micro,
    exact: fn(f64) -> f64,
    range: (f64, f64),
    absolute: f64,
    relative: f64,
}

const ROWS: [Row; 7] = [
    Row {
        name: "sqrt",
        approximate: Scalar::sqrt,
        exact: f64::sqrt,
        range: (1e-3, 100.0),
        absolute: 0.4,
        relative: 0.07,
    },
    Row {
        name: "exp",
        approximate: Scalar::exp,
        exact: f64::exp,
        range: (-10.0, 0.0),
        absolute: 0.0015,
        relative: 0.003,
    },
    Row {
        name: "exp",
        approximate: Scalar::exp,
        exact: f64::exp,
        range: (0.0, 5.0),
        absolute: 0.12,
        relative: 0.001,
    },
    Row {
        name: "ln_1p",
        approximate: Scalar::ln_1p,
        exact: f64::ln_1p,
        range: (0.0, 1.0),
        absolute: 0.0001,
        relative: 0.07,
    },
    Row {
        name: "tanh",
        approximate: Scalar::tanh,
        exact: f64::tanh,
        range: (-5.0, 5.0),
        absolute: 0.0015,
        relative: 0.004,
    },
    Row {
        name: "sin",
        approximate: |x| x.sin_cos().0,
        exact: f64::sin,
        range: (-7.0, 7.0),
        absolute: 0.0015,
        relative: 0.02,
    },
    Row {
        name: "cos",
        approximate: |x| x.sin_cos().1,
        exact: f64::cos,
        range: (-7.0, 7.0),
        absolute: 0.0015,
        relative: 0.02,
    },
];

#[test]
fn errors_are_those_of_the_table() {
    const SAMPLES: u32 = 200_000;
    println!("| function | range | absolute | relative |\n|---|---|---|---|");
    for Row { name, approximate, exact, range: (low, high), absolute, relative } in ROWS {
        let (mut worst, mut worst_relative) = (0.0_f64, 0.0_f64);
        for k in 0..=SAMPLES {
            let x = (low + (high - low) * f64::from(k) / f64::from(SAMPLES)) as f32;
            let (found, exact) = (f64::from(approximate(Micro(x)).0), exact(x.into()));
            worst = worst.max((found - exact).abs());
            worst_relative = worst_relative.max((found - exact).abs() / exact.abs().max(1e-3));
        }
        println!("| {name} | {low} … {high} | {worst:.1e} | {worst_relative:.1e} |");
        assert!(worst <= absolute && worst_relative <= relative, "{name}: {worst:e}, {worst_relative:e}");
    }
}
