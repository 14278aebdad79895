#!/usr/bin/env python3
"""Replays days of a simulated arm, without change and with changes, and prints how often they count as drifted.

    python3 tests/days.py [--references 4] [--days 80] [--rate 0.01]    # some 10 minutes on 2 quiet cores, plus compiling

Two links of 3 and 1.5 kg with viscous and Coulomb friction, encoders of 4,096 counts a turn with noise of half a count, 250 Hz. Every day the arm
moves for 60 s (`--seconds`), each joint by 24 sines of all frequencies in its band, whose phases are drawn anew: another motion of the same kind. The first day is what the model learns from, and the
reference of all others. `--same` repeats the motion of the first day instead, with other noise.
"""

import argparse
import json
import math
import random
import csv
import shutil
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from track import ROOT, TARGET, run

NOISE = 7.5e-4
STEP = 0.004
SECONDS = 60
SINES = 24
# Middle, amplitude (rad) and highest frequency (Hz) of every joint.
JOINTS = [(0.3, 0.9, 0.7), (-0.6, 1.1, 0.9)]
CHANGES = {
    "none": [],
    "friction +5%": ["--friction-drift", "1.05@0.001"],
    "friction +10%": ["--friction-drift", "1.1@0.001"],
    "friction +20%": ["--friction-drift", "1.2@0.001"],
    "load of 1% (45 g)": ["--payload", "0.045"],
    "load of 2% (90 g)": ["--payload", "0.09"],
    "load of 5% (225 g)": ["--payload", "0.225"],
    "encoder zero of joint 2, .2°": ["--zeros", "0,0.00349"],
    "encoder zero of joint 2, .5°": ["--zeros", "0,0.00873"],
    "encoder zero of joint 2, 1°": ["--zeros", "0,0.01745"],
    "encoder zero of joint 2, 2°": ["--zeros", "0,0.03491"],
    "offset of drive 1, .1 N m": ["--offset", "0.1,0"],
    "gain of drive 1, -2%": ["--gain", "0.98,1"],
    "noise of the encoders +20%": ["--noise", str(1.2 * NOISE)],
}
CONFIG = """
[data]
file = "reference/trace.csv"
validation = 0
[data.columns]
t = "time"
q = ["measured0", "measured1"]
u = ["commanded0", "commanded1"]
[model]
family = "arm"
urdf = "arm.urdf"
friction = "learned"
"""


def motion(folder, seed):
    """A motion, as a log of positions."""
    path = folder / f"motion-{seed}.csv"
    draw = random.Random(seed)
    sines = [[(0.1 + (highest - 0.1) * (k + draw.random()) / SINES, draw.uniform(0, 2 * math.pi)) for k in range(SINES)] for *_, highest in JOINTS]
    with open(path, "w") as file:
        rows = csv.writer(file)
        rows.writerow(["t", "q0", "q1"])
        for k in range(round((SECONDS + 1) / 0.02)):
            t = 0.02 * k
            place = [middle + size * sum(math.sin(2 * math.pi * f * t + phase) for f, phase in of) / math.sqrt(SINES)
                     for (middle, size, _), of in zip(JOINTS, sines)]
            rows.writerow([f"{x:.6f}" for x in [t, *place]])
    return path


def simulate(folder, name, seed, moved, options=()):
    """Moves the arm; its own controller knows it."""
    noise = [] if "--noise" in options else ["--noise", NOISE]
    words = ["simulate", "arm.postcard", "--scenario", "track", "--plant", "arm.postcard", "--trajectory", motion(folder, moved), "--tick", STEP]
    words += ["--law", "pd-gravity", "--bandwidth", 30, "--limit", "90,90", "--seconds", SECONDS, "--seed", seed, *noise, *options, "-o", name]
    run(folder, TARGET / "leastaction", *words)


def prepare(folder, seed):
    """Makes the arm, and the run of its model, which is fitted to the first day."""
    run(folder, TARGET / "examples" / "two_links", "arm.urdf", "arm.postcard")
    simulate(folder, "reference", seed, seed)
    (folder / "arm.toml").write_text(CONFIG)
    run(folder, TARGET / "leastaction", "train", "arm.toml", "-o", "run")


def drift(folder, change, seed, moved, rate):
    """The drift of a day."""
    name = f"{change}-{seed}".replace(" ", "_")
    simulate(folder, name, seed, moved, CHANGES[change])
    words = ["simulate", "run", "--replay", f"{name}/trace.csv", "--false-alarms", rate, "--json", "-o", f"{name}/replay"]
    found = json.loads(run(folder, TARGET / "leastaction", *words))["drift"]
    shutil.rmtree(folder / name)
    return found


def table(folder, pool, args, reference):
    """Prints the drift of days by a model of a reference; only the first reference has days with changes."""
    prepare(folder, reference)
    for change in CHANGES if reference == 0 else ["none"]:
        days = args.days if change == "none" else args.changed
        # Days of one reference share no seed with those of another.
        seeds = [1000 * (reference + 1) + k for k in range(days)]
        found = list(pool.map(lambda seed: drift(folder, change, seed, reference if args.same else seed, args.rate), seeds))
        values, errors = (sorted(day[key] for day in found) for key in ("value", "errors"))
        drifted = sum(day["drifted"] for day in found)
        print(f"reference {reference}, {change}: {drifted} of {days} days drifted; value {values[days // 2]:.2f} ({values[0]:.2f} to {values[-1]:.2f}), "
              f"threshold {found[0]['threshold']:.2f}, errors {errors[days // 2]:.2f} times", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--references", type=int, default=4, help="first days, each with a model of its own")
    parser.add_argument("--days", type=int, default=80, help="days without change for each")
    parser.add_argument("--changed", type=int, default=8, help="days of each change, for the first")
    parser.add_argument("--rate", type=float, default=0.01, help="rate of false alarms")
    parser.add_argument("--same", action="store_true", help="every day has the motion of the first")
    parser.add_argument("--seconds", type=int, default=60, help="length of a day")
    args = parser.parse_args()
    global SECONDS
    SECONDS = args.seconds
    build = ["cargo", "build", "--release", "-p", "leastaction", "-p", "leastaction-tests"]
    for what in (["--bins"], ["--example", "two_links"]):
        subprocess.run([*build, *what], cwd=ROOT, check=True)
    with ThreadPoolExecutor(2) as pool:
        for reference in range(args.references):
            with tempfile.TemporaryDirectory() as folder:
                table(Path(folder), pool, args, reference)


if __name__ == "__main__":
    main()
