#!/usr/bin/env python3
"""Trajectory optimisation with limits: CasADi with IPOPT beside `leastaction plan`, on the same problems in one run.

Needs `pip install casadi` (which brings numpy), gcc and cargo. See README.md beside this file.
Exit codes: 0 success, 1 the programs disagree, a tool failed or a demanded ratio was missed, 2 usage or a missing tool.
"""

import argparse
import json
import os
import sys
import tempfile
import time
from pathlib import Path

# Must precede the start of a thread: everything below and all programs that it starts run on one core.
os.environ["OMP_NUM_THREADS"] = "1"
if hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})

from common import HERE, Failure, build_ours, exit_code, need, positive, run

try:
    import casadi as ca
except ImportError as error:
    print(f"error: {error}: run `pip install casadi` for the interpreter {sys.executable}", file=sys.stderr)
    sys.exit(2)

import numpy as np

from control_check import self_test
from control_nlp import Program
from control_problem import read_problem
from control_runs import WARM, Ours, Rival, best, guessed_controls, judged, read_controls, starts, write_controls
from control_tick import Stepper
from control_tinympc import print_rows, regulate

PROBLEMS = ("pendulum", "cartpole", "acrobot", "pendubot", "arm")
FLAGS = ["-O3", "-march=native"]
COST_MARGIN = 1e-3  # by which our cost may exceed the rival's


# ---------------------------------------------------------------- one problem


class Comparison:
    """One problem in both programs."""

    def __init__(self, config, options, folder):
        self.options, self.folder, self.config = options, folder / config.stem, config
        self.folder.mkdir()
        self.problem = read_problem(config)
        self.program, self.stepper = Program(self.problem), Stepper(self.problem)
        began = time.perf_counter()
        self.rival = Rival(self.program, self.program.compile(self.folder, FLAGS), options)
        self.compile_s = time.perf_counter() - began
        self.runs, self.ours, self.judged = [], [], []

    def guess(self):
        """File of controls that both programs start from."""
        if self.options.guess:
            return self.options.guess
        path = self.folder / "guess.csv"
        write_controls(path, self.problem, guessed_controls(self.problem, self.options.seed))
        return path

    def run(self, executable):
        guess = self.guess()
        controls = read_controls(guess, self.problem)
        for start in starts(self.problem, self.program.layout, self.options.seeds, self.options.seed):
            self.runs += self.rival.from_start(*start)
        self.runs += self.rival.from_start("guess", self.stepper.rollout(controls), controls)
        if executable:
            self.run_ours(Ours(executable, self.config, self.problem, self.options), guess)
        return self.report()

    def run_ours(self, ours, guess):
        """Runs our program from its own starts and from the guess; IPOPT then starts from our solutions."""
        self.ours = [ours.plan("own", self.folder / "own")]
        try:
            self.ours.append(ours.plan("guess", self.folder / "guess", guess))
        except Failure as error:
            print(f"ours from the guess: {error}", file=sys.stderr)
        for each in self.ours:
            self.judged.append(judged(self.stepper, self.program.layout, each.states, each.controls))
            ticks = self.stepper_ticks(each)
            self.runs += self.rival.from_start(f"ours, {each.start}", ticks, each.controls, WARM)

    def stepper_ticks(self, solution):
        """States at all ticks of a solution that has those of the nodes."""
        inside = [self.stepper.node(x, tau)[:-1] for x, tau in zip(solution.states, solution.controls)]
        rows = [row for x, between in zip(solution.states, inside) for row in (x, *between)]
        return np.array([*rows, solution.states[-1]])

    def report(self):
        cold = [each for each in self.runs if not each.start.startswith("ours")]
        rival, ours = best(cold), best(self.ours)
        least = min((each.cost for each in self.runs if each.solved), default=None)
        report = {"name": self.problem.name, "nodes": self.problem.nodes, "variables": self.program.layout.size, "compile_s": self.compile_s}
        report |= {"runs": [each.row() for each in self.runs], "casadi": rival and rival.row(), "casadi_least_cost": least}
        report["ours"] = [each.row() | {"by_casadi": by} for each, by in zip(self.ours, self.judged)]
        report["best"] = ours and ours.row()
        report["ratio"] = rival.wall_s / ours.wall_s if rival and ours else None
        return report


# ---------------------------------------------------------------- the report


def print_run(row):
    time = f"{1e3 * row['wall_s']:>10.1f}{1e3 * row['processor_s']:>10.1f}"
    print(f"  {row['start']:<12}{row['options']:<23}{row['status'][:26]:<27}{row['iterations']:>6}{time}{row['cost']:>14.6f}{row['violation']:>10.0e}")


def print_report(report):
    print(f"{report['name']}: {report['nodes']} nodes, {report['variables']} variables, compiled in {report['compile_s']:.1f} s")
    print(f"  {'start':<12}{'options':<23}{'status':<27}{'iter.':>6}{'wall ms':>10}{'proc. ms':>10}{'cost':>14}{'violation':>10}")
    for row in report["runs"]:
        print_run(row)
    for row in report["ours"]:
        print_run(row | {"options": "leastaction"})
        print("    by CasADi: " + ", ".join(f"{key} {value:.9g}" for key, value in row["by_casadi"].items()))
    print_summary(report)


def print_summary(report):
    rival, ours = report["casadi"], report["best"]
    if rival:
        print(f"  CasADi with IPOPT: {1e3 * rival['wall_s']:.1f} ms from {rival['start']} ({rival['options']}), cost {rival['cost']:.6f}")
    if ours:
        print(f"  ours: {1e3 * ours['wall_s']:.1f} ms from {ours['start']}, cost {ours['cost']:.6f}")
    if report["ratio"]:
        print(f"  ours is {report['ratio']:.2f} times as fast; cost {ours['cost'] / report['casadi_least_cost']:.6f} of the least that IPOPT found")
    print(flush=True)


