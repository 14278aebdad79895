use super::support::Bench;

/// Two short tasks.
const SHORT: &str = "lgnn --case hybrid --iterations 2 --starts 1 --seeds 2";

#[test]
fn shares_of_two_machines_make_the_page_of_one() {
    let bench = Bench::new();
    bench.run(&format!("{SHORT} -o whole --jobs 2")).good();
    for share in ["1/2", "2/2"] {
        bench.run(&format!("{SHORT} -o {} --shard {share}", share.replace('/', "-"))).good();
    }
    bench.run("merge 1-2 2-2 -o joined").good();
    // All but the training time.
    let rows = |name: &str| -> Vec<Vec<String>> {
        let text = bench.text(name);
        let records = csv::Reader::from_reader(text.as_bytes()).into_records();
        let cells = |record: csv::StringRecord| {
            record.iter().enumerate().filter(|(k, _)| *k != 10).map(|(_, cell)| cell.to_owned()).collect()
        };
        records.map(|record| cells(record.unwrap())).collect()
    };
    assert_eq!(rows("joined/lgnn.csv"), rows("whole/lgnn.csv"));
    let page = bench.text("joined/lgnn.html");
    for words in ["LGNN", "2 seeds", "paper 1.30e-3", "<svg", "--case hybrid --seed 0 --iterations 2"] {
        assert!(page.contains(words), "{words}");
    }
    let again = bench.run(&format!("{SHORT} -o whole")).good();
    assert!(again.stderr.contains("2 of 2 tasks were done before"), "{}", again.stderr);
}

#[test]
fn a_later_narrower_run_loses_no_rows() {
    let bench = Bench::new();
    bench.run(&format!("{SHORT} -o out")).good();
    let pages = ["out/lgnn.html", "out/lgnn.csv", "out/lgnn.json"];
    let whole = pages.map(|page| bench.text(page));
    let later = bench.run(&format!("{SHORT} -o out --only hybrid-1 --json")).good();
    assert_eq!(later.json()["seed"], 1);
    assert_eq!(pages.map(|page| bench.text(page)), whole);
    let other = SHORT.replace("--case hybrid", "--case pendulum").replace("--starts 1", "--starts 2");
    let other = bench.run(&format!("{other} -o out --only pendulum-0")).good();
    assert!(other.stderr.contains("2 results") && other.stderr.contains("other options"), "{}", other.stderr);
    assert!(!bench.text("out/lgnn.csv").contains("hybrid"));
}

#[test]
fn tasks_are_chosen_by_name() {
    let bench = Bench::new();
    let names = |words: &str| bench.run(words).good().stdout;
    assert_eq!(
        names("lgnn --list --only drag --only hybrid"),
        "hybrid-0\nhybrid-force-0\ndrag-0\nhybrid-networks-alone-0\nhybrid-force-networks-alone-0\n"
    );
    assert_eq!(names("symo --list --quick --system pendulum --order 4 --seed 3").lines().count(), 8);
    assert_eq!(names("modlanet --list --ours-alone --shard 7/7"), "noise-0\n");
    let models = |words: &str| names(&format!("modlanet --list {words}")).lines().count();
    assert_eq!(
        (models("--case three-body"), models("--case three-body --baselines"), models("")),
        (1, 7, 19)
    );
    assert_eq!(
        names("symo --list --system acrobot --trajectories 16 --only node"),
        "acrobot-l-node-rk4-4-16-0\nacrobot-l-node-midpoint-2-16-0\nacrobot-node-rk4-4-16-0\nacrobot-node-midpoint-2-16-0\n"
    );
    bench.run("symo --model node-rk4 --order 2").bad(2, &["--order 2", "order 4"]);
    bench.run("lgnn --only pendulums").bad(2, &["pendulums", "--list"]);
    bench.run("lgnn --shard 3/2").bad(2, &["--shard", "I/N"]);
}

#[test]
fn baselines_of_symo_stand_beside_it() {
    let bench = Bench::new();
    bench.run("symo --system pendulum --trajectories 8 --quick --order 4 --only node -o out").good();
    let text = bench.text("out/symo.csv");
    let records: Vec<csv::StringRecord> =
        csv::Reader::from_reader(text.as_bytes()).into_records().collect::<Result<_, _>>().unwrap();
    let of = |model: &str, measure: &str| -> String {
        let is_it = |record: &&csv::StringRecord| &record[2] == model && &record[6] == measure;
        records.iter().find(is_it).unwrap_or_else(|| panic!("{model} {measure}: {text}"))[7].to_owned()
    };
    for model in ["l-node-rk4", "node-rk4"] {
        let test: f64 = of(model, "test").parse().unwrap();
        assert!(test < 1e-2, "{model}: {test}");
    }
    assert!(records.iter().all(|record| &record[3] == "false"), "{text}");
    assert!(of("l-node-rk4", "inertia").parse::<f64>().unwrap() < 1e-2);
    assert!(of("node-rk4", "inertia").parse::<f64>().is_err());
    let page = bench.text("out/symo.html");
    assert!(page.contains("--model node-rk4 --order 4"), "{page}");
}

#[test]
fn results_of_other_options_are_kept() {
    let bench = Bench::new();
    let short = "lgnn --case hybrid --iterations 2 --starts 1 -o out";
    bench.run(short).good();
    let before = bench.read("out/lgnn/hybrid-0.json");
    bench.run(&short.replace("--starts 1", "--starts 2")).bad(2, &["hybrid-0.json", "other options"]);
    assert_eq!(bench.read("out/lgnn/hybrid-0.json"), before);
    bench.run("merge nowhere -o joined").bad(2, &["nowhere"]);
}

#[test]
fn more_jobs_than_tasks_are_no_harm() {
    let bench = Bench::new();
    bench.run(&format!("{SHORT} --jobs 40000")).bad(2, &["--jobs", "1..=1024"]);
    bench.run(&format!("{SHORT} --jobs 1024")).good();
}

#[cfg(unix)]
#[test]
fn two_runs_do_not_share_results() {
    let bench = Bench::new();
    std::fs::create_dir_all(bench.at("out/lgnn")).unwrap();
    let lock = leastaction_learning::lock::Lock::new(&bench.at("out/lgnn")).unwrap();
    bench.run(&format!("{SHORT} -o out")).bad(1, &["out/lgnn", "another process is writing to this folder"]);
    drop(lock);
    bench.run(&format!("{SHORT} -o out")).good();
}
