//! Ctrl-C and a full disk.
#![cfg(unix)]

use crate::support::{Bench, Outcome};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

const LONG: u64 = 2000;

/// A long run that has done a few iterations.
pub fn started(bench: &Bench) -> Child {
    bench.log("");
    bench.config(&format!("iterations = {LONG}\noptimiser = \"adam\""));
    let mut command = bench.command("train c.toml -o run -q");
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    while std::fs::read_to_string(bench.at("run/history.csv")).map_or(0, |history| history.lines().count())
        < 6
    {
        std::thread::sleep(Duration::from_millis(5));
    }
    child
}

pub fn signal(child: &Child, name: &str) {
    assert!(Command::new("kill").args([name, &child.id().to_string()]).status().unwrap().success());
}

fn iterations(bench: &Bench) -> u64 {
    let history = bench.text("run/history.csv");
    history.lines().last().unwrap().split(',').next().unwrap().parse().unwrap()
}

#[test]
fn ctrl_c_saves_and_says_how_to_go_on() {
    let bench = Bench::new();
    let child = started(&bench);
    signal(&child, "-INT");
    let outcome = Outcome::new(child.wait_with_output().unwrap());
    let stopped = iterations(&bench);
    assert!(stopped < LONG, "it was over before the signal came");
    outcome.bad(130, &[&format!("iteration {stopped} is saved"), "leastaction train c.toml -o run --resume"]);
    bench.config(&format!("iterations = {}\noptimiser = \"adam\"", stopped + 2));
    bench.run("train c.toml -o run -q --resume").good();
    bench.run("train c.toml -o straight -q").good();
    assert_eq!(bench.model("run"), bench.model("straight"));
}

#[test]
fn a_killed_run_goes_on_from_its_last_checkpoint() {
    let bench = Bench::new();
    let mut child = started(&bench);
    signal(&child, "-KILL");
    child.wait().unwrap();
    bench.config("iterations = 20\noptimiser = \"adam\"");
    bench.run("train c.toml -o run -q --resume").good();
    bench.run("train c.toml -o straight -q").good();
    if iterations(&bench) == 23 {
        assert_eq!(bench.model("run"), bench.model("straight"));
    }
    let history = bench.text("run/history.csv");
    let numbers: Vec<&str> = history.lines().skip(1).map(|line| line.split(',').next().unwrap()).collect();
    assert!(numbers.iter().enumerate().all(|(i, number)| *number == (i + 1).to_string()), "{numbers:?}");
}

/// The command in a shell whose files may not grow beyond `blocks` blocks of 512 bytes, like a full disk.
fn on_a_full_disk(bench: &Bench, blocks: u32, words: &str) -> Outcome {
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" {words}");
    let mut shell = Command::new("sh");
    shell.args(["-c", &script, env!("CARGO_BIN_EXE_leastaction")]).current_dir(bench.folder.path());
    Outcome::new(shell.output().unwrap())
}

#[test]
fn a_full_disk_keeps_the_last_checkpoint() {
    let bench = Bench::new();
    bench.log("");
    // The network is wide enough for a checkpoint above the limit, while the history stays below.
    let wide = |iterations: u64| {
        bench.config(&format!("iterations = {iterations}\ncheckpoint_iterations = 1"));
        bench.write("c.toml", &bench.text("c.toml").replace("[6]", "[40]"));
    };
    wide(2);
    bench.run("train c.toml -o run -q").good();
    let before = bench.read("run/checkpoint.postcard");
    assert!(before.len() > 2048, "{}", before.len());
    wide(4);
    let full = on_a_full_disk(&bench, 2, "train c.toml -o run -q --resume");
    full.bad(
        1,
        &["warning: run: cannot save iteration 6", "checkpoint of iteration 5 is intact", "--resume"],
    );
    assert_eq!(bench.read("run/checkpoint.postcard"), before);
    let names: Vec<_> =
        std::fs::read_dir(bench.at("run")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert!(names.iter().all(|name| !name.to_string_lossy().ends_with(".tmp")), "{names:?}");
    bench.run("train c.toml -o run -q --resume").good();
    bench.run("train c.toml -o straight -q").good();
    assert_eq!(bench.model("run"), bench.model("straight"));
}

#[test]
fn a_folder_that_cannot_be_made_is_an_error() {
    let bench = Bench::new();
    bench.log("");
    bench.config("iterations = 1");
    bench.write("file", "");
    bench
        .run("train c.toml -o file/run -q")
        .bad(1, &["file/run", "remove what stands in its place, or choose another folder"]);
}
