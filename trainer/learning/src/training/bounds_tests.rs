use crate::training::{
    Adam, AdamSettings, Bounds, ChunkRows, Levenberg, NormalEquations, Objective, Progress, Range, Schedule,
};
use leastaction_models::tree::{INERTIAL, Inertia, LogCholesky};

const RANGES: [Range; 3] = [Range::Any, Range::Positive, Range::Between(0.02, 1.0)];

#[test]
fn numbers_come_back_and_slopes_are_differences() {
    let bounds = Bounds::new((0..).zip(RANGES).collect());
    for (weight, width) in [(1e-3, 0.021), (0.7, 0.5), (1e3, 0.999)] {
        let weights = [-3.0, weight, width];
        let theta = bounds.free(&weights);
        let back = bounds.weights(&theta);
        assert!(back.iter().zip(&weights).all(|(a, b)| (a / b - 1.0).abs() < 1e-13), "{back:?}");
        let moved = |step: f64| bounds.weights(&theta.iter().map(|x| x + step).collect::<Vec<_>>());
        let (forth, back) = (moved(1e-5), moved(-1e-5));
        for ((slope, forth), back) in bounds.slopes(&theta).iter().zip(forth).zip(back) {
            assert!((slope / ((forth - back) / 2e-5) - 1.0).abs() < 1e-6, "{slope}");
        }
    }
}

#[test]
fn bounds_themselves_and_beyond_are_finite_and_can_be_left() {
    for range in &RANGES[1..] {
        for weight in [-5.0, 0.0, 0.02, 1.0, 7.0, f64::INFINITY, f64::MAX] {
            let theta = range.free(weight);
            assert!(theta.is_finite() && range.slope(theta) > 0.0, "{range:?} {weight}");
            let inside = range.weight(theta);
            assert!((range.free(inside) - theta).abs() < 1e-9 * theta.abs().max(1.0), "{range:?} {weight}");
        }
        for theta in [-1e6, 1e6] {
            assert!(range.weight(theta).is_finite() && range.slope(theta) > 0.0);
        }
    }
    assert_eq!(Range::Any.free(f64::MAX), f64::MAX);
}

/// Residuals r = w − w*, one per number.
struct Away {
    bounds: Bounds,
    aim: Vec<f64>,
}

impl Objective for Away {
    fn parameters(&self) -> usize {
        self.aim.len()
    }
    fn samples(&self) -> usize {
        1
    }
    fn loss(&self, weights: &[f64]) -> f64 {
        self.gradient(weights, 0..1).unwrap().mean_square()
    }
    fn normal_equations(&self, weights: &[f64]) -> Option<NormalEquations> {
        let mut equations = NormalEquations::zero(self.aim.len());
        for (i, (w, aim)) in weights.iter().zip(&self.aim).enumerate() {
            equations.gram[(i, i)] = 1.0;
            equations.gradient[i] = w - aim;
            equations.squares += (w - aim).powi(2);
        }
        equations.rows = self.aim.len();
        Some(equations)
    }
    fn gradient(&self, weights: &[f64], _: std::ops::Range<usize>) -> Option<NormalEquations> {
        self.normal_equations(weights)
    }
    fn project(&self, _: &mut [f64]) {}
    fn bounds(&self) -> &Bounds {
        &self.bounds
    }
}

fn away(aim: f64, range: Range) -> Away {
    Away { bounds: Bounds::new(vec![(0, range)]), aim: vec![aim] }
}

#[test]
fn gauss_newton_goes_from_thousandths_to_thousands_and_back() {
    for (start, aim) in [(1e-3, 1e3), (1e3, 1e-3), (1.0, 1e-3), (1.0, 1e3)] {
        let objective = away(aim, Range::Positive);
        let end = Levenberg::new(&objective, vec![start]).run(&objective, 60, |_, _| {});
        assert!((end.weights[0] / aim - 1.0).abs() < 1e-6, "{start} {aim}: {:?}", end.weights);
    }
    let objective = away(0.9, Range::Between(0.02, 1.0));
    let end = Levenberg::new(&objective, vec![0.02]).run(&objective, 60, |_, _| {});
    assert!((end.weights[0] - 0.9).abs() < 1e-9, "{:?}", end.weights);
}

#[test]
fn what_lies_beyond_a_bound_ends_at_it() {
    for (aim, range, end) in [
        (-1.0, Range::Positive, 0.0),
        (3.0, Range::Between(0.0, 0.95), 0.95),
        (-3.0, Range::Between(0.5, 2.0), 0.5),
    ] {
        let objective = away(aim, range);
        let found = Levenberg::new(&objective, vec![0.7]).run(&objective, 100, |_, _| {}).weights[0];
        assert!((found - end).abs() < 2e-4, "{range:?}: {found}");
    }
}

