//! Small logs, configurations and models in the folder of a test.

use super::support::Bench;
use std::fs;

impl Bench {
    pub fn write(&self, name: &str, text: &str) {
        fs::write(self.at(name), text).unwrap();
    }

    /// A small log of the pendulum.
    pub fn log(&self, options: &str) {
        self.run(&format!("generate pendulum -o data.npz --trajectories 4 --samples 12 {options}")).good();
    }

    /// A configuration of a small network, with these `[training]` lines.
    pub fn config(&self, training: &str) {
        self.write("c.toml", &format!("{}[training]\norder = 2\nwarm_up = 3\n{training}\n", Self::MODEL));
    }

    const MODEL: &str =
        "[data]\nfile = \"data.npz\"\nvalidation = 0.25\n[model]\ncoordinates = [\"angle\"]\nhidden = [6]\n";

    /// The model file of a run.
    pub fn model(&self, run: &str) -> Vec<u8> {
        self.run(&format!("export {run} -o {run}.postcard")).good();
        self.read(&format!("{run}.postcard"))
    }
}
