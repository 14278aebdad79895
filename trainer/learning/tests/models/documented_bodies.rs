//! The examples of docs/book/src/bodies.md, as they stand there, on exact motion.

use crate::page::{self, Strict};
use leastaction_core::continuous::acceleration;
use leastaction_core::energy::bodies::{BODY_PARAMETERS, GRAVITY_PARAMETERS, PlanarBodies};
use leastaction_core::forces::{System, Viscous};
use leastaction_core::model::Laws;
use leastaction_learning::checkpoint::Trained;
use leastaction_learning::config::Config;
use leastaction_learning::data::{Dataset, Rows, Trajectory};
use leastaction_learning::evaluate::acceleration_mse;
use leastaction_learning::run::{Plan, Run};
use leastaction_models::BodiesArchitecture;
use std::path::Path;
use std::sync::atomic::AtomicBool;

const PAGE: &str = include_str!("../../../../docs/book/src/bodies.md");

/// Arbitrary forced states with their accelerations.
pub fn log<const N: usize>(bodies: &BodiesArchitecture, weights: &[f64], trajectories: i64) -> Dataset {
    let system: System<PlanarBodies<f64, N>, Viscous<f64, N>> =
        bodies.header().system(Laws::NONE, weights).unwrap();
    let trajectory = |id: i64| {
        let [mut q, mut v, mut a, mut u] = [const { Vec::new() }; 4];
        for k in 0..40 {
            let at = |j: usize, size: f64| -> [f64; N] {
                std::array::from_fn(|i| {
                    size * (1.7 * id as f64 + 0.9 * k as f64 + 2.3 * (i + j) as f64).sin()
                })
            };
            let (position, velocity, force) = (at(0, 2.5), at(2, 4.0), at(4, 2.0));
            a.extend(acceleration(&system, &position, &velocity, &force).unwrap());
            for (to, x) in [(&mut q, position), (&mut v, velocity), (&mut u, force)] {
                to.extend(x);
            }
        }
        let rows = |x| Rows::from_flat(N, x).unwrap();
        Trajectory { id, t0: 0.0, q: rows(q), v: Some(rows(v)), a: Some(rows(a)), u: Some(rows(u)) }
    };
    Dataset { n: N, h: 0.01, control: None, trajectories: (0..trajectories).map(trajectory).collect() }
}

/// The error, relative to the mean square, of the documented example trained on logs of the machine with the numbers changed by `change`.
fn learned<const N: usize>(name: &str, change: impl Fn(&mut [f64])) -> f64 {
    let config = Config::parse(page::example(PAGE, name), Path::new(name)).unwrap();
    let (architecture, mut weights) = config.beginning().unwrap();
    change(&mut weights);
    let data = log::<N>(architecture.family.bodies().unwrap(), &weights, 8);
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    let plan = Plan::new(config, &data).unwrap();
    Run::begin(plan, &run, true).unwrap().train(&mut Strict, &AtomicBool::new(false)).unwrap();
    let trained = Trained::read(&run).unwrap();
    let (error, square) = acceleration_mse(&trained.model(), &data).unwrap().unwrap();
    println!("{name}: {:.1e}", error.or_infinite() / square);
    error.or_infinite() / square
}

/// A number of a body.
const fn number(body: usize, which: usize) -> usize {
    GRAVITY_PARAMETERS + BODY_PARAMETERS * body + which
}

#[test]
fn a_chain() {
    let machine = |weights: &mut [f64]| {
        for (at, value) in
            [(number(0, 3), 0.5), (number(1, 0), 0.2), (number(1, 4), 0.22), (number(1, 7), 2e-4)]
        {
            weights[at] = value;
        }
    };
    assert!(learned::<2>("chain.toml", machine) < 1e-12);
}

#[test]
fn a_crane() {
    let machine = |weights: &mut [f64]| {
        for (at, value) in [
            (number(1, 1), 0.4),
            (number(1, 3), 1.6),
            (number(1, 5), -0.1),
            (number(2, 3), 0.7),
            (number(2, 6), 0.03),
        ] {
            weights[at] = value;
        }
    };
    assert!(learned::<3>("crane.toml", machine) < 1e-12);
}
