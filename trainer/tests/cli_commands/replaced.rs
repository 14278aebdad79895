//! Files that a command may overwrite.

use crate::support::Bench;

fn trained() -> Bench {
    let bench = Bench::new();
    bench.log("");
    bench.config("iterations = 2");
    bench.run("train c.toml -o run -q").good();
    bench.model("run");
    bench
}

/// Checks that the command refuses to overwrite a file, and leaves it unchanged.
fn keeps(bench: &Bench, words: &str, file: &str) {
    let before = bench.read(file);
    bench.run(words).bad(2, &[file, "there is a file of this name", "name another file"]);
    assert!(bench.read(file) == before, "{words}");
}

#[test]
fn a_model_takes_the_place_of_a_model_alone() {
    let bench = trained();
    bench.run("generate pendulum -o log.csv --trajectories 2 --samples 4").good();
    bench.run("export run -o run.postcard --rust m.rs").good();
    for file in ["data.npz", "log.csv", "c.toml", "run/checkpoint.postcard", "run/history.csv", "m.rs"] {
        keeps(&bench, &format!("export run -o {file}"), file);
        keeps(&bench, &format!("convert run.postcard -o {file}"), file);
    }
    for file in ["data.npz", "c.toml", "run.postcard"] {
        keeps(&bench, &format!("export run -o new.postcard --rust {file}"), file);
    }
    assert!(!bench.at("new.postcard").exists());
    bench.run("export run -o new --rust new").bad(2, &["same file"]);
    for _ in 0..2 {
        bench.run("export run -o run.postcard --rust m.rs").good();
        bench.run("convert run.postcard -o run.postcard").good();
    }
    bench.write("empty", "");
    bench.run("export run -o empty").good();
    #[cfg(unix)]
    bench.run("export run -o /dev/null").good();
}

#[test]
fn a_log_takes_the_place_of_a_log_alone() {
    let bench = trained();
    bench.write("table.csv", "name,price\npear,3\n");
    bench.write("not.npz", "plain text");
    for file in ["table.csv", "not.npz", "run/history.csv"] {
        keeps(&bench, &format!("generate pendulum -o {file} --trajectories 2 --samples 4"), file);
    }
    for file in ["log.csv", "log.csv", "data.npz"] {
        bench.run(&format!("generate pendulum -o {file} --trajectories 2 --samples 4")).good();
    }
}

#[test]
fn tables_and_pictures_are_kept() {
    let bench = trained();
    std::fs::create_dir(bench.at("out")).unwrap();
    bench.write("out/trace.csv", "name,price\npear,3\n");
    keeps(&bench, "simulate run.postcard --scenario predict -o out", "out/trace.csv");
    bench.write("out/trace.csv", "");
    bench.write("out/run.svg", "mine");
    keeps(&bench, "simulate run.postcard --scenario predict -o out", "out/run.svg");
    bench.run("demo -q --out .").bad(2, &["not of an earlier demo", "--out"]);
    assert!(bench.run("evaluate run.postcard --data data.npz").good().stdout.contains("one step ahead"));
}
