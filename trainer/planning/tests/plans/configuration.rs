//! Errors in a configuration name their key.

use crate::problem;
use leastaction_planning::PlanConfig;
use std::path::Path;

#[track_caller]
fn assert_refused(name: &str, from: &str, to: &str, expected: &str) {
    let changed = |text: &str| {
        assert!(text.contains(from), "{name} has no {from:?}");
        text.replace(from, to)
    };
    let message = problem(name, changed).map(|_| ()).unwrap_err().to_string();
    assert!(message.contains(expected), "{message:?} does not contain {expected:?}");
}

#[test]
fn keys_and_values_are_checked() {
    assert_refused("pendulum", "seconds", "second", "unknown field `second`");
    assert_refused("pendulum", "order = 2", "order = 3", "`order` is 3; it is 2 or 4");
    assert_refused("pendulum", "tick = 0.01", "tick = -0.01", "`tick` is -0.01; it must be positive");
    assert_refused("pendulum", "tick = 0.01", "tick = nan", "`tick` is NaN");
    assert_refused("pendulum", "tick = 0.01\n", "", "`tick` is missing");
    assert_refused("pendulum", "seconds = 4.0", "seconds = 0.01", "less than two nodes");
    assert_refused("pendulum", "seconds = 4.0", "seconds = [4.0, 3.0]", "the shortest time comes first");
    assert_refused("pendulum", "seconds = 4.0", "seconds = 1e9\nticks_per_node = 1", "raise ticks_per_node");
    assert_refused("pendulum", "q = [0.0]", "q = [nan]", "neither is nan");
    assert_refused(
        "pendulum",
        "q = [0.0]",
        "energy = inf",
        "`goal.energy` must be a finite number of joules",
    );
    assert_refused("pendulum", "u = [1.0]", "u = [0.0]", "`cost.u` is 0");
    assert_refused("pendulum", "u = [1.5]", "u = [0.0]", "has no driven coordinate");
    assert_refused("pendulum", "u = [1.5]", "u = [-1.5]", "a largest size is not negative");
    assert_refused("pendulum", "u = [1.5]", "u = [[1.0, -1.0]]", "the least comes first");
    assert_refused("pendulum", "u = [1.5]", "u = [1.5]\nreserve = 1.0", "0 ≤ reserve < 1");
    assert_refused(
        "acrobot",
        "q = [0.0, 0.0]",
        "q = [0.0]",
        "`start.q` has 1 values, but the model has 2 coordinates",
    );
}

#[test]
fn starts_and_goals_outside_the_limits_are_refused() {
    assert_refused(
        "cartpole",
        "q = [0.0, 3.141592653589793]",
        "q = [0.9, 3.1]",
        "outside its limits -0.8 … 0.8",
    );
    assert_refused("cartpole", "q = [0.0, 0.0]", "q = [-1.0, 0.0]", "outside its limits -0.8 … 0.8");
}

/// A way that the largest speed does not allow needs no search.
#[test]
fn a_time_too_short_for_the_speed_is_refused() {
    assert_refused("arm", "seconds = 1.42", "seconds = 1.2", "needs at least 1.379 s");
}

#[test]
fn places_of_errors_are_lines() {
    let text = "model = \"a.urdf\"\nseconds = \"long\"\n";
    let message = PlanConfig::parse(text, Path::new("p.toml")).unwrap_err().to_string();
    assert!(message.starts_with("p.toml:2: \"seconds = \\\"long\\\"\""), "{message}");
}
