use crate::support::Bench;
use leastaction_learning::data::{self, modlanet, symo};

#[test]
fn both_formats_hold_the_same_motion() {
    let bench = Bench::new();
    for name in ["a.npz", "a.csv"] {
        let done = bench
            .run(&format!("generate cartpole -o {name} --trajectories 3 --samples 7 --h 0.02 --json"))
            .good();
        let report = done.json();
        assert_eq!((report["trajectories"].as_u64(), report["samples"].as_u64()), (Some(3), Some(21)));
        assert_eq!((report["h"].as_f64(), report["system"].as_str()), (Some(0.02), Some("cartpole")));
    }
    let (npz, notes) = data::read(bench.at("a.npz")).unwrap();
    assert!(notes.is_empty());
    assert_eq!(npz, data::read(bench.at("a.csv")).unwrap().0);
    assert_eq!((npz.n, npz.h, npz.trajectories.len()), (2, 0.02, 3));
}

#[test]
fn a_seed_is_a_file_and_options_change_it() {
    let bench = Bench::new();
    let generate = |name: &str, options: &str| {
        bench.run(&format!("generate acrobot -o {name} --trajectories 2 --samples 5 {options}")).good();
        bench.read(name)
    };
    let plain = generate("a.npz", "--seed 4");
    assert_eq!(plain, generate("b.npz", "--seed 4"));
    for (k, option) in [
        "--seed 5",
        "--seed 4 --noise 0.01",
        "--seed 4 --drag 0.1",
        "--seed 4 --no-control",
        "--seed 4 --control held",
    ]
    .iter()
    .enumerate()
    {
        assert_ne!(plain, generate(&format!("c{k}.npz"), option), "{option}");
    }
}

#[test]
fn without_control_u_is_zero() {
    let bench = Bench::new();
    bench.log("--no-control");
    let (data, _) = data::read(bench.at("data.npz")).unwrap();
    assert!(data.trajectories.iter().all(|t| t.u.as_ref().unwrap().as_flat().iter().all(|u| *u == 0.0)));
}

#[test]
fn symo_layout_has_its_three_parts() {
    let bench = Bench::new();
    bench.run("generate pendulum -o symo.npz --symo-layout").good();
    let set = symo::read(bench.at("symo.npz"), 0.1, 0).unwrap();
    let sizes =
        [&set.train, &set.test, &set.integration].map(|part| (part.trajectories.len(), part.samples()));
    assert_eq!(sizes, [(128, 128 * 34), (128, 128 * 34), (16, 16 * 502)]);
}

#[test]
fn many_bodies_are_logged_free_and_in_both_layouts() {
    let bench = Bench::new();
    let report =
        bench.run("generate n-body --count 4 -o a.npz --trajectories 5 --samples 9 --json").good().json();
    assert_eq!((report["system"].as_str(), report["samples"].as_u64()), (Some("n-body"), Some(45)));
    let (log, notes) = data::read(bench.at("a.npz")).unwrap();
    assert!(notes.is_empty() && log.n == 8 && log.h == 0.05);
    assert!(log.trajectories.iter().all(|t| t.a.is_some() && t.u.is_none()));

    bench
        .run(
            "generate n-pendulum --count 3 -o b.npz --trajectories 5 --samples 9 --speed 1 --modlanet-layout",
        )
        .good();
    let set = modlanet::read(bench.at("b.npz")).unwrap();
    assert_eq!((set.train.q.len(), set.test.q.len(), set.train.q.width()), (36, 9, 3));
    assert!(set.train.starts().iter().all(|&k| set.train.v[k].iter().all(|v| v.abs() <= 1.0)));
}

#[test]
fn options_of_other_systems_are_refused() {
    let bench = Bench::new();
    for (system, option) in [
        ("pendulum", "--count 2"),
        ("pendulum", "--modlanet-layout"),
        ("acrobot", "--speed 1"),
        ("n-body", "--speed 1"),
        ("n-body", "--drag 1"),
        ("n-pendulum", "--symo-layout"),
        ("n-pendulum", "--no-control"),
        ("n-pendulum", "--control held"),
        ("n-spring", "--control linear"),
    ] {
        let name = option.split(' ').next().unwrap();
        bench.run(&format!("generate {system} -o a.npz {option}")).bad(2, &[name, system]);
    }
    bench.run("generate n-body -o a.npz --count 0").bad(2, &["--count"]);
    bench.run("generate n-body -o a.npz --modlanet-layout --trajectories 1").bad(2, &["2 or more"]);
    assert_eq!(std::fs::read_dir(bench.folder.path()).unwrap().count(), 0);
}

