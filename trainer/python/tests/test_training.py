"""Training, runs and logs."""

import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from conftest import interruptible

import leastaction as la

CONFIG = {"model": {"coordinates": "ta", "hidden": [8]}, "training": {"iterations": 6, "warm_up": 4, "threads": 2}}


def test_a_run_says_what_came_out(run):
    assert run.ending == "iterations" and run.report["iterations"] == 10
    assert run.train_loss < 1e-4 and run.validation_loss > 0
    history = run.history
    assert history["iteration"].tolist() == list(range(1, 11))
    assert set(history["stage"]) == {"warm-up", "training"}
    assert history["train"][-1] < history["train"][history["stage"] == "training"][0]
    assert run.model.h == 0.05 and "coordinates" in run.config
    again = la.open_run(run.folder)
    assert np.array_equal(again.model.weights, run.model.weights)


def test_arrays_train_as_files_do(run, log, tmp_path):
    motions = la.Log.read(log)
    arrays = {name: [motion[name] for motion in motions] for name in ("q", "v", "a", "u")}
    trained = la.train(CONFIG, tmp_path / "run", data=la.Log(**arrays, h=motions.h, control=motions.control), progress=False)
    assert np.array_equal(trained.model.weights, run.model.weights)
    assert (tmp_path / "run.npz").exists() and "run.npz" in trained.config
    with pytest.raises(la.InputError, match="already exists"):
        la.train(CONFIG, tmp_path / "run", data=dict(**arrays, h=motions.h), progress=False)


def test_progress_and_interruption(run, log, tmp_path):
    """An exception in a callback stops training and is raised after everything is saved; the run then resumes bit for bit."""
    rows, config = [], {**CONFIG, "data": {"file": log}}

    def stops(row):
        rows.append(row)
        if row.iteration == 6:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt, match="iteration 6 is saved"):
        la.train(config, tmp_path / "run", progress=stops)
    assert [row.iteration for row in rows] == [1, 2, 3, 4, 5, 6] and rows[-1].stage == "training"
    assert la.open_run(tmp_path / "run").model.n == 2
    with pytest.raises(la.InputError, match="already exists"):
        la.train(config, tmp_path / "run", progress=False)
    resumed = la.train(config, tmp_path / "run", resume=True, progress=False)
    assert np.array_equal(resumed.model.weights, run.model.weights)

    def fails(row):
        raise LookupError("mine")

    with pytest.raises(LookupError, match="mine"):
        la.train(config, tmp_path / "other", progress=fails)


def test_ctrl_c(log, tmp_path):
    """SIGINT during training in another process saves the run."""
    program = (
        "import sys, leastaction as la\n"
        "la.train({'data': {'file': sys.argv[1]}, 'model': {'coordinates': 'ta', 'hidden': [8]},"
        " 'training': {'iterations': 100000, 'warm_up': 2}}, sys.argv[2], progress=True)\n"
    )
    words = [sys.executable, "-c", interruptible(program), str(log), str(tmp_path / "run")]
    process = subprocess.Popen(words, stderr=subprocess.PIPE, text=True)
    while not (tmp_path / "run" / "history.csv").exists() and process.poll() is None:
        time.sleep(0.05)
    time.sleep(1.0)
    process.send_signal(signal.SIGINT)
    _, stderr = process.communicate(timeout=60)
    assert process.returncode != 0 and "KeyboardInterrupt: interrupted; iteration" in stderr
    assert len(la.open_run(tmp_path / "run").history) > 1


def test_what_cannot_be_is_said(log, tmp_path):
    with pytest.raises(la.InputError, match="coordinate"):
        la.train({"data": {"file": log}, "model": {"cordinates": "ta"}}, tmp_path / "run")
    with pytest.raises(la.InputError, match="missing.csv"):
        la.train({**CONFIG, "data": {"file": "missing.csv"}}, tmp_path / "run")
    with pytest.raises(la.InputError, match="checkpoint"):
        la.open_run(tmp_path)
    with pytest.raises(la.InputError, match="no family"):
        la.defaults("soft")
    assert not (tmp_path / "run").exists()


def test_a_page(run, log, tmp_path):
    measures = la.report(run.model, log, tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text().startswith("<!DOCTYPE html>")
    assert measures["chip"]["one_step_mse"] < 1e-4 and "one step ahead" in str(measures)


def test_logs_from_arrays(tmp_path):
    t = np.arange(50) * 0.01
    log = la.Log(q=[np.sin(t), np.cos(t)], t=[t, t], u=[0 * t, t], control="held")
    assert log.n == 1 and len(log) == 100 and len(log.trajectories) == 2
    log.write(tmp_path / "log.npz")
    again = la.Log.read(tmp_path / "log.npz")
    assert again.h == 0.01 and again.control == "held" and np.array_equal(again.q, log.q)
    assert [len(motion["q"]) for motion in again] == [50, 50]
    with pytest.raises(la.InputError, match="give one of them"):
        la.Log(q=np.zeros(5))
    with pytest.raises(la.InputError, match="u has 3 samples, q 5"):
        la.Log(q=np.zeros(5), h=0.1, u=np.zeros(3))


def test_defaults_train(log, tmp_path):
    for family in ("inertia-network", "modular", "graph", "bodies", "arm"):
        assert "[training]" in la.defaults(family)
