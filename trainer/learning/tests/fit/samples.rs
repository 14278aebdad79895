//! Preparation of samples from stamped logs.

use leastaction_data::{Measured, Rows};
use leastaction_learning::torque::{Butterworth, Preparation, SampleError, Samples};
use std::f64::consts::TAU;

const STEP: f64 = 1e-3;

/// Two coordinates along sines, at uneven stamps, with noise of 180 Hz.
fn log(seconds: f64, with_velocities: bool) -> Measured {
    let t: Vec<f64> =
        (0..(seconds / STEP) as usize).map(|k| 0.3 + STEP * (k as f64 + 0.2 * (k as f64).sin())).collect();
    let rows = |f: &dyn Fn(f64) -> [f64; 2]| Rows::from_arrays(&t.iter().map(|t| f(*t)).collect::<Vec<_>>());
    let noise = |t: f64| 1e-3 * (TAU * 180.0 * t).sin();
    let q = rows(&|t| [(3.0 * t).sin() + noise(t), (2.0 * t).cos()]);
    let v = rows(&|t| [3.0 * (3.0 * t).cos() + noise(t), -2.0 * (2.0 * t).sin()]);
    let u = rows(&|t| [t.sin(), 2.0 + noise(t)]);
    Measured { t: t.clone(), q, v: with_velocities.then_some(v), u: Some(u) }
}

#[test]
fn the_filter_has_the_gain_of_its_formula_and_no_phase() {
    let filter = Butterworth::new(4, 20.0, STEP).unwrap();
    assert!((filter.gain(0.0, STEP) - 1.0).abs() < 1e-9);
    // Twice −3 dB at the cut-off.
    assert!((filter.gain(20.0, STEP) - 0.5).abs() < 1e-9);
    for frequency in [5.0, 20.0, 40.0] {
        let wave: Vec<f64> = (0..4000).map(|k| (TAU * frequency * STEP * f64::from(k)).sin()).collect();
        let found = filter.filter(&wave);
        let gain = filter.gain(frequency, STEP);
        (1000..3000).for_each(|k| assert!((found[k] - gain * wave[k]).abs() < 1e-9, "{frequency} Hz"));
    }
}

/// `scipy.signal.filtfilt(*scipy.signal.butter(4, 0.2), x)` of x = k² mod 7, k = 0 … 39, at a few places is what a filter by second-order
/// sections gives too; here the same is computed by the polynomials of the whole filter.
#[test]
fn sections_are_the_filter_of_its_polynomials() {
    let filter = Butterworth::new(4, 0.1, 1.0).unwrap();
    // butter(4, 0.2), as in every table of it.
    let b = [0.00482434, 0.01929737, 0.02894606, 0.01929737, 0.00482434];
    let a = [1.0, -2.36951301, 2.31398841, -1.05466541, 0.18737949];
    for frequency in [0.02, 0.1, 0.23] {
        let value = |c: &[f64; 5]| {
            let part =
                |f: fn(f64) -> f64| -> f64 { (0..5).map(|k| c[k] * f(TAU * frequency * k as f64)).sum() };
            part(f64::cos).powi(2) + part(f64::sin).powi(2)
        };
        assert!((filter.gain(frequency, 1.0) / (value(&b) / value(&a)) - 1.0).abs() < 1e-5, "{frequency}");
    }
}

#[test]
fn straight_lines_and_short_signals_stay() {
    let filter = Butterworth::new(4, 20.0, STEP).unwrap();
    let line: Vec<f64> = (0..800).map(|k| 2.0 - 0.1 * f64::from(k)).collect();
    let found = filter.filter(&line);
    (350..450).for_each(|k| assert!((found[k] - line[k]).abs() < 1e-3));
    assert_eq!(found.len(), 800);
    assert!((found[0] - line[0]).abs() < 0.2);
    for few in [&[][..], &[1.5], &[1.5, 1.5]] {
        let found = filter.filter(few);
        assert!(found.len() == few.len() && found.iter().all(|x| (x - 1.5).abs() < 1e-12));
    }
    for (order, cut_off) in [(3, 20.0), (0, 20.0), (4, 0.0), (4, 500.0), (4, f64::NAN)] {
        assert_eq!(Butterworth::new(order, cut_off, STEP), None);
    }
}

#[test]
fn samples_are_on_the_grid_without_noise_and_with_accelerations() {
    for with_velocities in [false, true] {
        let samples = Samples::prepare(&log(4.0, with_velocities), &Preparation::default()).unwrap();
        assert_eq!(samples.count(), 180);
        assert!((samples.t[0] - 0.2).abs() < 1e-12 && (samples.t[1] - 0.22).abs() < 1e-12);
        for (k, t) in samples.t.iter().map(|t| t + 0.3).enumerate() {
            let near = |found: f64, expected: f64| {
                assert!((found - expected).abs() < 2e-3, "{t} {found} {expected}")
            };
            near(samples.q[k][0], (3.0 * t).sin());
            near(samples.v[k][1], -2.0 * (2.0 * t).sin());
            near(samples.a[k][1], -4.0 * (2.0 * t).cos());
            near(samples.tau[k][0], t.sin());
        }
        let part = samples.at(|t| t > 1.0);
        assert_eq!(part.tau.as_flat(), &samples.tau.as_flat()[2 * (samples.count() - part.count())..]);
    }
}

#[test]
fn what_is_no_log_is_said() {
    let usual = Preparation::default();
    let short = Samples::prepare(&log(0.3, true), &usual).unwrap_err();
    assert!(matches!(short, SampleError::Short { .. }) && short.to_string().contains("0.2 s at each end"));
    let fast = Samples::prepare(&log(1.0, true), &Preparation { cut_off: 600.0, ..usual }).unwrap_err();
    assert!(fast.to_string().contains("500 Hz"), "{fast}");
    let mut far = log(1.0, true);
    *far.t.last_mut().unwrap() = 1e12;
    assert!(matches!(Samples::prepare(&far, &usual), Err(SampleError::Long { .. })));
    let none = Measured { u: None, ..log(1.0, true) };
    assert!(Samples::prepare(&none, &usual).unwrap_err().to_string().contains("0 columns of torques and 2"));
}
