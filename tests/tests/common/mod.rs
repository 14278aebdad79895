//! Training by the library, in the same way as `leastaction train` and `leastaction export`.

use leastaction_ground_truth::{Mechanism, Settings, generate};
use leastaction_learning::checkpoint::Trained;
use leastaction_learning::config::Config;
use leastaction_learning::data::Dataset;
use leastaction_learning::run::{Monitor, Plan, Row, Run};
use leastaction_models::config::{Coordinates, InertiaNetworkConfig};
use leastaction_models::file::encode;
use std::sync::atomic::AtomicBool;

/// A monitor that treats warnings as failures.
struct Strict;

impl Monitor for Strict {
    fn row(&mut self, _: &Row) {}

    fn warning(&mut self, message: &str) {
        panic!("{message}");
    }
}

/// Returns short motions of the cart-pole under random forces.
pub fn log(trajectories: usize) -> Dataset {
    generate(&Settings::symo(Mechanism::Cartpole, trajectories, 0)).unwrap()
}

/// A network of two layers for the cart-pole.
pub fn config(width: u16, iterations: u64) -> Config {
    let coordinates = Coordinates(Mechanism::Cartpole.coordinates().to_vec());
    let model = InertiaNetworkConfig { hidden: vec![width; 2], ..InertiaNetworkConfig::new(coordinates) };
    let mut config = Config::new("log.npz", model);
    config.training.iterations = iterations;
    config
}

/// Returns the model file for a configuration and a log.
pub fn model_file(config: Config, log: &Dataset) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let mut run = Run::begin(Plan::new(config, log).unwrap(), folder.path(), false).unwrap();
    run.train(&mut Strict, &AtomicBool::new(false)).unwrap();
    let Trained { architecture, trained_step, best, provenance, .. } = Trained::read(folder.path()).unwrap();
    encode(&architecture, &best.weights, trained_step, &provenance).unwrap()
}
