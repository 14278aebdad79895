#!/usr/bin/env python3
"""Prints the costs of compiling, training and stepping on this machine, and the machine's name: one JSON object per line.

    python3 tests/figures.py                 # all parts: about 40 minutes on 2 cores
    python3 tests/figures.py joints rebuild  # some parts

build    from a fresh clone to the end of the demo; processor seconds for each of our crates in a fresh release build of the command,
         and for the rest of the workspace
rebuild  `cargo build --release` after one line of core changed
tests    `cargo test --workspace` in a fresh clone
joints   a chain of seven pendulums, learned by default settings: duration of training, and error on held-back motions
symo     E2E-SyMo's cart-pole of order 4 by Levenberg-Marquardt (cargo bench -p leastaction-learning --bench training)
jax      tests/peers/modlanet_jax.py and lgnn_jax.py (pip install jax)

The last commit is measured, in a clone under a temporary folder. Times are wall-clock times unless they are called processor
seconds: measure on a quiet machine.
"""

import json
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def run(command, folder, **options):
    """Runs a command and returns its standard output; its standard error goes to ours."""
    print("$", command, file=sys.stderr)
    done = subprocess.run(command, shell=True, cwd=folder, stdout=subprocess.PIPE, text=True, **options)
    if done.returncode != 0:
        sys.exit(f"{command}: exit code {done.returncode}\n{done.stdout[-2000:]}")
    return done.stdout


def seconds(command, folder):
    start = time.monotonic()
    run(command, folder)
    return round(time.monotonic() - start, 1)


def show(part, **figures):
    print(json.dumps({"part": part} | figures), flush=True)


def machine():
    cpu = next((line for line in Path("/proc/cpuinfo").read_text().splitlines() if "model name" in line), "")
    vectors = re.findall(r"\b(avx2|avx512f)\b", Path("/proc/cpuinfo").read_text())
    compiler = run("rustc --version", ROOT).strip()
    cores = run("nproc", ROOT).strip()
    show("machine", processor=cpu.split(":")[-1].strip(), vectors=sorted(set(vectors)), cores=int(cores), rustc=compiler)


# Stands in for rustc, and writes the compile time of each of our crates to a file.
WRAPPER = """#!/bin/bash
name=$(sed -n 's/.*--crate-name \\([a-z_0-9]*\\).*/\\1/p' <<<"$*")
case $name in
    leastaction*) TIMEFORMAT="$name %U %S"; { time "$@" 2>&3; } 3>&2 2>>"$UNITS" ;;
    *) exec "$@" ;;
esac
"""


def units(command, clone):
    """Processor seconds for each of our crates that a cargo command compiles."""
    with tempfile.TemporaryDirectory() as folder:
        wrapper, log = Path(folder) / "rustc", Path(folder) / "units"
        wrapper.write_text(WRAPPER)
        wrapper.chmod(0o755)
        log.touch()
        run(command, clone, env=os.environ | {"RUSTC_WRAPPER": str(wrapper), "UNITS": str(log)})
        ours = {}
        for line in log.read_text().splitlines():
            name, user, system = line.split()
            ours[name] = round(ours.get(name, 0.0) + float(user) + float(system), 1)
        return ours


def build(clone):
    run("cargo fetch", clone)
    demo = seconds("cargo run --release -- demo", clone)
    run("cargo clean", clone)
    command = units("cargo build --release", clone)
    others = units("cargo build --release --workspace", clone)
    show("build", fresh_clone_to_demo_s=demo, own_code_s=round(sum(command.values()), 1), crates=command, others=others)


def rebuild(clone):
    run("cargo build --release", clone)
    source = clone / "core/src/lib.rs"
    source.write_text(source.read_text() + "\n// A line.\n")
    show("rebuild", after_a_line_of_core_s=seconds("cargo build --release", clone))


def tests(clone):
    run("cargo clean && cargo fetch", clone)
    show("tests", cargo_test_s=seconds("cargo test --workspace", clone))


def joints(clone):
    run("cargo build --release", clone)
    leastaction = clone / "target/release/leastaction"
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        made = "generate n-pendulum --count 7 --h 0.01 --trajectories 200 --seed 5 -o chain.npz"
        run(f"{leastaction} {made}", folder)
        for keys in ("", 'inertia = "cholesky"'):
            model = f'[model]\ncoordinates = "aaaaaaa"\n{keys}\n'
            (folder / "chain.toml").write_text(f'[data]\nfile = "chain.npz"\nvalidation = 0.2\n{model}[training]\niterations = 20\n')
            took = seconds(f"{leastaction} train chain.toml -o run --force", folder)
            history = (folder / "run/history.csv").read_text().splitlines()
            names = history[0].split(",")
            rows = [dict(zip(names, line.split(","))) for line in history[1:]]
            constant = constant_velocity(folder)
            best = min(float(row["validation"]) for row in rows if row["validation"])
            reached = [row for row in rows if row["validation"] and float(row["validation"]) <= 1e-3 * constant]
            show(
                "joints",
                keys=keys,
                training_s=took,
                of_constant_velocity=float(f"{best / constant:.2e}"),
                a_thousandth_after_s=round(float(reached[0]["seconds"]), 1) if reached else None,
            )


def constant_velocity(folder):
    """Mean square error of constant velocity, q + (q - q_before) - q_after, over the last fifth of the trajectories."""
    import numpy as np

    with np.load(folder / "chain.npz") as log:
        q, trajectory = log["q"], log["trajectory"]
    held_back = [q[trajectory == k] for k in np.unique(trajectory)[160:]]
    return float(np.mean(np.concatenate([(q[2:] - 2 * q[1:-1] + q[:-2]) ** 2 for q in held_back])))


def symo(clone):
    printed = run("cargo bench -p leastaction-learning --bench training", clone)
    show("symo", printed=[line for line in printed.splitlines() if line.strip()])


def jax(clone):
    for script in ("modlanet_jax.py", "lgnn_jax.py", "lgnn_jax.py --springs 5", "lgnn_jax.py --springs 5000"):
        show("jax", script=script, figures=json.loads(run(f"python3 tests/peers/{script} --json", clone)))


PARTS = {part.__name__: part for part in (build, rebuild, joints, symo, jax, tests)}


def main():
    wanted = sys.argv[1:] or list(PARTS)
    unknown = [part for part in wanted if part not in PARTS]
    if unknown:
        sys.exit(f"{__doc__}\nno part is called {', '.join(unknown)}")
    machine()
    with tempfile.TemporaryDirectory() as folder:
        clone = Path(folder) / "clone"
        run(f"git clone --quiet --no-hardlinks {ROOT} {clone}", ROOT)
        for part in wanted:
            PARTS[part](clone)


if __name__ == "__main__":
    main()
