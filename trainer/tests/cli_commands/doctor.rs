//! The commands `doctor`, `completions` and `man`.

use crate::support::Bench;
use std::collections::BTreeSet;

#[test]
fn what_is_missing_is_said_with_its_remedy() {
    let bench = Bench::new();
    let mut bare = bench.command("doctor --json");
    let report = crate::support::Outcome::new(bare.env("PATH", bench.at("")).output().unwrap()).good().json();
    assert_eq!(report["version"], env!("CARGO_PKG_VERSION"));
    assert!(report["threads"].as_u64().unwrap() >= 1);
    let parts = report["parts"].as_array().unwrap();
    for name in ["rustc", "target thumbv7em-none-eabihf", "qemu-system-arm", "arm-none-eabi-gcc"] {
        let part = parts.iter().find(|part| part["name"] == name).unwrap();
        assert!(part["found"].is_null() && !part["remedy"].as_str().unwrap().is_empty(), "{part}");
    }
    let text =
        crate::support::Outcome::new(bench.command("doctor").env("PATH", bench.at("")).output().unwrap());
    let text = text.good().stdout;
    assert!(text.contains("rustup target add thumbv7em-none-eabihf"), "{text}");
}

#[cfg(unix)]
#[test]
fn a_program_that_is_there_is_found() {
    use std::os::unix::fs::PermissionsExt;
    let bench = Bench::new();
    bench.write("qemu-system-arm", "#!/bin/sh\necho QEMU emulator version 99\necho more\n");
    std::fs::set_permissions(bench.at("qemu-system-arm"), PermissionsExt::from_mode(0o755)).unwrap();
    let mut command = bench.command("doctor --json");
    let report =
        crate::support::Outcome::new(command.env("PATH", bench.at("")).output().unwrap()).good().json();
    let parts = report["parts"].as_array().unwrap();
    let found = parts.iter().find(|part| part["name"] == "qemu-system-arm").unwrap();
    assert_eq!(found["found"], "QEMU emulator version 99");
}

#[test]
fn shells_learn_every_command() {
    let bench = Bench::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = bench.run(&format!("completions {shell}")).good().stdout;
        assert!(["train", "simulate", "weights"].iter().all(|word| script.contains(word)), "{shell}");
    }
    bench.run("completions tcsh").bad(2, &["tcsh", "bash"]);
    let object = bench.run("completions bash --json").good().json();
    assert!(object["script"].as_str().unwrap().starts_with("_leastaction"));
}

#[test]
fn every_command_has_a_manual_page() {
    let bench = Bench::new();
    let help = bench.run("--help").good().stdout;
    let listed = help.split("Commands:\n").nth(1).unwrap().split("\n\n").next().unwrap();
    let names =
        listed.lines().filter_map(|line| line.split_whitespace().next()).filter(|name| *name != "help");
    let mut expected: BTreeSet<String> = names.map(|name| format!("leastaction-{name}.1")).collect();
    expected.insert("leastaction.1".into());
    let report = bench.run("man pages --json").good().json();
    let pages: BTreeSet<String> =
        report["pages"].as_array().unwrap().iter().map(|page| page.as_str().unwrap().to_owned()).collect();
    assert_eq!(pages, expected);
    let train = bench.text("pages/leastaction-train.1");
    assert!(train.contains(".TH") && train.contains("\\-\\-resume"), "{train}");
    bench.write("file", "not a folder");
    bench.run("man file").bad(2, &["file", "name a folder"]);
}
