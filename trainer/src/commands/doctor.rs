//! `leastaction doctor`.

use clap::Args;
use leastaction::cli::{Done, Output};
use leastaction::processor::Board;
use leastaction_core::model::FORMAT_VERSION;
use serde::Serialize;
use std::fmt;
use std::num::NonZero;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::available_parallelism;

/// Report what this machine has, and what is missing for work on chips.
///
/// Lists versions, threads and instruction sets; compilers, emulators and the images of emulated boards, each with its purpose and how to
/// get it. Learning needs none of these. Nothing is changed.
///
/// Example: leastaction doctor
#[derive(Args)]
pub struct Doctor {}

/// A tool or file that may be present.
#[derive(Serialize)]
struct Part {
    name: String,
    /// Version or path; `None` if it is missing.
    found: Option<String>,
    needed_for: &'static str,
    /// How to get it.
    remedy: String,
}

/// Report on the machine.
#[derive(Serialize)]
struct Report {
    version: &'static str,
    /// Format version of the model files that this program writes.
    format_version: u8,
    machine: String,
    threads: usize,
    /// Instruction sets beyond those that the program was compiled for.
    instruction_sets: Vec<&'static str>,
    parts: Vec<Part>,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { version, format_version, machine, threads, instruction_sets, parts } = self;
        writeln!(f, "leastaction {version}, model files of version {format_version}")?;
        writeln!(f, "{machine}, {threads} threads, {}\n", join_or(instruction_sets, "no wide instructions"))?;
        for Part { name, found, .. } in parts {
            writeln!(f, "{name:<40}  {}", found.as_deref().unwrap_or("MISSING"))?;
        }
        let missing: Vec<_> = parts.iter().filter(|part| part.found.is_none()).collect();
        if missing.is_empty() {
            return writeln!(f, "\nnothing is missing");
        }
        writeln!(f, "\nlearning needs none of what is missing:")?;
        missing
            .iter()
            .try_for_each(|part| writeln!(f, "  {}, for {}: {}", part.name, part.needed_for, part.remedy))
    }
}

fn join_or(words: &[&str], none: &str) -> String {
    if words.is_empty() { none.to_owned() } else { words.join(" ") }
}

impl Doctor {
    /// Examines the machine and reports.
    pub fn run(self, output: Output) -> Done {
        output.report(&Report {
            version: env!("CARGO_PKG_VERSION"),
            format_version: FORMAT_VERSION,
            machine: format!("{} {}", std::env::consts::ARCH, std::env::consts::OS),
            threads: available_parallelism().map_or(1, NonZero::get),
            instruction_sets: instruction_sets(),
            parts: parts(),
        })
    }
}

/// Available instruction sets that the programs of this project use.
#[cfg(target_arch = "x86_64")]
fn instruction_sets() -> Vec<&'static str> {
    let sets = [
        ("avx2", std::is_x86_feature_detected!("avx2")),
        ("fma", std::is_x86_feature_detected!("fma")),
        ("avx512f", std::is_x86_feature_detected!("avx512f")),
    ];
    sets.into_iter().filter_map(|(name, there)| there.then_some(name)).collect()
}

/// Available instruction sets that programs here make use of.
#[cfg(not(target_arch = "x86_64"))]
fn instruction_sets() -> Vec<&'static str> {
    if cfg!(target_feature = "neon") { vec!["neon"] } else { Vec::new() }
}

const BOARDS: [Board; 3] = [Board::CortexM4, Board::CortexM7, Board::Riscv];

fn parts() -> Vec<Part> {
    let program = |name: &str, needed_for, remedy: &str| Part {
        name: name.to_owned(),
        found: version(name),
        needed_for,
        remedy: remedy.to_owned(),
    };
    let mut parts = vec![
        program("rustc", "firmware in Rust", "https://rustup.rs"),
        program("cargo", "firmware in Rust", "https://rustup.rs"),
        target(Board::CortexM4),
        target(Board::Riscv),
        program(
            "arm-none-eabi-gcc",
            "firmware in C on ARM",
            "apt-get install gcc-arm-none-eabi libnewlib-arm-none-eabi (Debian, Ubuntu)",
        ),
    ];
    for board in [Board::CortexM4, Board::Riscv] {
        let install = format!("apt-get install {} (Debian, Ubuntu)", board.package());
        parts.push(program(board.emulator(), "simulate --on", &install));
    }
    parts.extend(BOARDS.map(image));
    parts
}

/// Standard library for a chip.
fn target(board: Board) -> Part {
    let name = board.target();
    let folder = printed("rustc", &["--print", "target-libdir", "--target", name]);
    Part {
        name: format!("target {name}"),
        found: folder.filter(|folder| Path::new(folder).is_dir()),
        needed_for: "firmware in Rust",
        remedy: format!("rustup target add {name}"),
    }
}

/// Controller image for an emulated board.
fn image(board: Board) -> Part {
    Part {
        name: format!("image for {}", board.name()),
        found: board.image(None, 2).ok().map(|path| path.display().to_string()),
        needed_for: "simulate --on",
        remedy: "firmware-sim/chip/run.sh --build, in the repository".to_owned(),
    }
}

/// Version that a program reports.
fn version(program: &str) -> Option<String> {
    printed(program, &["--version"])
}

/// First line that a program prints; `None` if there is no such program, or if it fails.
fn printed(program: &str, arguments: &[&str]) -> Option<String> {
    let done =
        Command::new(program).args(arguments).stdin(Stdio::null()).stderr(Stdio::null()).output().ok()?;
    let text = done.status.success().then(|| String::from_utf8_lossy(&done.stdout).into_owned())?;
    text.lines().next().map(|line| line.trim().to_owned())
}