#[test]
fn wrong_usage_is_2_and_failed_work_is_1() {
    let bench = Bench::new();
    bench.run("generate pendulum -o data.txt").bad(2, &["data.txt", ".npz or .csv"]);
    bench.run("generate gyroscope -o a.npz").bad(2, &["gyroscope", "pendulum", "cartpole"]);
    bench.run("generate pendulum").bad(2, &["--output"]);
    bench.run("generate pendulum -o a.npz --samples 2").bad(2, &["--samples"]);
    bench.run("generate pendulum -o a.npz --h 0").bad(2, &["above 0"]);
    bench.run("generate pendulum -o a.npz --h nan").bad(2, &["finite"]);
    bench.run("generate pendulum -o a.npz --noise=-1").bad(2, &["0 or above"]);
    bench.run("generate pendulum -o a.npz --symo-layout --drag 1").bad(2, &["--drag"]);
    bench.run("generate pendulum -o no/such/a.npz").bad(1, &["no/such/a.npz"]);
    assert_eq!(std::fs::read_dir(bench.folder.path()).unwrap().count(), 0);
}

#[test]
fn what_would_fill_the_memory_is_refused() {
    let bench = Bench::new();
    for system in ["pendulum", "n-body", "n-pendulum --modlanet-layout", "n-spring"] {
        for size in
            ["--trajectories 1000000000", "--samples 4000000000", "--trajectories 90000 --samples 90000"]
        {
            bench
                .run(&format!("generate {system} -o a.npz {size}"))
                .bad(2, &["numbers, and a log holds at most 134217728; lower --trajectories or --samples"]);
        }
    }
    assert_eq!(std::fs::read_dir(bench.folder.path()).unwrap().count(), 0);
}

/// The double pendulum of DFKI RIC's design C.1, with numbers close to the identified ones.
const LINKS: &str = "[[joint]]\nmass = 0.523\nlength = 0.2\ncentre = 0.2\ninertia = 0.011\nrotor = 6.3e-5\ngear = -6.0\n\
                     [[joint]]\nmass = 0.626\nlength = 0.3\ncentre = 0.256\ninertia = 0.01\nrotor = 6.3e-5\ngear = -6.0\n";

#[test]
fn a_robots_logs_are_files_of_its_own_names() {
    let bench = Bench::new();
    std::fs::write(bench.at("links.toml"), LINKS).unwrap();
    let command = "generate n-pendulum --links links.toml --robot logs -o measured.npz --truth truth.npz --trajectories 3 \
                   --samples 21 --viscous 0.005,0.002 --coulomb 0.1,0.07 --noise 0.001 --grid 0.0004 --zeros 0.02 --delay 6 --seed 7";
    let report = bench.run(&format!("{command} --json")).good().json();
    assert_eq!((report["trajectories"].as_u64(), report["samples"].as_u64()), (Some(3), Some(63)));
    let zeros = report["zeros"][2][1].as_f64().unwrap();
    let (measured, _) = data::read(bench.at("measured.npz")).unwrap();
    let (truth, _) = data::read(bench.at("truth.npz")).unwrap();
    let both = [&measured, &truth].map(|data| data.trajectories[2].q.get(20).unwrap()[1]);
    assert!((both[0] - both[1] - zeros).abs() < 0.006, "{both:?} {zeros}");
    let first = String::from_utf8(bench.read("logs/00.csv")).unwrap();
    let head = "time,pos_meas1,pos_meas2,vel_meas1,vel_meas2,tau_con1,tau_con2,tau_meas1,tau_meas2\n0,";
    assert!(first.starts_with(head) && first.lines().count() == 22, "{first}");
    bench.run(command).good();
    assert_eq!(first.as_bytes(), bench.read("logs/00.csv"));
    // Fewer logs than the folder holds would leave old logs among them.
    let refused = bench.run(&command.replace("--trajectories 3", "--trajectories 2"));
    refused.bad(2, &["02.csv"]);
}

#[test]
fn a_robots_logs_are_looked_at_and_jitter_is_seen() {
    let bench = Bench::new();
    bench
        .run("generate acrobot --robot logs --trajectories 2 --jitter 2 --noise 0.002 --amplitude 1,3")
        .good();
    let seen = bench.run("look logs/*.csv -o robot.toml --json").good();
    assert_eq!(seen.json()["files"].as_array().map(Vec::len), Some(2));
    let configuration = String::from_utf8(bench.read("robot.toml")).unwrap();
    assert!(configuration.contains("pos_meas1") && configuration.contains("tau_con2"), "{configuration}");
}

#[test]
fn options_of_a_robot_are_checked() {
    let bench = Bench::new();
    let refused = |options: &str, word: &str| bench.run(&format!("generate {options}")).bad(2, &[word]);
    refused("acrobot -o a.npz --coulomb 0.1", "--robot");
    refused("acrobot --robot logs --coulomb 0.1,0.2,0.3", "3 values");
    refused("acrobot --robot logs --jitter 5", "jitter");
    refused("acrobot --robot logs --jitter 1 --truth t.npz", "--jitter");
    refused("n-body --robot logs", "n-pendulum");
    refused("acrobot --robot logs --drag 0.1", "--drag");
    refused("acrobot --robot logs --width 0", "above 0");
    refused("acrobot --robot logs --count 3", "--count");
}
