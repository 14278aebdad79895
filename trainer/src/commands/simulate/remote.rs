//! The controller on another processor.

use super::scenario::misused;
use super::{Report, Request};
use crate::commands::interrupt;
use clap::ValueEnum;
use leastaction::cli::Failure;
use leastaction::processor::{Board, BoardError, Emulator, LinkError, Remote};
use leastaction_firmware_sim::control::Trajectory;
use leastaction_firmware_sim::scenario::{RunError, Setup, run_on};
use leastaction_firmware_sim::{Mechanism, Program, Summary, Tick, Timeline};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// An emulated board, by its name on the command line.
#[derive(Clone, Copy, ValueEnum)]
pub enum Emulated {
    /// Cortex-M4 with a floating-point unit (Arm MPS2, AN386).
    CortexM4,
    /// Cortex-M7 (Arm MPS2, AN500).
    CortexM7,
    /// 32-bit RISC-V without a floating-point unit (QEMU's "virt").
    Riscv,
}

impl From<Emulated> for Board {
    fn from(board: Emulated) -> Self {
        match board {
            Emulated::CortexM4 => Self::CortexM4,
            Emulated::CortexM7 => Self::CortexM7,
            Emulated::Riscv => Self::Riscv,
        }
    }
}

/// The processor that runs the controller.
pub struct Target {
    /// The board.
    pub board: Board,
    /// The controller's image; `None`: the built one.
    pub image: Option<PathBuf>,
    /// The model file, which goes into the board's flash.
    pub model: PathBuf,
    /// The files of plans, which go there, too.
    pub plans: Vec<PathBuf>,
    /// Longest wait for an answer.
    pub patience: Duration,
}

/// Result of a program on a board.
pub struct Ran<const N: usize> {
    /// Summary of the run.
    pub summary: Summary<N>,
    /// Instructions of every tick.
    pub instructions: Vec<u32>,
}

impl Target {
    /// Runs a program on the board against a plant.
    pub fn run<P: Mechanism<N>, const N: usize>(
        &self,
        request: &Request,
        plant: Timeline<P>,
        (setup, trajectory): (&Setup<N>, impl Trajectory<N>),
        program: &Program<N>,
        sink: impl FnMut(&Tick<N>),
    ) -> Result<Report, Failure> {
        let ran = self.with(program, |remote| run_on(plant, remote, setup, trajectory, sink))?;
        let mut report = Report::new(request, &ran.summary);
        report.on_processor(self.board.name(), &ran.instructions);
        Ok(report)
    }

    /// Starts a program on the board and passes it to `run`.
    pub fn with<const N: usize>(
        &self,
        program: &Program<N>,
        run: impl FnOnce(&mut Remote<Emulator, N>) -> Result<Summary<N>, RunError<LinkError>>,
    ) -> Result<Ran<N>, Failure> {
        let remote = Remote::begin(self.start(N, None)?, program, self.patience);
        self.through(remote, run, |_| Ok(())).map(|(ran, ())| ran)
    }

    /// Starts a program on the board, whose model's numbers follow by settings, and passes it to `run`. Returns the patch that the board saved,
    /// too.
    pub fn adapting<const N: usize>(
        &self,
        program: &Program<N>,
        settings: &Path,
        run: impl FnOnce(&mut Remote<Emulator, N>) -> Result<Summary<N>, RunError<LinkError>>,
    ) -> Result<(Ran<N>, Vec<u8>), Failure> {
        let remote = Remote::adapt(self.start(N, Some(settings))?, program, self.patience);
        self.through(remote, run, Remote::saved)
    }

    /// Takes a program that has begun through its run, and ends it; `last` is what is asked after the run.
    fn through<T, const N: usize>(
        &self,
        begun: Result<Remote<Emulator, N>, LinkError>,
        run: impl FnOnce(&mut Remote<Emulator, N>) -> Result<Summary<N>, RunError<LinkError>>,
        last: impl FnOnce(&mut Remote<Emulator, N>) -> Result<T, LinkError>,
    ) -> Result<(Ran<N>, T), Failure> {
        let name = self.board.name();
        let mut remote = begun.map_err(|error| not_begun(error, name))?;
        if remote.name() != name {
            return Err(Failure::Work(format!(
                "the image on the {name} says that it is a {}",
                remote.name()
            )));
        }
        let summary = run(&mut remote).map_err(|error| not_run(error, name))?;
        let last =
            last(&mut remote).map_err(|error| failure(error, &format!("{name}, after the last tick")))?;
        let instructions = remote.instructions().to_vec();
        // The run is over; if the emulator is not told, it ends soon anyway.
        if let Ok(emulator) = remote.end() {
            emulator.finish();
        }
        Ok((Ran { summary, instructions }, last))
    }

    fn start(&self, coordinates: usize, settings: Option<&Path>) -> Result<Emulator, Failure> {
        let failed = |error: &dyn std::fmt::Display| Failure::Work(error.to_string());
        let image = self.board.image(self.image.as_deref(), coordinates).map_err(|error| match error {
            BoardError::Coordinates(_) => Failure::Input(error.to_string()),
            error => failed(&error),
        })?;
        let files = [&self.model].into_iter().chain(&self.plans).map(PathBuf::as_path);
        let files: Vec<_> = files.chain(settings).collect();
        Emulator::start(self.board, &image, &files, interrupt::flag()?).map_err(|error| failed(&error))
    }
}

impl<const N: usize> Ran<N> {
    /// Result of a program on this machine.
    pub fn here(run: Result<Summary<N>, RunError<LinkError>>) -> Result<Self, Failure> {
        let summary = run.map_err(|error| not_run(error, "host"))?;
        Ok(Self { summary, instructions: Vec::new() })
    }
}

/// The failure of a run on a processor.
fn not_run(error: RunError<LinkError>, name: &str) -> Failure {
    match error {
        RunError::Setup(error) => misused(error),
        RunError::Processor { tick, error } => failure(error, &format!("{name}, tick {tick}")),
    }
}

/// The failure to begin. A processor that does not answer at all probably runs another program.
fn not_begun(error: LinkError, name: &str) -> Failure {
    let hint = match &error {
        LinkError::Timeout(_) | LinkError::Closed(_) | LinkError::Broken => {
            "; is the image the controller's, and of this board?"
        }
        _ => "",
    };
    match failure(error, &format!("{name}, before the first tick")) {
        Failure::Work(message) => Failure::Work(message + hint),
        other => other,
    }
}

fn failure(error: LinkError, place: &str) -> Failure {
    match error {
        LinkError::Interrupted => Failure::Interrupted(format!("{place}: interrupted")),
        _ => Failure::Work(format!("{place}: {error}")),
    }
}
