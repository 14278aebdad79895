//! Data sets of LeRobot, and logs whose commands are positions: from `look` to the numbers of the servos.

use crate::support::Bench;
use std::path::{Path, PathBuf};

/// Data sets of a simulated arm, whose numbers `make.py` there states.
fn golden(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data/tests/golden/lerobot").join(name)
}

#[test]
fn look_proposes_servos_where_commands_are_positions() {
    let bench = Bench::new();
    std::fs::copy(golden("episode1.csv"), bench.at("servo.csv")).unwrap();
    bench.run("look servo.csv -o servo.toml").good();
    let text = bench.text("servo.toml");
    let words = [
        "servo = \"learned\"",
        "u correlates with q by 0.8",
        "friction = { coulomb = \"learned\" }",
        "family = \"bodies\"",
        "mass = 1.0",
    ];
    words.iter().for_each(|words| assert!(text.contains(words), "{words} is not in {text}"));
    bench.run("generate pendulum --robot logs --trajectories 4 --samples 60 --noise 0.001").good();
    bench.run("look logs/*.csv -o drive.toml").good();
    assert!(!bench.text("drive.toml").contains("servo"), "{}", bench.text("drive.toml"));
}

#[cfg(feature = "lerobot")]
mod read {
    use super::{Bench, golden};

    /// Stiffness and damping of the servos, N m/rad and N m s/rad.
    const TRUTH: [(&str, f64); 4] = [
        ("coordinate 0: stiffness of the servo", 3.0),
        ("coordinate 1: stiffness of the servo", 1.2),
        ("coordinate 0: viscous friction", 0.35),
        ("coordinate 1: viscous friction", 0.12),
    ];

    const ARM: &str = "\n[model]\nfamily = \"bodies\"\nservo = \"learned\"\n[[model.bodies]]\n\n[[model.bodies]]\non = 0\n\
        at = [0.2, 0.0]\nmass = 0.25\ncentre = [0.08, 0.0]\ninertia = 0.001\n\n[training]\nloss = \"windows\"\niterations = 30\n";

    #[test]
    fn a_data_set_is_looked_at_and_its_servos_are_learned() {
        let bench = Bench::new();
        for (set, unit) in [("v21", "unit = \"deg\""), ("v30", "")] {
            bench.run(&format!("look {} -o {set}.toml", golden(set).display())).good();
            let text = bench.text(&format!("{set}.toml"));
            for words in [
                "those at the end",
                "t = \"timestamp\"",
                "# units: LeRobot states none",
                "servo = \"learned\"",
                unit,
            ] {
                assert!(text.contains(words), "{words} is not in {text}");
            }
            let (data, _) = text.split_once("\n[model]").unwrap();
            bench.write(&format!("{set}.toml"), &format!("{data}{ARM}"));
            let trained = bench.run(&format!("train {set}.toml -o {set} -q --json")).good().json();
            let numbers = trained["numbers"].as_array().unwrap();
            for (name, truth) in TRUTH {
                let found = numbers.iter().find(|number| number["name"] == name).unwrap();
                let found = found["value"].as_f64().unwrap();
                assert!((found / truth - 1.0).abs() < 0.03, "{set}, {name}: {found}, not {truth}");
            }
            bench.run(&format!("evaluate {set} --data {}", golden(set).display())).good();
        }
    }

    #[test]
    fn the_proposal_trains_as_it_stands() {
        let bench = Bench::new();
        bench.run(&format!("look {} -o arm.toml", golden("v30").display())).good();
        let text = bench
            .text("arm.toml")
            .replace("loss = \"windows\"", "loss = \"windows\"\niterations = 2\nwindow = 0.5");
        bench.write("arm.toml", &text);
        bench.run("train arm.toml -o run -q").good();
    }
}
