//! The factored filter against dense covariance matrices and least squares.

use crate::common::{Random, assert_close, assert_vectors_close};
use leastaction_core::adapt::{Filter, Measurement};
use leastaction_core::linear::{Matrix, dot, identity, multiply, solve};

const DEVIATIONS: [f64; 4] = [3.0, 0.5, 1.2, 0.1];

/// Dense filter: the estimate and its covariance.
struct Dense {
    x: [f64; 4],
    c: Matrix<f64, 4>,
}

impl Dense {
    fn new() -> Self {
        let mut c = identity();
        for (i, s) in DEVIATIONS.iter().enumerate() {
            c[i][i] = s * s;
        }
        Self { x: [0.0; 4], c }
    }

    /// C ← C + factor w wᵀ.
    fn add(&mut self, factor: f64, w: &[f64; 4]) {
        for i in 0..4 {
            for j in 0..4 {
                self.c[i][j] += factor * w[i] * w[j];
            }
        }
    }

    fn take(&mut self, Measurement { row, value, variance, forgotten, .. }: &Measurement<f64, 4>) {
        let seen = multiply(&self.c, row);
        self.add(forgotten / ((1.0 - forgotten) * dot(row, &seen)), &seen);
        let gain = multiply(&self.c, row);
        let total = dot(row, &gain) + variance;
        let innovation = value - dot(row, &self.x);
        self.x = core::array::from_fn(|i| self.x[i] + gain[i] * innovation / total);
        self.add(-1.0 / total, &gain);
    }
}

fn measurements(seed: u64, count: usize) -> Vec<([f64; 4], f64, f64)> {
    let (mut random, truth) = (Random(seed), [1.0, -0.3, 0.7, 0.05]);
    let mut one = || {
        let row = random.array(2.0);
        let variance = 0.02 + random.symmetric(0.01);
        (row, dot(&row, &truth) + random.symmetric(0.1), variance)
    };
    (0..count).map(|_| one()).collect()
}

#[test]
fn without_forgetting_it_is_least_squares() {
    let all = measurements(3, 60);
    let mut filter = Filter::<f64, 4, 6>::new(DEVIATIONS);
    let (mut normal, mut right) = ([[0.0; 4]; 4], [0.0; 4]);
    for (i, s) in DEVIATIONS.iter().enumerate() {
        normal[i][i] = 1.0 / (s * s);
    }
    for (row, value, variance) in &all {
        let taken =
            Measurement { row, value: *value, variance: *variance, largest: f64::INFINITY, forgotten: 0.0 };
        assert!(filter.take(&taken).is_some());
        for i in 0..4 {
            right[i] += row[i] * value / variance;
            for j in 0..4 {
                normal[i][j] += row[i] * row[j] / variance;
            }
        }
    }
    assert_vectors_close("estimate", filter.estimate(), &solve(normal, right).unwrap(), 1e-12);
    for i in 0..4 {
        let unit = core::array::from_fn(|j| f64::from(u8::from(i == j)));
        assert_close("variance", filter.variance(i), solve(normal, unit).unwrap()[i], 1e-12);
    }
}

#[test]
fn forgetting_is_that_of_the_dense_formula() {
    let (mut filter, mut dense) = (Filter::<f64, 4, 6>::new(DEVIATIONS), Dense::new());
    for (k, (row, value, variance)) in measurements(5, 200).into_iter().enumerate() {
        let forgotten = 0.1 * (k % 4) as f64;
        let taken = Measurement { row: &row, value, variance, largest: f64::INFINITY, forgotten };
        dense.take(&taken);
        assert!(filter.take(&taken).is_some());
        if k == 100 {
            filter.loosen(2, 0.3);
            dense.add(0.3, &[0.0, 0.0, 1.0, 0.0]);
        }
        assert_vectors_close("estimate", filter.estimate(), &dense.x, 1e-9);
        for i in 0..4 {
            assert_close("variance", filter.variance(i), dense.c[i][i], 1e-9);
        }
    }
}

/// One direction is measured for ever: it is known as well as the memory allows, and no other direction is forgotten.
#[test]
fn only_what_is_excited_is_forgotten() {
    let mut filter = Filter::<f32, 4, 6>::new(DEVIATIONS.map(|s| s as f32));
    for i in 0..4 {
        let row: [f32; 4] = core::array::from_fn(|j| f32::from(u8::from(i == j)));
        filter.take(&Measurement {
            row: &row,
            value: 1.0,
            variance: 1e-4,
            largest: f32::INFINITY,
            forgotten: 0.0,
        });
    }
    let before: [f32; 4] = core::array::from_fn(|i| filter.variance(i));
    for _ in 0..1_000_000 {
        let row = [0.0, 1.0, 0.0, 0.0];
        filter.take(&Measurement {
            row: &row,
            value: 1.0,
            variance: 1e-4,
            largest: f32::INFINITY,
            forgotten: 0.01,
        });
    }
    for i in [0, 2, 3] {
        assert_eq!(filter.variance(i), before[i]);
    }
    assert_close("variance", filter.variance(1).into(), 1e-6, 1e-3);
}

