"""Fixtures: models of every family, a log, a run, and the command that the package must agree with."""

import json
import os
import subprocess
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import leastaction as la

REPOSITORY = Path(__file__).resolve().parents[3]
MODELS = REPOSITORY / "firmware-sim" / "chip" / "models"
FAMILIES = {
    "inertia-network": "cartpole",
    "modular": "double",
    "graph": "pendulums",
    "bodies": "acrobot",
    "friction": "cartpole-dry",
    "half": "cartpole-f16",
    "arm": "arm",
}


def interruptible(program):
    """A program that Ctrl-C interrupts also where pytest itself ignores it, as in the background of a shell."""
    return f"import signal\nsignal.signal(signal.SIGINT, signal.default_int_handler)\n{program}"


def check_threads_run(work):
    """Checks that another thread is never kept waiting for half of the time that `work` takes."""
    ticks = []
    done = threading.Event()

    def count():
        while not done.wait(0.002):
            ticks.append(time.monotonic())

    thread = threading.Thread(target=count)
    thread.start()
    begun = time.monotonic()
    work()
    ended = time.monotonic()
    done.set()
    thread.join()
    inside = [begun, *(tick for tick in ticks if begun < tick < ended), ended]
    assert len(inside) > 4 and np.diff(inside).max() < 0.5 * (ended - begun)


@pytest.fixture(params=FAMILIES)
def model(request):
    return la.load(MODELS / f"{FAMILIES[request.param]}.postcard")


@pytest.fixture
def cartpole():
    return la.load(MODELS / "cartpole.postcard")


@pytest.fixture(scope="session")
def command():
    """Runs the command `$LEASTACTION` and returns its JSON output; without `$LEASTACTION` the tests that need it are skipped."""
    program = os.environ.get("LEASTACTION")
    if not program:
        pytest.skip("LEASTACTION does not name the command")

    def run(*arguments):
        words = [program, "--json", *map(str, arguments)]
        return json.loads(subprocess.run(words, check=True, capture_output=True, text=True).stdout)

    return run


@pytest.fixture(scope="session")
def log(command, tmp_path_factory):
    """A log of 12 forced trajectories of a cart-pole."""
    file = tmp_path_factory.mktemp("log") / "cartpole.npz"
    command("generate", "cartpole", "-o", file, "--trajectories", 12, "--control", "held")
    return file


@pytest.fixture(scope="session")
def run(log, tmp_path_factory):
    """A short training run on the log."""
    config = {"data": {"file": log}, "model": {"coordinates": "ta", "hidden": [8]}}
    config["training"] = {"iterations": 6, "warm_up": 4, "threads": 2}
    return la.train(config, tmp_path_factory.mktemp("runs") / "run", progress=False)
