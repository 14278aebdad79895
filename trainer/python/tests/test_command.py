"""The package gives the command's numbers, bit for bit."""

import csv

import numpy as np
from conftest import MODELS

import leastaction as la


def total_of(numbers):
    """Sums one number after the other, as Rust does; `sum` compensates for rounding from Python 3.12 on."""
    total = 0.0
    for number in numbers:
        total += number
    return total


def test_evaluate_is_the_commands(command, run, log, tmp_path):
    run.model.save(tmp_path / "m.postcard")
    theirs = command("evaluate", tmp_path / "m.postcard", "--data", log)
    ours = la.evaluate(run.model, log)
    assert theirs.keys() == ours.keys() and "chip" in ours and "acceleration_mse" in ours
    for name in theirs.keys() - {"model", "data"}:
        assert theirs[name] == ours[name], name
    assert la.evaluate(run, config=run.folder / "config.toml")["chip"] == theirs["chip"]
    assert run.evaluate()["chip"] == theirs["chip"]


def test_steps_have_the_bits_of_the_command(command, run, log):
    """Compares the one-step error, a sum of squares that any differing bit would change."""
    model, errors = run.model, []
    for motion in la.Log.read(log):
        q, u = motion["q"], motion["u"]
        pairs = np.stack([u[:-2], u[1:-1]], 1)
        found = model.step_from_positions(q[:-2], q[1:-1], pairs)
        for predicted, logged in zip(found, q[2:]):
            squares = [(float(p) - float(x)) * (float(p) - float(x)) for p, x in zip(predicted, logged)]
            errors.append(total_of(squares) / len(squares))
    theirs = command("evaluate", run.folder, "--data", log)["chip"]
    assert theirs["one_step_unsolved"] == 0
    assert total_of(errors) / len(errors) == theirs["one_step_mse"]


def test_rollouts_have_the_bits_of_the_command(command, run, log):
    model, means = run.model, []
    for motion in la.Log.read(log):
        q, v, u = motion["q"], motion["v"], motion["u"]
        found = model.rollout(q[1], v[1], u[1:-1]).q[1:].astype(float)
        errors = (found - q[2:]).ravel().tolist()
        means.append(total_of(error * error for error in errors) / len(errors))
    theirs = command("evaluate", run.folder, "--data", log)["chip"]
    assert theirs["rollouts_broken_off"] == 0
    assert total_of(means) / len(means) == theirs["rollout_mse"]


def test_double_precision_is_the_commands(command, run, log):
    theirs = command("evaluate", run.folder, "--data", log)
    errors = [
        np.square(run.model.double.acceleration(motion["q"], motion["v"], motion["u"]) - motion["a"])
        for motion in la.Log.read(log)
    ]
    assert abs(np.concatenate(errors).mean() / theirs["acceleration_mse"] - 1) < 1e-12


def test_the_observer_has_the_bits_of_the_firmware(command, run, log, tmp_path):
    run.model.save(tmp_path / "m.postcard")
    report = command("simulate", tmp_path / "m.postcard", "--replay", log, "-o", tmp_path)
    assert report["model_errors"] == 0
    with open(tmp_path / "trace.csv", encoding="utf-8") as file:
        rows = iter(list(csv.DictReader(file)))
    for motion in la.Log.read(log):
        observer = run.model.observer()
        for y, u in zip(motion["q"], motion["u"]):
            row, estimate = next(rows), observer.update(y, u)
            for name, found in (("q_estimate", estimate.q), ("v_estimate", estimate.v)):
                theirs = [np.float32(row[f"{name}{i}"]) for i in range(2)]
                assert np.array_equal(found, theirs), row["index"]
        assert observer.trusted


def test_training_has_the_bits_of_the_command(command, run, log, tmp_path):
    (tmp_path / "config.toml").write_text(run.config)
    command("train", tmp_path / "config.toml", "-o", tmp_path / "run", "--quiet")
    command("export", tmp_path / "run", "-o", tmp_path / "m.postcard")
    assert np.array_equal(la.load(tmp_path / "m.postcard").weights, run.model.weights)


def test_look_is_the_commands(command, tmp_path):
    command("generate", "acrobot", "--robot", tmp_path / "logs", "--trajectories", 3)
    pattern = tmp_path / "logs" / "*.csv"
    theirs = command("look", pattern)
    ours = la.look(pattern, tmp_path / "robot.toml")
    assert {**ours.report, "configuration": None} == theirs
    assert (tmp_path / "robot.toml").read_text() == ours.configuration
    assert "[model]" in ours.configuration and "pos_meas1" in str(ours)


def test_models_of_every_family_are_loaded_by_both(command, model):
    for name in ("cartpole", "double", "pendulums", "acrobot", "arm"):
        theirs, ours = command("inspect", MODELS / f"{name}.postcard"), la.load(MODELS / f"{name}.postcard")
        assert (theirs["family"], theirs["parameters"], theirs["h"]) == (ours.family, ours.parameters, ours.h)
