use crate::support::Bench;

/// Trains k iterations and resumes up to n; also trains n iterations in one go. Returns both model files.
fn interrupted_and_straight(bench: &Bench, settings: &str, (k, n): (u64, u64)) -> [Vec<u8>; 2] {
    let iterations = |count: u64| bench.config(&format!("iterations = {count}\n{settings}"));
    iterations(k);
    bench.run("train c.toml -o parts -q").good();
    iterations(n);
    bench.run("train c.toml -o parts -q --resume").good();
    bench.run("train c.toml -o straight -q").good();
    [bench.model("parts"), bench.model("straight")]
}

#[test]
fn a_resumed_run_gives_the_same_bits() {
    for settings in ["", "optimiser = \"adam\"\n[training.adam]\nbatch = 8\nplateau_patience = 1"] {
        let bench = Bench::new();
        bench.log("");
        let [parts, straight] = interrupted_and_straight(&bench, settings, (2, 7));
        assert_eq!(parts, straight, "{settings}");
        let rows = |run: &str| -> Vec<String> {
            let history = bench.text(&format!("{run}/history.csv"));
            let without_time = |line: &str| {
                line.splitn(4, ',').enumerate().filter(|(i, _)| *i != 2).map(|(_, c)| c).collect()
            };
            history.lines().map(without_time).collect()
        };
        assert_eq!(rows("parts"), rows("straight"), "{settings}");
    }
}

#[test]
fn stopping_in_the_warm_up_gives_the_same_bits() {
    let bench = Bench::new();
    bench.log("");
    bench.config("iterations = 3");
    bench.run("train c.toml -o straight -q").good();
    bench.config("iterations = 3\nmax_seconds = 1e-9");
    assert_eq!(bench.run("train c.toml -o parts -q --json").good().json()["iterations"].as_u64(), Some(1));
    bench.config("iterations = 3");
    bench.run("train c.toml -o parts -q --resume").good();
    assert_eq!(bench.model("parts"), bench.model("straight"));
}

#[test]
fn the_number_of_threads_does_not_matter() {
    let bench = Bench::new();
    bench.log("--seed 2");
    bench.config("iterations = 4");
    for threads in ["1", "2", "3"] {
        let run = format!("train c.toml -o run{threads} -q");
        assert!(bench.command(&run).env("RAYON_NUM_THREADS", threads).status().unwrap().success());
    }
    bench.config("iterations = 4\nthreads = 2");
    bench.run("train c.toml -o run4 -q").good();
    let one = bench.model("run1");
    for other in ["run2", "run3", "run4"] {
        assert_eq!(one, bench.model(other), "{other}");
    }
}

#[test]
fn the_data_may_move_but_not_change() {
    let bench = Bench::new();
    bench.log("");
    bench.config("iterations = 1");
    bench.run("train c.toml -o run -q").good();
    std::fs::create_dir(bench.at("elsewhere")).unwrap();
    std::fs::rename(bench.at("data.npz"), bench.at("elsewhere/data.npz")).unwrap();
    bench.write("moved.toml", &bench.text("c.toml").replace("data.npz", "elsewhere/data.npz"));
    bench.run("train moved.toml -o run -q --resume").good();
    bench.log("--seed 1");
    bench.run("train c.toml -o run -q --resume").bad(2, &["cannot resume", "other data"]);
}

#[test]
fn another_configuration_is_refused_by_its_keys() {
    let bench = Bench::new();
    bench.log("");
    bench.config("iterations = 1");
    bench.run("train c.toml -o run -q --resume").bad(2, &["cannot resume", "checkpoint.postcard"]);
    bench.run("train c.toml -o run -q").good();
    let before = bench.read("run/checkpoint.postcard");
    bench.config("iterations = 1\nseed = 7");
    bench.run("train c.toml -o run -q --resume").bad(2, &["`seed = 0` then, `seed = 7` now"]);
    bench.write("c.toml", &bench.text("c.toml").replace("[6]", "[5]").replace("seed = 7", ""));
    bench.run("train c.toml -o run -q --resume").bad(2, &["hidden"]);
    assert_eq!(bench.read("run/checkpoint.postcard"), before);
}

#[test]
fn a_damaged_checkpoint_is_refused() {
    let bench = Bench::new();
    bench.log("");
    bench.config("iterations = 1");
    bench.run("train c.toml -o run -q").good();
    let good = bench.read("run/checkpoint.postcard");
    for (length, flipped) in
        [(good.len(), 3), (good.len(), good.len() / 2), (good.len() - 1, 0), (5, 0), (0, 0)]
    {
        let mut bytes = good[..length].to_vec();
        if flipped > 0 {
            bytes[flipped] ^= 1;
        }
        std::fs::write(bench.at("run/checkpoint.postcard"), bytes).unwrap();
        bench.run("train c.toml -o run -q --resume").bad(2, &["undamaged", "--force"]);
        bench.run("export run -o m.postcard").bad(2, &["checkpoint.postcard"]);
    }
}