/// Variances stay positive and the numbers are found over a million badly conditioned rows in single precision.
#[test]
fn a_million_rows_in_single_precision_keep_the_variances_positive() {
    let truth: [f32; 4] = [2.5, -0.2, 0.4, 0.01];
    let (mut filter, mut random) = (Filter::<f32, 4, 6>::new([10.0, 2.0, 2.0, 0.3]), Random(11));
    for _ in 0..1_000_000 {
        let [a, b, c, noise]: [f64; 4] = random.array(1.0);
        // The last two rows are nearly parallel.
        let row = [a as f32, b as f32, (b + 1e-3 * c) as f32, 0.0];
        let value = dot(&row, &truth) + 0.1 * noise as f32;
        let taken = Measurement { row: &row, value, variance: 0.01, largest: f32::INFINITY, forgotten: 0.01 };
        let innovation = filter.take(&taken).expect("finite");
        assert!(innovation.variance > 0.0);
        assert!((0..4).all(|i| filter.variance(i) >= 0.0));
    }
    assert_close("excited", filter.estimate()[0].into(), truth[0].into(), 0.03);
    assert_eq!(filter.variance(3), 0.3_f32 * 0.3);
}

#[test]
fn numbers_without_variance_cost_no_bits() {
    let mut small = Filter::<f32, 2, 1>::new([3.0, 0.5]);
    let mut large = Filter::<f32, 5, 10>::new([3.0, 0.5, 0.0, 0.0, 0.0]);
    for (row, value, variance) in measurements(7, 300) {
        let [a, b, ..] = row.map(|a| a as f32);
        let (value, variance) = (value as f32, variance as f32);
        let one = small.take(&Measurement {
            row: &[a, b],
            value,
            variance,
            largest: f32::INFINITY,
            forgotten: 0.02,
        });
        let other = large.take(&Measurement {
            row: &[a, b, 0.0, 0.0, 0.0],
            value,
            variance,
            largest: f32::INFINITY,
            forgotten: 0.02,
        });
        assert_eq!(one, other);
        assert_eq!(small.estimate()[..], large.estimate()[..2]);
        assert_eq!([0, 1].map(|i| small.variance(i)), [0, 1].map(|i| large.variance(i)));
    }
}

#[test]
fn what_is_not_finite_is_not_taken() {
    let mut filter = Filter::<f64, 4, 6>::new(DEVIATIONS);
    filter.take(&Measurement {
        row: &[1.0, 0.5, 0.0, 0.2],
        value: 1.0,
        variance: 0.1,
        largest: f64::INFINITY,
        forgotten: 0.0,
    });
    let before = filter;
    for (row, value) in [([f64::NAN, 0.0, 0.0, 0.0], 1.0), ([1.0; 4], f64::INFINITY), ([1e300; 4], 1.0)] {
        assert_eq!(
            filter.take(&Measurement {
                row: &row,
                value,
                variance: 0.1,
                largest: f64::INFINITY,
                forgotten: 0.3
            }),
            None
        );
        assert_eq!(filter, before);
    }
}

/// A value 100 deviations away counts as if its variance made it 3 deviations away.
#[test]
fn an_outlier_counts_for_little() {
    let (row, variance) = ([1.0, 0.5, 0.0, -0.2], 0.1);
    let mut dense = Dense::new();
    let total = dot(&row, &multiply(&dense.c, &row)) + variance;
    let value = 100.0 * total.sqrt();
    let more = value * value / 9.0 - total;
    let mut filter = Filter::<f64, 4, 6>::new(DEVIATIONS);
    let found = filter.take(&Measurement { row: &row, value, variance, largest: 9.0, forgotten: 0.0 });
    let expected = Measurement { row: &row, value, variance: variance + more, largest: 9.0, forgotten: 0.0 };
    dense.take(&expected);
    assert!((found.expect("finite").normalised_square() - 1e4).abs() < 1e-6);
    assert_vectors_close("estimate", filter.estimate(), &dense.x, 1e-12);
    for i in 0..4 {
        assert_close("variance", filter.variance(i), dense.c[i][i], 1e-12);
    }
}
