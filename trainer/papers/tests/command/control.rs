//! The competition on a double pendulum.

use super::support::Bench;

#[test]
fn policies_and_swing_ups_are_scored_beside_the_published_ones() {
    let outcome = Bench::new()
        .run("control --robot acrobot --controller tvlqr --model exact --seeds 4..5 --threads 2 --json")
        .good();
    assert!(outcome.stderr.contains("seed 4"), "{}", outcome.stderr);
    let found = outcome.json();
    let rows = found["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 5);
    assert!(rows.iter().all(|row| row["table"] == "policy" && row["robot"] == "acrobot"));
    assert_eq!((&rows[0]["controller"], &rows[0]["score_mean"]), (&"AR-EAPO".into(), &0.658.into()));
    let ours = &rows[4];
    let named = [&ours["controller"], &ours["model"], &ours["seeds"], &ours["score_std"]];
    assert_eq!(named, [&"leastaction tvlqr".into(), &"exact".into(), &1.into(), &serde_json::Value::Null]);
    assert!((0.0..1.0).contains(&ours["score_mean"].as_f64().unwrap()));
}

#[test]
fn a_single_swing_up_is_printed_with_its_terms() {
    let outcome =
        Bench::new().run("control --table single --robot pendubot --controller tvlqr --model exact").good();
    for word in ["single, pendubot", "History SAC", "leastaction tvlqr", "swing_up_s", "velocity_cost"] {
        assert!(outcome.stdout.contains(word), "{word}: {}", outcome.stdout);
    }
}

#[test]
fn what_cannot_be_run_is_said() {
    let run = |words: &str| Bench::new().run(&format!("control {words}"));
    for seeds in ["3", "5..5", "6..2", "a..b", "0..-1", "0..2000000"] {
        run(&format!("--seeds {seeds}")).bad(2, &["--seeds", "FROM..TO"]);
    }
    run("--robot hexapod").bad(2, &["acrobot", "pendubot"]);
    run("--controller pid").bad(2, &["anywhere", "tvlqr"]);
    run("--real-logs nowhere").bad(1, &["nowhere", "no file"]);
    run("--model guessed").bad(2, &["exact", "learned"]);
    run("--table speed").bad(2, &["policy", "single", "robustness", "all"]);
    run("--threads 0").bad(2, &["--threads"]);
}
