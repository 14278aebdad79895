"""Compares trees of rigid bodies in space with Pinocchio, MuJoCo and a Rust crate: results and speed in f64, one state per call, on one core."""

import argparse
import json
import sys
import tempfile
from pathlib import Path

from arm_models import ARMS, mjcf, text
from arm_programs import QUANTITIES, RIVALS, TIMED, WITHOUT_DERIVATIVES, Program, generated, generator, mujoco, phyz_rigid, pinocchio
from common import Failure, build_ours, exit_code, positive, run


def outcome(program, given):
    """Runs a program; returns its rows of numbers, and its times by function, ns."""
    lines = run(program.command, input=given).splitlines()
    rows = [[float(word) for word in line.split()] for line in lines if line[0] in "-0123456789"]
    timed = dict(line.split() for line in lines if line[0] not in "-0123456789")
    return rows, {name: float(value) for name, value in timed.items()}


def by_name(n, row, names):
    """Splits a row into the numbers of each quantity."""
    at, found = 0, {}
    for name in names:
        length = n ** QUANTITIES[name]
        found[name] = row[at:at + length]
        at += length
    return found


def differences(n, ours, theirs, names):
    """The largest difference over all states for each quantity, relative to its largest entry in that state."""
    worst = dict.fromkeys(names, 0.0)
    for own, other in zip(ours, theirs, strict=True):
        own, other = by_name(n, own, QUANTITIES), by_name(n, other, names)
        for name, b in other.items():
            worst[name] = max(worst[name], max(abs(x - y) for x, y in zip(own[name], b, strict=True)) / max(map(abs, b)))
    return worst


def fastest(programs, name):
    """The least time of a function among these builds, and the build's flags."""
    found = [(timed[name], how) for how, timed in programs.items() if name in timed]
    return min(found, default=None)


def one_arm(name, given, programs, rounds):
    """Runs the programs in turn, round after round; reports their differences and best times."""
    n, timed, rows = len(ARMS[name][0]), {}, {}
    for _ in range(rounds):
        for program in programs:
            rows[program.rival, program.how], now = outcome(program, given)
            best = timed.setdefault(program.rival, {}).setdefault(program.how, now)
            best.update({key: min(best[key], now[key]) for key in now})
    [(_, own)] = [item for item in rows.items() if item[0][0] == "ours"]
    report = {"joints": n, "ours_ns": timed["ours"][""], "rivals": {}}
    for program in programs:
        if program.rival != "ours":
            rival = report["rivals"].setdefault(program.rival, {"differences": {}, "ns": timed[program.rival]})
            rival["differences"][program.how] = differences(n, own, rows[program.rival, program.how], program.quantities)
    return report


def compare(options):
    path = options.ours or build_ours("leastaction-tests", ["--bin", "peer_arm"], "--ours")
    ours = Program("ours", "", [path], list(QUANTITIES))
    report = {}
    with tempfile.TemporaryDirectory() as passing:
        folder = options.folder or Path(passing)
        folder.mkdir(parents=True, exist_ok=True)
        natives = list(pinocchio(folder, options.quick)) if "pinocchio" in options.rivals else []
        physics = mujoco(folder) if "mujoco" in options.rivals else None
        crates = [phyz_rigid()] if "phyz-rigid" in options.rivals else []
        writer = generator(folder) if "pinocchio-generated" in options.rivals else None
        for name in options.arms:
            given, bodies = text(name, options.states, options.seed)
            programs = [ours, *natives, *crates]
            if writer:
                programs += generated((folder / f"{name} {options.seed}").resolve(), writer, given, options.quick)
            if physics:
                described = folder / f"{name}.xml"
                described.write_text(mjcf(ARMS[name][0], bodies))
                programs.append(Program("mujoco", "its own build", [physics, described], WITHOUT_DERIVATIVES))
            report[name] = one_arm(name, given, programs, options.rounds)
    if options.json:
        print(json.dumps(report))
    else:
        show(report)
    bad = [f"{name}, {rival} {how}: {key} {value:.1e}" for name, of in report.items() for rival, its in of["rivals"].items()
           for how, worst in its["differences"].items() for key, value in worst.items() if not value <= options.tolerance]
    if bad:
        raise Failure("the programs do not agree: " + "; ".join(bad))


def show(report):
    print(f"{'arm':<11} {'function':<17} {'ours, ns':>9}  {'rival':<19} {'ns':>6} {'times as fast':>14}  compiled with")
    for name, of in report.items():
        for key in TIMED:
            mine = of["ours_ns"][key]
            for rival, its in of["rivals"].items():
                if best := fastest(its["ns"], key):
                    print(f"{name:<11} {key:<17} {mine:>9.0f}  {rival:<19} {best[0]:>6.0f} {best[0] / mine:>14.2f}  {best[1]}")
    print("ours with eight states side by side, ns a state (times as fast as one state a call):")
    for name, of in report.items():
        own = {key: (of["ours_ns"][f"{key}_lanes"], of["ours_ns"][key]) for key in TIMED}
        print(f"  {name}: " + ", ".join(f"{key} {beside:.0f} ({alone / beside:.2f})" for key, (beside, alone) in own.items()))
    print("largest difference over the largest entry:")
    for rival in next(iter(report.values()))["rivals"]:
        worst = {name: max(value for its in of["rivals"][rival]["differences"].values() for value in its.values())
                 for name, of in report.items()}
        print(f"  {rival}: " + ", ".join(f"{name} {value:.1e}" for name, value in worst.items()))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true", help="one JSON object on stdout and nothing else")
    parser.add_argument("--rivals", nargs="+", choices=RIVALS, default=RIVALS)
    parser.add_argument("--arms", nargs="+", choices=list(ARMS), default=list(ARMS))
    parser.add_argument("--quick", action="store_true", help="Pinocchio and its generated code by gcc alone, without -ffast-math")
    parser.add_argument("--folder", type=Path, help="to build the rivals in; what is there is not built again [a new one, for one run]")
    parser.add_argument("--ours", type=Path, help="a peer_arm built otherwise")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--states", type=positive, default=200)
    parser.add_argument("--rounds", type=positive, default=3)
    parser.add_argument("--tolerance", type=float, default=1e-11)
    options = parser.parse_args()
    return exit_code(lambda: compare(options))


if __name__ == "__main__":
    sys.exit(main())
