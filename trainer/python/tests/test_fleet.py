"""The example of a fleet: models by worker processes, and which robots have worn."""

import importlib
import os
import sys
from pathlib import Path

import numpy as np
import pytest

import leastaction as la

EXAMPLE = Path(__file__).parents[1] / "examples" / "fleet.py"
ROBOTS = 12


@pytest.fixture(scope="module")
def example():
    # Workers import the example by its name.
    sys.path.insert(0, str(EXAMPLE.parent))
    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [str(EXAMPLE.parent), os.environ.get("PYTHONPATH")]))
    return importlib.import_module("fleet")


@pytest.fixture(scope="module")
def fleet(example, command, tmp_path_factory):
    """Logs of a fleet, its first fit, and its robots as learned one by one in this process."""
    folder = tmp_path_factory.mktemp("fleet")
    logs = [example.simulate(folder, number) for number in range(ROBOTS)]
    run = example.learn(logs[: example.FIRST], folder / "fleet")
    run.model.save(folder / "fleet.postcard")
    return folder, run, example.learn_fleet(folder, ROBOTS, 0)


def models(folder):
    return [(folder / f"{number:04d}" / "m.postcard").read_bytes() for number in range(ROBOTS)]


def test_workers_give_the_bytes_of_one_process(example, fleet):
    pytest.importorskip("dask.distributed")
    folder, _, robots = fleet
    alone = models(folder)
    for number in range(ROBOTS):
        (folder / f"{number:04d}" / "m.postcard").unlink()
    found = example.learn_fleet(folder, ROBOTS, 2)
    assert models(folder) == alone and len(set(alone)) == ROBOTS
    assert [robot[:4] for robot in found] == [robot[:4] for robot in robots]


def test_the_worn_robot_is_found(example, fleet):
    pytest.importorskip("scipy")
    _, run, robots = fleet
    usual = next(row["value"] for row in run.report["numbers"] if "Coulomb" in row["name"])
    assert abs(usual / example.COULOMB - 1) < 0.1
    worn = [int(robot.name) for robot, _, worn in example.verdicts(robots, usual) if worn]
    assert worn == [number for number in range(ROBOTS) if example.grown(number) > example.LIMIT] == [9]
    ratios = np.array([robot.coulomb / example.COULOMB / example.grown(int(robot.name)) for robot in robots])
    assert abs(ratios - 1).max() < 0.15, ratios


def test_a_fit_that_begins_with_the_fleets_is_shorter(example, fleet, tmp_path):
    folder, _, _ = fleet
    logs, begun = [folder / "0003" / "logs"], folder / "fleet.postcard"
    cold, warm = (example.learn(logs, tmp_path / name, start) for name, start in (("cold", None), ("warm", begun)))
    assert warm.report["iterations"] < cold.report["iterations"]
    assert np.isclose(warm.train_loss, cold.train_loss, rtol=0.02)


def test_a_model_of_other_bodies_is_no_start(example, fleet, tmp_path):
    folder, _, _ = fleet
    config = {"data": {"file": str(folder / "0000" / "logs" / "*.csv"), "columns": example.COLUMNS}}
    config["model"] = {**example.MODEL, "start_from": str(folder / "0000" / "nothing.postcard")}
    with pytest.raises(la.InputError, match="nothing.postcard"):
        la.train(config, tmp_path / "run", progress=False)