def check_agreement(report, tolerance):
    """Raises if the two programs do not optimise the same thing."""
    for row in report["ours"]:
        by, cost = row["by_casadi"], row["cost"]
        where = f"{report['name']}, ours from {row['start']}"
        for key, what in (("step", "a node's step"), ("limits", "a limit"), ("goal", "the goal"), ("start", "the start")):
            if not by[key] <= tolerance:
                raise Failure(f"{where}: {what} is violated by {by[key]:.1e} in CasADi, allowed {tolerance:.1e}")
        if not abs(by["cost"] - cost) <= tolerance * max(1.0, abs(cost)):
            raise Failure(f"{where}: the cost is {cost}, and {by['cost']} in CasADi")


def check_ratio(report, require):
    """Raises if our program is not as fast or as good as demanded."""
    ours, least = report["best"], report["casadi_least_cost"]
    if ours is None:
        raise Failure(f"{report['name']}: ours found no solution")
    if least is not None and ours["cost"] > least + COST_MARGIN * abs(least):
        raise Failure(f"{report['name']}: our cost {ours['cost']:.6f} exceeds IPOPT's {least:.6f} by more than a thousandth")
    if report["ratio"] is not None and report["ratio"] < require:
        raise Failure(f"{report['name']}: ours is {report['ratio']:.2f} times as fast as IPOPT, demanded {require}")


# ---------------------------------------------------------------- command line


def parse(arguments):
    parser = argparse.ArgumentParser(description="Trajectory optimisation in CasADi with IPOPT beside leastaction plan.")
    parser.add_argument("--json", action="store_true", help="print one JSON object and nothing else")
    parser.add_argument("--only", metavar="NAME", action="append", choices=PROBLEMS, help="one problem; may be given again")
    parser.add_argument("--casadi-only", action="store_true", help="measure CasADi alone")
    parser.add_argument("--self-test", action="store_true", help="check CasADi's functions against numpy and differences, and stop")
    parser.add_argument("--tinympc", action="store_true", help="only the regulator of a cart-pole, with TinyMPC as a further rival")
    parser.add_argument("--leastaction", type=Path, metavar="PATH", help="use this program instead of building it")
    parser.add_argument("--guess", type=Path, metavar="CSV", help="controls (t, u0, …) that both programs start from, with one --only")
    parser.add_argument("--require", type=float, metavar="RATIO", help="fail unless ours takes at most 1/RATIO of the time at no higher cost")
    parser.add_argument("--tolerance", type=float, default=1e-4, help="allowed difference of the two programs, whose steps are in single and in double precision (default %(default)s)")
    parser.add_argument("--repetitions", type=positive, default=3, help="of every solved run, the fastest counts (default %(default)s)")
    parser.add_argument("--seeds", type=int, default=3, help="number of random starts of IPOPT (default %(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="the first of them (default %(default)s)")
    parser.add_argument("--iterations", type=positive, default=500, help="IPOPT's largest number of iterations (default %(default)s)")
    parser.add_argument("--seconds", type=float, default=10.0, help="IPOPT's largest time per run (default %(default)s)")
    options = parser.parse_args(arguments)
    if options.casadi_only and (options.leastaction or options.require is not None):
        parser.error("--casadi-only excludes --leastaction and --require")
    if options.tinympc and options.only:
        parser.error("--tinympc excludes --only")
    if options.guess and len(options.only or []) != 1:
        parser.error("--guess needs exactly one --only")
    return options


def executable(options):
    if options.casadi_only:
        return None
    if options.leastaction:
        return options.leastaction.resolve()
    return build_ours("leastaction", ["--bin", "leastaction"], "--leastaction PATH or --casadi-only", "wheel")


def run_self_test(options, configs):
    errors = {config.stem: self_test(read_problem(config), options.seed) for config in configs}
    if options.json:
        print(json.dumps({"self_test": errors}))
        return
    for name, row in errors.items():
        print(f"{name}: order {row.pop('order'):.2f}; " + ", ".join(f"{key} {error:.0e}" for key, error in row.items()))


def benchmark(options, configs, folder):
    need("gcc", "install a C compiler, e.g. `apt install gcc`")
    program, reports = executable(options), []
    rows = regulate(read_problem(configs[0])) if options.tinympc else None
    if not options.json:
        print(f"CasADi {ca.__version__}, gcc {run(['gcc', '-dumpfullversion']).strip()} {' '.join(FLAGS)}\n")
        if rows:
            print_rows(rows)
    for config in configs:
        reports.append(Comparison(config, options, folder).run(program))
        if not options.json:
            print_report(reports[-1])
    if options.json:
        print(json.dumps({"casadi": ca.__version__, "flags": FLAGS, "problems": reports, "tinympc": rows}))
    check(reports, options)


def check(reports, options):
    for report in reports:
        check_agreement(report, options.tolerance)
        if options.require is not None:
            check_ratio(report, options.require)


def main(arguments):
    options = parse(arguments)
    names = ("balance",) if options.tinympc else options.only or PROBLEMS
    configs = [HERE / "control" / f"{name}.toml" for name in names]

    def compare():
        if options.self_test:
            run_self_test(options, configs)
            return
        with tempfile.TemporaryDirectory(prefix="leastaction-peers-") as folder:
            benchmark(options, configs, Path(folder))

    return exit_code(compare)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
