#!/usr/bin/env python3
"""Lets a simulated Panda take up loads in motion, with a firmware whose model follows, and prints what it finds and how well it follows.

    python3 tests/loads.py [--seeds 1000] [--hours 10]    # with these numbers an hour on 2 quiet cores, plus compiling

Plant, model and motion are those of track.py; the encoders have 4,096 counts a turn without other noise. First the error along the motion, with
and without adaptation, by the time since the load was taken up; then friction that grows by half in a minute, as the numbers in use have it at its
end. Last, by tests/src/bin/loads.rs, masses between .5 and 3 kg, one for each seed, and how often the interval of 95% at 3 s after
the load was taken up holds the mass; and hours in which nothing happens, and what was announced all the same.
"""

import argparse
import csv
import json
import math
import subprocess
import sys
import tempfile
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


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--hours", type=float, default=0.25)
    given = parser.parse_args()
    subprocess.run(["cargo", "build", "--release", "-p", "leastaction", "-p", "leastaction-tests", "--bins"], cwd=ROOT, check=True)
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        prepare(folder)
        table(folder)
        friction(folder)
        # Settings of a run in which nothing was attached, as all of them are measured before.
        (folder / "friction" / "adapter.settings").rename(folder / "adapter.settings")
        for words in [["seeds", 0, given.seeds], ["quiet", given.hours]]:
            subprocess.run([str(word) for word in [TARGET / "loads", folder, *words]], check=True)


if __name__ == "__main__":
    main()
