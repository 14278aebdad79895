#!/usr/bin/env python3
"""Lets a simulated Panda take up loads in motion, with a firmware whose model follows, and prints what it finds and how well it follows.

    python3 tests/loads.py [--seeds 20] [--quarters 1]    # a few minutes on 2 quiet cores, plus compiling

Plant, model and motion are those of track.py; the encoders have 4,096 counts a turn without other noise. First the error along the motion, with
and without adaptation, by the time since the load was taken up; then masses between .5 and 3 kg, one for each seed, and how often the interval of
95% at 3 s after the load was taken up holds the mass. Then friction that grows by half in a minute, as the numbers in use have it at its end.
Last, quarters of an hour in which nothing happens, and what was announced all the same.
"""

import argparse
import csv
import json
import math
import random
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from track import JOINTS, ROOT, TARGET, prepare

TAKEN_UP = 4
TIMES = [0, 0.5, 1, 1.5, 2, 4]


def simulate(folder, name, *options):
    words = [TARGET / "leastaction", "simulate", "model.postcard", "--scenario", "track", "--plant", "plant.postcard"]
    words += ["--trajectory", "follow.toml", "--known-delay", 1, "--noise", 0, "--bandwidth", 60, "--json", "-o", name, *options]
    done = subprocess.run([str(word) for word in words], cwd=folder, capture_output=True, text=True)
    if not done.stdout:
        sys.exit(done.stderr[-2000:])
    return json.loads(done.stdout)


def errors(folder, name):
    """Root mean square of the errors of a run over joints and time, mrad, between the times."""
    with open(folder / name / "trace.csv") as file:
        rows = list(csv.DictReader(file))
    squares = [(float(row["time"]) - TAKEN_UP, sum(float(row[f"error{i}"]) ** 2 for i in range(JOINTS)) / JOINTS) for row in rows]

    def between(begin, end):
        within = [square for t, square in squares if begin <= t < end]
        return 1e3 * math.sqrt(sum(within) / len(within))

    return [between(*times) for times in zip(TIMES, TIMES[1:])]


def table(folder):
    """Prints the errors along the motion."""
    print("seconds after the load was taken up: " + ", ".join(f"{a}–{b}" for a, b in zip(TIMES, TIMES[1:])))
    for kg in [0, 1, 3]:
        for name, option in [("adapting", ["--adapt"]), ("without", [])]:
            report = simulate(folder, name, "--seconds", 12, "--payload", f"{kg}@{TAKEN_UP}", *option)
            found = report.get("adapted", {})
            told = {key: found[key] for key in ("mass", "standard_error", "announced_at") if key in found}
            print(f"{kg} kg, {name}: " + ", ".join(f"{error:.2f}" for error in errors(folder, name)) + f" mrad {told or ''}", flush=True)


def interval(folder, seed):
    """Mass of a seed, with what is found 3 s after it was taken up, and its standard error."""
    kg = random.Random(seed).uniform(0.5, 3)
    name = f"seed-{seed}"
    found = simulate(folder, name, "--seconds", TAKEN_UP + 3, "--seed", seed, "--payload", f"{kg}@{TAKEN_UP}", "--adapt")["adapted"]
    return kg, found["mass"], found["standard_error"], found["announced_at"] - TAKEN_UP


def friction(folder):
    """Prints the friction in use as a share of the true one, after it has grown by half in a minute."""
    found = simulate(folder, "friction", "--seconds", 60, "--friction-drift", "1.5@60", "--adapt")["adapted"]
    shares = {letter: [] for letter in "bc"}
    for number in found["numbers"]:
        if number["name"][0] in shares:
            shares[number["name"][0]].append((number["model"] + number["used"]) / (1.5 * number["model"]))
    for letter, of in shares.items():
        print(f"{letter}: " + ", ".join(f"{share:.3f}" for share in of) + " of the true one")
    print(f"announced: {found['announced_at']}, changes: {found['changes']}", flush=True)


def quarter(folder, seed):
    """Findings of a quarter of an hour in which nothing happens."""
    found = simulate(folder, f"quiet-{seed}", "--seconds", 900, "--seed", 1000 + seed, "--adapt")["adapted"]
    (folder / f"quiet-{seed}" / "trace.csv").unlink()
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--quarters", type=int, default=1)
    given = parser.parse_args()
    seeds = given.seeds
    subprocess.run(["cargo", "build", "--release", "-p", "leastaction", "-p", "leastaction-tests", "--bins"], cwd=ROOT, check=True)
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor() as pool:
        folder = Path(folder)
        prepare(folder)
        table(folder)
        friction(folder)
        found = list(pool.map(lambda seed: interval(folder, seed), range(seeds)))
        quiet = list(pool.map(lambda seed: quarter(folder, seed), range(given.quarters)))
    held = sum(abs(mass - kg) <= 1.96 * error for kg, mass, error, _ in found)
    worst = max(abs(mass - kg) / kg for kg, mass, _, _ in found)
    print(f"{held} of {seeds} intervals of 95% hold the mass; it is off by at most {100 * worst:.1f}%")
    print(f"announced {min(row[3] for row in found):.2f} to {max(row[3] for row in found):.2f} s after the load was taken up")
    false = [one["announced_at"] for one in quiet if one["announced_at"] is not None]
    changes = sum(len(one["changes"]) for one in quiet)
    print(f"nothing happens in {given.quarters} quarters of an hour: announced at {false} s, {changes} changes")


if __name__ == "__main__":
    main()
