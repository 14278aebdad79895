//! Runs the command in a folder of its own.

use serde_json::Value;
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};
use tempfile::TempDir;

/// A working folder that vanishes.
pub struct Bench {
    pub folder: TempDir,
}

/// What a call of the command gave.
pub struct Outcome {
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl Outcome {
    pub fn new(output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Self { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
    }

    /// The one JSON object on stdout, nothing else.
    pub fn json(&self) -> Value {
        serde_json::from_str(&self.stdout).unwrap_or_else(|error| panic!("{error}: {:?}", self.stdout))
    }

    /// Success.
    pub fn good(self) -> Self {
        assert_eq!(self.code, Some(0), "{}", self.stderr);
        self
    }

    /// Failure with this code and these words on stderr, nothing on stdout.
    pub fn bad(self, code: i32, words: &[&str]) -> Self {
        assert_eq!((self.code, self.stdout.as_str()), (Some(code), ""), "{}", self.stderr);
        for word in words {
            assert!(self.stderr.contains(word), "{word:?} is not in {}", self.stderr);
        }
        self
    }
}

impl Bench {
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    /// A path in the folder.
    pub fn at(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.at(name)).unwrap()
    }

    pub fn text(&self, name: &str) -> String {
        fs::read_to_string(self.at(name)).unwrap()
    }

    pub fn write(&self, name: &str, text: &str) {
        fs::write(self.at(name), text).unwrap();
    }

    /// The command with these words, separated by spaces, to be run in the folder.
    pub fn command(&self, words: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_leastaction"));
        command
            .args(words.split_whitespace())
            .current_dir(self.folder.path())
            .env_remove("RAYON_NUM_THREADS");
        command
    }

    pub fn run(&self, words: &str) -> Outcome {
        Outcome::new(self.command(words).output().unwrap())
    }

    /// A small log of the pendulum.
    pub fn log(&self, options: &str) {
        self.run(&format!("generate pendulum -o data.npz --trajectories 4 --samples 12 {options}")).good();
    }

    /// A small network, and what `training` says.
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
