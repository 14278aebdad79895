//! Errors of micromath's elementary functions beside ours: the table of core/README.md, which shows why evaluations
//! do not use micromath.
//! `cargo test -p leastaction-core --test networks micro -- --nocapture` prints the table.

use leastaction_core::scalar::Scalar;
use micromath::F32Ext;

/// One row: micromath's function, ours, the exact one, and a range.
struct Row {
    name: &'static str,
    micromath: fn(f32) -> f32,
    ours: fn(f32) -> f32,
    exact: fn(f64) -> f64,
    range: (f64, f64),
}

const ROWS: [Row; 5] = [
    Row { name: "√x", micromath: F32Ext::sqrt, ours: Scalar::sqrt, exact: f64::sqrt, range: (1e-3, 100.0) },
    Row { name: "eˣ", micromath: F32Ext::exp, ours: Scalar::exp, exact: f64::exp, range: (-10.0, 5.0) },
    Row {
        name: "ln(1 + x)",
        micromath: |x| F32Ext::ln(1.0 + x),
        ours: Scalar::ln_1p,
        exact: f64::ln_1p,
        range: (0.0, 1.0),
    },
    Row {
        name: "sin x",
        micromath: |x| F32Ext::sin_cos(x).0,
        ours: |x| Scalar::sin_cos(x).0,
        exact: f64::sin,
        range: (-7.0, 7.0),
    },
    Row {
        name: "cos x",
        micromath: |x| F32Ext::sin_cos(x).1,
        ours: |x| Scalar::sin_cos(x).1,
        exact: f64::cos,
        range: (-7.0, 7.0),
    },
];

/// The largest error over a range, relative to max(|exact|, 1e-3).
fn worst(f: fn(f32) -> f32, row: &Row) -> f64 {
    const SAMPLES: u32 = 200_000;
    let (low, high) = row.range;
    let points = (0..=SAMPLES).map(|k| (low + (high - low) * f64::from(k) / f64::from(SAMPLES)) as f32);
    let errors = points.map(|x| {
        let exact = (row.exact)(x.into());
        (f64::from(f(x)) - exact).abs() / exact.abs().max(1e-3)
    });
    errors.fold(0.0, f64::max)
}

#[test]
fn ours_are_exact_to_single_precision_and_micromaths_are_not() {
    println!("| function | range | micromath | ours |\n|---|---|---|---|");
    for row in ROWS {
        let (micromath, ours) = (worst(row.micromath, &row), worst(row.ours, &row));
        let (low, high) = row.range;
        println!("| {} | {low} … {high} | {micromath:.1e} | {ours:.1e} |", row.name);

        assert!(ours <= 2e-7 && micromath > 1e-3, "{}: {micromath:e}, {ours:e}", row.name);
    }
}
