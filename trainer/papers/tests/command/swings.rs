//! Free swings of a made-up pendulum with the parameters that were published for the real one.

use super::support::Bench;
use leastaction_learning::data::{Dataset, Rows, Trajectory, write};

/// m (kg), a (m), I (kg m²) and k (N m s/rad) of the single pendulum.
const PENDULUM: [f64; 4] = [0.1478, 0.1476, 1.09e-4, 2.2e-4];
const H: f64 = 1e-3;
const SAMPLES: usize = 2500;

/// Positions from this state on: J v̇ = m g a sin q − k v, q from upright, by the classical Runge–Kutta method.
fn swing(mut state: [f64; 2]) -> Rows {
    let [m, a, inertia, friction] = PENDULUM;
    let about_joint = inertia + m * a * a;
    let rate = |[q, v]: [f64; 2]| [v, (m * 9.81 * a * q.sin() - friction * v) / about_joint];
    let moved =
        |[q, v]: [f64; 2], part: f64, rate: [f64; 2]| [q + part * H * rate[0], v + part * H * rate[1]];
    let mut positions = Vec::new();
    for _ in 0..SAMPLES {
        positions.push([state[0]]);
        let one = rate(state);
        let two = rate(moved(state, 0.5, one));
        let three = rate(moved(state, 0.5, two));
        let four = rate(moved(state, 1.0, three));
        for (part, rate) in [(1.0, one), (2.0, two), (2.0, three), (1.0, four)] {
            state = moved(state, part / 6.0, rate);
        }
    }
    Rows::from_rows(1, positions).unwrap()
}

fn bench(swings: usize) -> Bench {
    let bench = Bench::new();
    let trajectory = |k: usize| {
        let q = swing([1.5 + 0.2 * k as f64, 0.5]);
        Trajectory { id: k as i64, t0: 0.0, q, v: None, a: None, u: None }
    };
    let trajectories = (0..swings).map(trajectory).collect();
    std::fs::create_dir(bench.at("multi-arm")).unwrap();
    let all = Dataset { n: 1, h: H, control: None, trajectories };
    write(bench.at("multi-arm/single_id.npz"), &all).unwrap();
    bench
}

#[test]
fn free_swings_are_predicted_and_their_scale_is_said_to_be_free() {
    let found = bench(4).run("hardware --data . --machine multi-arm --json").good().json();
    let rows = found["rows"].as_array().unwrap();
    let error = |model: usize, key: &str| rows[model][key].as_f64().unwrap();
    assert_eq!((rows.len(), error(0, "windows")), (3, 6.0));
    // A quadratic through 21 samples leaves an error of its own.
    for model in [1, 2] {
        assert!(error(model, "error_1s") < 2e-3 && error(0, "error_1s") > 0.1, "{rows:?}");
    }
    let numbers = rows[2]["numbers"].as_array().unwrap();
    assert_eq!(numbers.len(), 3);
    for number in numbers {
        assert_eq!(number["is_free"], true, "{number}");
        let ratio = number["learned"].as_f64().unwrap() / number["published"].as_f64().unwrap();
        assert!((0.05..20.0).contains(&ratio), "{number}");
    }
}

#[test]
fn what_cannot_be_used_is_said() {
    let run = |swings: usize, rest: &str| {
        bench(swings).run(&format!("hardware --data . --machine multi-arm {rest}"))
    };
    run(1, "").bad(2, &["single_id.npz", "only one swing"]);
    run(2, "--test 1").bad(2, &["--test"]);
    let empty = Bench::new();
    std::fs::create_dir(empty.at("multi-arm")).unwrap();
    empty.run("hardware --data . --machine multi-arm").bad(2, &["double_id.npz"]);
}
