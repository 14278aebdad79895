//! End stops from a configuration to firmware.

use crate::support::Bench;
use std::fmt::Write;

const STEP: f64 = 0.01;

/// A log of a cart of 1 kg between stops at ±0.25 m, which it strikes without a rebound and leaves when it is pushed back.
fn log() -> String {
    let (mut q, mut v, mut text) = (0.0, 0.0, "t,q0,u0\n".to_owned());
    for k in 0..300 {
        let t = STEP * f64::from(k);
        let u = 3.0 * (4.0 * t).sin();
        writeln!(text, "{t:.2},{q:.9},{u:.9}").unwrap();
        for _ in 0..100 {
            v += u * STEP / 100.0;
            q += v * STEP / 100.0;
            if f64::abs(q) >= 0.25 {
                (q, v) = (f64::clamp(q, -0.25, 0.25), 0.0);
            }
        }
    }
    text
}

#[test]
fn stops_are_given_exported_inspected_and_stepped_on_the_chip() {
    let bench = Bench::new();
    bench.write("cart.csv", &log());
    bench.write(
        "cart.toml",
        "[data]\nfile = \"cart.csv\"\ncontrol = \"held\"\n[model]\nfamily = \"bodies\"\ngravity = [0.0, 0.0]\n\
         stops = { lower = -0.25, upper = 0.25 }\n\
         bodies = [{ joint = \"prismatic\", mass = { learn = 1.5 }, centre = [0.0, 0.0], inertia = 1.0 }]\n\
         [training]\nloss = \"windows\"\nwindow = 0.3\niterations = 20\n",
    );
    bench.run("train cart.toml -o run -q").good();
    bench.run("export run -o m.postcard --rust m.rs").good();
    assert!(bench.text("m.rs").contains("Stops<f32, M>"), "{}", bench.text("m.rs"));
    let report = bench.run("inspect m.postcard --json").good().json();
    let stop = &report["stops"][0];
    assert_eq!([&stop["lower"], &stop["upper"]].map(|x| x.as_f64().unwrap()), [-0.25, 0.25]);
    let text = bench.run("inspect m.postcard").good().stdout;
    assert!(text.contains("end stops") && text.contains("q0: -0.2500 … 0.2500 m or rad"), "{text}");
    let report = bench.run("evaluate m.postcard --data cart.csv --json").good().json();
    let errors = [&report["rollout_mse"], &report["chip"]["rollout_mse"]].map(|x| x.as_f64().unwrap());
    assert!(errors.iter().all(|error| *error < 1e-4), "{report}");
    let words = "simulate m.postcard --plant m.postcard --scenario predict --seconds 0.5 --json -o out";
    assert_eq!(bench.run(words).good().json()["success"].as_bool(), Some(true));
}