#[test]
fn adam_stays_in_the_range() {
    let objective = away(-1.0, Range::Between(0.5, 2.0));
    let settings =
        AdamSettings { learning_rate: 0.1, batch: 0, schedule: Schedule::Constant, decay: 0.0, seed: 0 };
    let mut adam = Adam::new(&objective, vec![1.5], settings);
    for _ in 0..100 {
        assert_eq!(adam.iterate(&objective), Progress::Lower);
        assert!((0.5..2.0).contains(&adam.weights[0]), "{:?}", adam.weights);
    }
    assert!(adam.weights[0] < 0.51, "{:?}", adam.weights);
}

/// JᵀJ and Jᵀr in θ are those of a Jacobian whose columns are multiplied by the slopes.
#[test]
fn normal_equations_are_scaled_by_slopes() {
    let rows = [[1.0, 2.0, -1.0], [0.5, -3.0, 2.0]];
    let (residual, slopes) = ([0.3, -0.8], [1.0, 0.25, 4.0]);
    let of = |slopes: [f64; 3]| {
        let jacobian = nalgebra::DMatrix::from_fn(2, 3, |i, j| rows[i][j] * slopes[j]);
        let mut equations = NormalEquations::zero(3);
        equations.add(&ChunkRows::of(jacobian, residual.to_vec()));
        equations
    };
    let (mut scaled, expected) = (of([1.0; 3]), of(slopes));
    scaled.scale((0..3).zip(slopes));
    assert_eq!(scaled.gradient, expected.gradient);
    for (i, j) in (0..3).flat_map(|i| (0..=i).map(move |j| (i, j))) {
        assert_eq!(scaled.gram[(i, j)], expected.gram[(i, j)]);
    }
}

/// A body among other numbers.
fn with_a_body() -> (Bounds, Vec<f64>) {
    let body = Inertia([2.0, 0.1, -0.2, 0.3, 0.4, 0.01, 0.5, -0.02, 0.03, 0.3]);
    let bounds =
        Bounds::new(vec![(0, Range::Positive)]).with_bodies(vec![(1, LogCholesky::around(&body).unwrap())]);
    let mut weights = vec![0.7];
    weights.extend(body.0.map(|x| 1.1 * x));
    weights.push(-3.0);
    (bounds, weights)
}

#[test]
fn a_body_comes_back_and_one_that_cannot_be_becomes_the_prior() {
    let (bounds, weights) = with_a_body();
    let back = bounds.weights(&bounds.free(&weights));
    assert!(back.iter().zip(&weights).all(|(a, b)| (a - b).abs() < 1e-12), "{back:?}");
    let mut wrong = weights.clone();
    wrong[1] = -1.0;
    assert!((bounds.within(wrong)[1] - 2.0).abs() < 1e-12);
    let mut theta = bounds.free(&weights);
    theta[1..11].fill(3.0);
    let far: [f64; INERTIAL] = *bounds.weights(&theta)[1..].first_chunk().unwrap();
    assert!(Inertia(far).consistency() > 0.0);
}

/// JᵀJ and Jᵀr in θ are those of the Jacobian times ∂w/∂θ, which is approximated by differences of weights.
#[test]
fn normal_equations_of_a_body_are_in_its_free_numbers() {
    let (bounds, weights) = with_a_body();
    let (theta, count) = (bounds.free(&weights), weights.len());
    let wave = |i: usize, j: usize| (1.3 * i as f64 + 2.7 * j as f64).sin();
    let jacobian = nalgebra::DMatrix::from_fn(15, count, wave);
    let residual: Vec<f64> = (0..15).map(|i| wave(i, 40)).collect();
    let slope = |j: usize, k: usize| {
        let moved = |step: f64| {
            let mut theta = theta.clone();
            theta[k] += step;
            bounds.weights(&theta)[j]
        };
        (moved(1e-6) - moved(-1e-6)) / 2e-6
    };
    let free = &jacobian * nalgebra::DMatrix::from_fn(count, count, slope);
    let mut equations = NormalEquations::zero(count);
    equations.add(&ChunkRows::of(jacobian, residual.to_vec()));
    equations.bring_to_free(&bounds, &theta);
    let mut expected = NormalEquations::zero(count);
    expected.add(&ChunkRows::of(free, residual.to_vec()));
    for i in 0..count {
        let error = (equations.gradient[i] - expected.gradient[i]).abs();
        assert!(error < 1e-7, "{i}: {error}");
        for j in 0..=i {
            let error = (equations.gram[(i, j)] - expected.gram[(i, j)]).abs();
            assert!(error < 1e-7, "{i} {j}: {error}");
        }
    }
}
