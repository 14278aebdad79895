"""Compares arrays of an arm's states in Python with Pinocchio's bindings, one state a call in a loop, and with our core: results and speed in f64."""

import argparse
import json
import os
import sys
import tempfile
import time
from pathlib import Path

# Must precede the start of our threads: everything below runs on one core.
os.environ["RAYON_NUM_THREADS"] = "1"
if hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})

from arm_models import ARMS, GRAVITY, mjcf, text
from arm_pinocchio import outcome
from arm_programs import QUANTITIES, Program
from common import Failure, build_ours, exit_code, positive

try:
    import numpy as np
    import pinocchio as pin

    import leastaction as la
except ImportError as missing:
    print(f"error: {missing}: run `pip install pin ./trainer/python` for the interpreter {sys.executable}", file=sys.stderr)
    sys.exit(2)

# States of peer_arm, which measures one state after the other and eight side by side.
OF_CORE = 200
# Calls in a row; the fastest counts.
CALLS = 5


def of_pinocchio(tree, bodies):
    """The arm as a model of Pinocchio, with its fastest joints."""
    model = pin.Model()
    model.gravity.linear = np.array(GRAVITY, dtype=float)
    for k, ((parent, slides), numbers) in enumerate(zip(tree, bodies)):
        rotation, place, axis = np.reshape(numbers[:9], (3, 3)), np.array(numbers[9:12]), np.array(numbers[12:15])
        if slides:
            joint = pin.JointModelPrismaticUnaligned(axis)
        else:
            joint = pin.JointModelRZ() if list(axis) == [0, 0, 1] else pin.JointModelRevoluteUnaligned(axis)
        number = model.addJoint(parent + 1, joint, pin.SE3(rotation, place), f"joint{k}")
        model.appendBodyToJoint(number, pin.Inertia.FromDynamicParameters(np.array(numbers[15:25])), pin.SE3.Identity())
    model.armature = np.array([numbers[25] for numbers in bodies])
    return model


def loops(model):
    """Functions of arrays q, v, x that call Pinocchio state by state."""
    data, n = model.createData(), model.nv

    def energies(q, v, _):
        to = np.empty((2, len(q)))
        for k in range(len(q)):
            to[0, k], to[1, k] = pin.computeKineticEnergy(model, data, q[k], v[k]), pin.computePotentialEnergy(model, data)
        return to

    def each(of):
        """A function of Pinocchio that takes q, v and one more vector, state by state."""
        def loop(q, v, x):
            to = np.empty_like(q)
            for k in range(len(q)):
                to[k] = of(model, data, q[k], v[k], x[k])
            return to
        return loop

    def mass_matrix(q, _v, _x):
        to = np.empty((len(q), n, n))
        for k in range(len(q)):
            to[k] = pin.crba(model, data, q[k])
        return to

    def derivatives(q, v, x):
        to = np.empty((3, len(q), n, n))
        for k in range(len(q)):
            pin.computeABADerivatives(model, data, q[k], v[k], x[k])
            to[0, k], to[1, k], to[2, k] = data.ddq_dq, data.ddq_dv, data.Minv
        return to

    return {"energies": energies, "inverse_dynamics": each(pin.rnea), "mass_matrix": mass_matrix, "acceleration": each(pin.aba),
            "derivatives": derivatives}


def calls(model):
    """Functions of Pinocchio that take arrays, on one thread."""
    pool = pin.ModelPool(model, 1)
    return {
        "inverse_dynamics": lambda q, v, x: pin.rneaInParallel(1, pool, q.T, v.T, x.T).T,
        "acceleration": lambda q, v, x: pin.abaInParallel(1, pool, q.T, v.T, x.T).T,
    }


def arrays(model):
    """The same functions of ours, of whole arrays."""
    double = model.double
    return {
        "energies": lambda q, v, _: double.energies(q, v),
        "inverse_dynamics": lambda q, v, x: double.inverse_dynamics(q, v, x),
        "mass_matrix": lambda q, _v, _x: double.mass_matrix(q),
        "acceleration": lambda q, v, x: double.acceleration(q, v, x),
        "derivatives": lambda q, v, x: model.acceleration_jacobians(q, v, x),
    }


