"""A model for each robot of a fleet, and a table of the robots whose friction has grown.

    pip install "dask[distributed]" scipy
    LEASTACTION=path/to/leastaction python fleet.py FOLDER --robots 1000 --workers 2

The robots are simulated pendulums with a drive, whose logs `leastaction generate` writes: the dry friction of every tenth has grown, that of
the others differs by up to 10% from robot to robot. A first fit learns from some robots together, whose friction is usual; from there a fit
for each robot begins, on the workers of Dask. A robot counts as worn if its friction exceeds LIMIT times the usual one beyond doubt: with as
many tests as robots, a test is made at such a level that the probability of any false alarm in the whole fleet is at most ALARM.
"""

from __future__ import annotations

import argparse
import csv
import os
import subprocess
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np

import leastaction as la

COULOMB = 0.1
"""Usual dry friction, N m."""
LIMIT = 1.25
"""Ratio to the usual friction up to which a robot counts as healthy."""
ALARM = 0.05
"""Largest probability of any false alarm in the fleet."""
FIRST = 8
"""Number of robots from which the first fit learns."""
LOGS = 4
"""Number of logs of a robot, 3 s each."""

MODEL = {"family": "bodies", "chain": 1, "friction": {"viscous": "learned", "coulomb": "learned", "width": 0.05}}
COLUMNS = {"t": "time", "q": ["pos_meas1"], "u": ["tau_con1"]}


class Robot(NamedTuple):
    """What a worker found out about a robot."""

    name: str
    coulomb: float
    """Dry friction, N m."""
    error: float
    """Its standard error, N m; NaN if the logs do not show the friction."""
    freedom: int
    """Degrees of freedom of the standard error."""
    seconds: float


def grown(number: int) -> float:
    """The ratio of the true friction of a robot to the usual one."""
    chance = np.random.default_rng(number)
    return chance.uniform(1.4, 2.0) if number % 10 == 9 else chance.uniform(0.9, 1.1)


def simulate(folder: Path, number: int) -> Path:
    """Logs of a robot, as it writes them."""
    logs = folder / f"{number:04d}" / "logs"
    if not logs.exists():
        logs.parent.mkdir(parents=True, exist_ok=True)
        words = f"generate pendulum --robot {logs} --trajectories {LOGS} --samples 301 --amplitude 0.5,2 --frequency 0.3,2 --spread 0.5"
        words += f" --width 0.05 --viscous 0.02 --noise 0.001 --seed {number} --coulomb {COULOMB * grown(number):.6f}"
        subprocess.run([os.environ.get("LEASTACTION", "leastaction"), *words.split()], check=True, capture_output=True)
    return logs


def learn(logs: list[Path], folder: Path, start_from: Path | None = None) -> la.Run:
    """Learns from the logs in these folders; `start_from` is a model file to begin with."""
    model = MODEL if start_from is None else {**MODEL, "start_from": str(start_from)}
    files = [str(file) for log in logs for file in sorted(log.glob("*.csv"))]
    config = {"data": {"file": files, "columns": COLUMNS, "validation": 0.0}, "model": model}
    # A number of threads that is the same everywhere; the bits do not depend on it.
    config["training"] = {"loss": "windows", "window": 0.5, "threads": 1}
    return la.train(config, folder, force=True, progress=False)


def learn_robot(folder: str, number: int) -> Robot:
    """Learns the model of a robot, FOLDER/NUMBER/m.postcard, beginning with that of the fleet."""
    own = Path(folder) / f"{number:04d}"
    begun = time.perf_counter()
    run = learn([own / "logs"], own / "run", Path(folder) / "fleet.postcard")
    run.model.save(own / "m.postcard")
    seconds = time.perf_counter() - begun
    found = {row["name"]: row for row in run.report["numbers"]}
    friction = next(row for name, row in found.items() if "Coulomb" in name)
    error = friction["standard_error"]
    return Robot(own.name, friction["value"], np.nan if error is None else error, friction["degrees_of_freedom"], seconds)


def learn_fleet(folder: Path, robots: int, workers: int) -> list[Robot]:
    """Models of all robots, by this process (workers = 0) or by worker processes of Dask."""
    numbers = range(robots)
    if workers == 0:
        return [learn_robot(str(folder), number) for number in numbers]
    from dask.distributed import Client, LocalCluster

    with LocalCluster(n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        with Client(cluster) as client:
            return client.gather(client.map(learn_robot, [str(folder)] * robots, numbers, pure=False))


def verdicts(robots: list[Robot], usual: float) -> list[tuple[Robot, float, bool]]:
    """For each robot the probability of such a friction if the true one were LIMIT times the usual, and whether the robot is worn.

    This is a one-sided test by Student's t distribution. Its level is ALARM over the number of tests (Bonferroni).
    """
    from scipy.stats import t

    rows = []
    for robot in robots:
        p = float(t.sf((robot.coulomb - LIMIT * usual) / robot.error, robot.freedom))
        rows.append((robot, p, p < ALARM / len(robots)))
    return rows


def main() -> None:
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("folder", type=Path)
    words.add_argument("--robots", type=int, default=1000)
    words.add_argument("--workers", type=int, default=2, help="number of worker processes; 0: this process alone")
    given = words.parse_args()
    if given.robots < FIRST:
        words.error(f"--robots is {given.robots}; the first fit learns from {FIRST}")

    logs = [simulate(given.folder, number) for number in range(given.robots)]
    fleet = learn(logs[:FIRST], given.folder / "fleet")
    fleet.model.save(given.folder / "fleet.postcard")
    usual = next(row["value"] for row in fleet.report["numbers"] if "Coulomb" in row["name"])

    begun = time.perf_counter()
    robots = learn_fleet(given.folder, given.robots, given.workers)
    seconds = time.perf_counter() - begun

    rows = verdicts(robots, usual)
    with open(given.folder / "fleet.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(["robot", "coulomb", "standard_error", "ratio", "p", "worn"])
        table.writerows([r.name, r.coulomb, r.error, r.coulomb / usual, p, int(worn)] for r, p, worn in rows)
    print("robot  friction, N m       ratio  p")
    for robot, p, worn in rows:
        if worn:
            print(f"{robot.name}   {robot.coulomb:.4f} ± {robot.error:.4f}    {robot.coulomb / usual:.2f}   {p:.1e}")
    said = {robot.name for robot, _, worn in rows if worn}
    truly = {f"{number:04d}" for number in range(given.robots) if grown(number) > LIMIT}
    level = ALARM / given.robots
    print(f"{given.robots} tests at a level of {level:.1e}: the probability of any false alarm is at most {ALARM}")
    print(f"{len(said & truly)} of {len(truly)} worn robots are in the table, {len(said - truly)} healthy ones")
    print(f"{seconds:.1f} s with {given.workers} workers: {seconds / given.robots:.3f} s a robot; all robots in {given.folder / 'fleet.csv'}")


if __name__ == "__main__":
    main()
