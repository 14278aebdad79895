//! `simulate --on`, with shell scripts in place of QEMU: every failure ends the run, is reported, and leaves nothing behind.
#![cfg(unix)]

use crate::support::{Bench, Outcome};
use leastaction_firmware_sim::Outcome as Tick;
use leastaction_firmware_sim::link::{Answer, Done, Frame, ModelRefusal, Refusal, answer};
use std::convert::Infallible;
use std::fs::{self, Permissions};
use std::os::unix::fs::PermissionsExt;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const MODEL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../firmware-sim/chip/models/cartpole.postcard");

/// A folder with an image that no emulator here looks at, and an emulator that runs these shell lines.
fn bench(emulator: &str) -> Bench {
    let bench = Bench::new();
    bench.write("image", "");
    fs::create_dir(bench.at("bin")).unwrap();
    bench.write("bin/qemu-system-arm", &format!("#!/bin/sh\n{emulator}\n"));
    fs::set_permissions(bench.at("bin/qemu-system-arm"), Permissions::from_mode(0o755)).unwrap();
    bench
}

/// The command, with the emulator before all others.
fn command(bench: &Bench, options: &str) -> Command {
    let mut command = bench.command(&format!("simulate {MODEL} --scenario swing-up {options}"));
    let path = format!("{}:{}", bench.at("bin").display(), std::env::var("PATH").unwrap());
    command.env("PATH", path).env("LEASTACTION_CHIP_TARGET", bench.at("nowhere"));
    command
}

fn run(bench: &Bench, options: &str) -> Outcome {
    Outcome::new(command(bench, options).output().unwrap())
}

const ON: &str = "--on cortex-m4 --image image";

/// Writes the bytes of frames into a file that an emulator can send.
fn says(bench: &Bench, file: &str, frames: &[Frame]) {
    let mut bytes = Vec::new();
    for frame in frames {
        let Ok(()) = frame.send(|byte| {
            bytes.push(byte);
            Ok::<(), Infallible>(())
        });
    }
    fs::write(bench.at(file), bytes).unwrap();
}

fn frame(message: &Answer<'_, 2>) -> Frame {
    answer(message).unwrap()
}

/// Waits until the emulator, which wrote its process id, is gone.
fn gone(bench: &Bench) {
    let number = bench.text("number");
    let lives = || {
        let mut kill = Command::new("kill");
        kill.args(["-0", number.trim()]).stderr(Stdio::null()).status().unwrap().success()
    };
    let begin = Instant::now();
    while lives() {
        assert!(begin.elapsed() < Duration::from_secs(10), "the emulator lives on");
        std::thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn without_image_or_emulator_it_says_what_to_do() {
    let bench = bench("exit 0");
    run(&bench, "--on cortex-m4").bad(
        1,
        &["no image for cortex-m4f", "firmware-sim/chip/run.sh --build", "nowhere/cortex-m4f", "--image"],
    );
    run(&bench, "--on riscv --image no.elf").bad(1, &["no.elf", "no such image", "run.sh --build"]);
    let none = command(&bench, ON).env("PATH", bench.at("nowhere")).output().unwrap();
    Outcome::new(none).bad(1, &["qemu-system-arm is not installed", "apt-get install qemu-system-arm"]);
}

#[test]
fn what_makes_no_sense_on_a_board_is_refused() {
    let bench = bench("exit 0");
    run(&bench, "--on cortex-m5").bad(2, &["cortex-m5", "cortex-m7", "riscv"]);
    run(&bench, "--image image").bad(2, &["--on"]);
    run(&bench, &format!("{ON} --timeout 0")).bad(2, &["--timeout", "above 0"]);
    run(&bench, &format!("{ON} --tick 1e9")).bad(2, &["length of the run"]);
    let predict = bench.run(&format!("simulate {MODEL} --scenario predict {ON}"));
    predict.bad(2, &["predict has no controller"]);
}

#[test]
fn an_emulator_that_ends_is_quoted() {
    let bench = bench("echo 'it cannot load the kernel' >&2; exit 3");
    run(&bench, ON).bad(1, &["before the first tick", "ended (exit status: 3)", "it cannot load the kernel"]);
}

#[test]
fn silence_ends_the_run_and_the_emulator() {
    let bench = bench("echo $$ > number; exec sleep 600");
    run(&bench, &format!("{ON} --timeout 0.5")).bad(1, &["does not answer", "0.5 s"]);
    gone(&bench);
}

#[test]
fn noise_and_refusals_are_told_apart() {
    let bench = bench("cat said; exec sleep 600");
    fs::write(bench.at("said"), "Booting Linux\0").unwrap();
    run(&bench, ON).bad(1, &["damaged"]);
    says(
        &bench,
        "said",
        &[frame(&Answer::Refused(Refusal::Model(ModelRefusal { code: 35, numbers: [2, 1, 0] })))],
    );
    run(&bench, ON).bad(1, &["refuses", "shape is not the one", "code 35: 2, 1, 0"]);
    says(&bench, "said", &[frame(&Answer::Ready { processor: "cortex-m7" })]);
    run(&bench, ON).bad(1, &["the image on the cortex-m4f says that it is a cortex-m7"]);
}

#[test]
fn the_ticks_before_an_end_are_kept() {
    let bench = bench("cat said; exec sleep 600");
    let done = |sequence| Answer::Done(Done { sequence, outcome: Tick::waiting(), instructions: 9 });
    let ready = Answer::Ready { processor: "cortex-m4f" };
    says(&bench, "said", &[ready, done(1), done(2)].map(|message| frame(&message)));
    run(&bench, &format!("{ON} --timeout 0.5 -o out"))
        .bad(1, &["cortex-m4f, tick 2", "ticks before", "trace.csv"]);
    assert_eq!(bench.text("out/trace.csv").lines().count(), 3);
}

#[test]
fn ctrl_c_ends_the_emulator_too() {
    let bench = bench("echo $$ > number; exec sleep 600");
    let mut command = command(&bench, ON);
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    while fs::read_to_string(bench.at("number")).map_or(true, |number| !number.ends_with('\n')) {
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    Outcome::new(child.wait_with_output().unwrap()).bad(130, &["interrupted"]);
    gone(&bench);
}