def whole(name, result):
    """The result with what Pinocchio leaves out: triangles of symmetric matrices. Its kinetic energy omits the rotors of some joints."""
    if name == "energies":
        return result[1]
    if name in ["mass_matrix", "derivatives"]:
        matrix = result if name == "mass_matrix" else result[2]
        matrix[...] = np.triu(matrix) + np.triu(matrix, 1).swapaxes(-1, -2)
    return result


def difference(name, ours, theirs):
    """The largest difference over the largest entry."""
    ours, theirs = whole(name, np.array(ours)), whole(name, np.array(theirs))
    return float(np.abs(ours - theirs).max() / np.abs(theirs).max())


def nanoseconds(of, states):
    """Processor time per state, the least of all calls, and the result."""
    spent = []
    for _ in range(CALLS):
        started = time.process_time()
        result = of(*states)
        spent.append(time.process_time() - started)
    return min(spent) / len(states[0]) * 1e9, result


def keep(best, key, now):
    best[key] = min(now, best.get(key, now))


def one_arm(name, options, core, folder):
    given, bodies = text(name, OF_CORE, options.seed)
    described = folder / "arm.xml"
    described.write_text(mjcf(ARMS[name][0], bodies))
    model, rival = la.from_description(described), of_pinocchio(ARMS[name][0], bodies)
    random = np.random.default_rng(options.seed)
    states = [random.normal(size=(options.states, model.n)) for _ in range(3)]
    ours, rivals = arrays(model), {"loop": loops(rival), "arrays": calls(rival)}
    report = {"joints": model.n, "core_ns": {}, "ours_ns": {}, "pinocchio_ns": {how: {} for how in rivals}, "differences": {}}
    for _ in range(options.rounds):
        _, timed = outcome(Program("ours", "", [core], list(QUANTITIES)), given)
        for key, now in timed.items():
            keep(report["core_ns"], key, now)
        for key, of in ours.items():
            now, result = nanoseconds(of, states)
            keep(report["ours_ns"], key, now)
            for how, functions in rivals.items():
                if key in functions:
                    now, expected = nanoseconds(functions[key], states)
                    keep(report["pinocchio_ns"][how], key, now)
                    report["differences"][f"{key}, {how}"] = difference(key, result, expected)
    return report


def show(report):
    print(f"{'arm':<11} {'function':<17} {'ours, ns a state':>17} {'Pinocchio in a loop (times as fast)':>37} {'its arrays':>16}  core's lanes, ns")
    for name, of in report.items():
        for key, own in of["ours_ns"].items():
            other = [of["pinocchio_ns"][how].get(key) for how in ["loop", "arrays"]]
            loop, whole_arrays = ["" if ns is None else f"{ns:.0f} ({ns / own:.2f})" for ns in other]
            lanes = "" if key == "derivatives" or f"{key}_lanes" not in of["core_ns"] else f"{of['core_ns'][f'{key}_lanes']:.0f}"
            print(f"{name:<11} {key:<17} {own:>17.0f} {loop:>37} {whole_arrays:>16}  {lanes}")
        print(f"  largest difference over the largest entry: {max(of['differences'].values()):.1e}")


def compare(options):
    core = options.ours or build_ours("leastaction-tests", ["--bin", "peer_arm"], "--ours")
    with tempfile.TemporaryDirectory() as folder:
        report = {name: one_arm(name, options, core, Path(folder)) for name in options.arms}
    print(json.dumps(report)) if options.json else show(report)
    bad = [f"{name}: {key} {value:.1e}" for name, of in report.items() for key, value in of["differences"].items() if not value <= options.tolerance]
    if bad:
        raise Failure("the programs do not agree: " + "; ".join(bad))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true", help="one JSON object on stdout and nothing else")
    parser.add_argument("--arms", nargs="+", choices=list(ARMS), default=list(ARMS))
    parser.add_argument("--ours", type=Path, help="a peer_arm built otherwise")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--states", type=positive, default=10_000)
    parser.add_argument("--rounds", type=positive, default=3)
    parser.add_argument("--tolerance", type=float, default=1e-10)
    options = parser.parse_args()
    return exit_code(lambda: compare(options))


if __name__ == "__main__":
    sys.exit(main())
