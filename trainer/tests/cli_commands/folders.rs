//! Ownership of run folders, and runs that give no model.

use crate::support::Bench;

/// A log with which no step can be solved.
fn hopeless(bench: &Bench) {
    let mut text = "# h = 0.1\ntrajectory,q0,u0\n".to_owned();
    for k in 0..40 {
        let q = 1e11 * f64::from(k * k % 7);
        text += &format!("{},{q},1\n", k / 10);
    }
    bench.write("hopeless.csv", &text);
    bench.write("hopeless.toml", &bench.text("c.toml").replace("data.npz", "hopeless.csv"));
}

#[test]
fn a_run_that_learned_nothing_is_not_exported_and_replaces_nothing() {
    let bench = Bench::new();
    bench.log("");
    bench.config("iterations = 2");
    hopeless(&bench);
    bench.run("train hopeless.toml -o none -q").bad(1, &["cannot be evaluated"]);
    bench
        .run("export none -o m.postcard")
        .bad(1, &["none: nothing was learned", "no training sample could be solved"]);
    assert!(!bench.at("m.postcard").exists());
    bench.run("train c.toml -o run -q").good();
    let before = (bench.model("run"), bench.text("run/history.csv"), bench.text("run/config.toml"));
    bench.run("train hopeless.toml -o run -q --force").bad(1, &["cannot be evaluated"]);
    bench.run("train missing.toml -o run -q --force").bad(2, &["missing.toml"]);
    assert_eq!((bench.model("run"), bench.text("run/history.csv"), bench.text("run/config.toml")), before);
}

#[cfg(unix)]
#[test]
fn two_trainings_do_not_share_a_folder() {
    use crate::interrupt::{signal, started};
    let bench = Bench::new();
    let mut child = started(&bench);
    for how in ["", "--force", "--resume"] {
        let words = ["run: another process is writing to this folder", "choose another folder"];
        bench.run(&format!("train c.toml -o run -q {how}")).bad(1, &words);
    }
    signal(&child, "-KILL");
    child.wait().unwrap();
    bench.config("iterations = 7\noptimiser = \"adam\"");
    bench.run("train c.toml -o run -q --resume").good();
}
