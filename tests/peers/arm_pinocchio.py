"""Trees of rigid bodies in space beside Pinocchio: what they compute, and how fast, in f64, one state a call, on one core."""

import argparse
import json
import math
import random
import sys
import tempfile
from pathlib import Path

from common import HERE, Failure, build_ours, exit_code, need, positive, run

QUANTITIES = ["T", "V", "inverse_dynamics", "gravity", "mass_matrix", "acceleration", "force_q", "force_v"]
TIMED = ["inverse_dynamics", "mass_matrix", "derivatives", "acceleration"]
HALF = math.pi / 2
# Frames of the joints, (α, a, θ, d) one after the other: Rx(α) Tx(a) Rz(θ) Tz(d), as Craig has them, from the makers' documents.
PANDA = [(0, 0, 0, 0.333), (-HALF, 0, 0, 0), (HALF, 0, 0, 0.316), (HALF, 0.0825, 0, 0), (-HALF, -0.0825, 0, 0.384),
         (HALF, 0, 0, 0), (HALF, 0.088, 0, 0)]
IIWA = [(0, 0, 0, 0.36), (-HALF, 0, 0, 0), (HALF, 0, 0, 0.42), (HALF, 0, 0, 0), (-HALF, 0, 0, 0.4), (-HALF, 0, 0, 0),
        (HALF, 0, 0, 0.126)]
UR5 = [(0, 0, 0, 0.089159), (HALF, 0, 0, 0), (0, -0.425, 0, 0), (0, -0.39225, 0, 0.10915), (HALF, 0, 0, 0.09465),
       (-HALF, 0, 0, 0.0823)]
# Two arms on a trunk, with slides: parent, and whether the joint slides.
TREE = [(-1, 0), (0, 0), (1, 0), (2, 1), (3, 1), (3, 0), (1, 1), (6, 0), (7, 1), (8, 0), (-1, 0), (10, 1)]


def times(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def turn(axis, angle):
    """The rotation about a unit axis."""
    x, y, z = axis
    c, s = math.cos(angle), math.sin(angle)
    return [[c + x * x * (1 - c), x * y * (1 - c) - z * s, x * z * (1 - c) + y * s],
            [y * x * (1 - c) + z * s, c + y * y * (1 - c), y * z * (1 - c) - x * s],
            [z * x * (1 - c) - y * s, z * y * (1 - c) + x * s, c + z * z * (1 - c)]]


def direction(dice):
    x = [dice.gauss(0, 1) for _ in range(3)]
    length = math.hypot(*x)
    return [entry / length for entry in x]


def inertia(dice):
    """The ten numbers of a cloud of points, and so of a body that can be."""
    points = [(dice.uniform(0.1, 1), [dice.uniform(-0.15, 0.15) for _ in range(3)]) for _ in range(6)]
    second = [[sum(m * x[i] * x[j] for m, x in points) for j in range(3)] for i in range(3)]
    trace = sum(second[i][i] for i in range(3))
    about = [[(trace if i == j else 0) - second[i][j] for j in range(3)] for i in range(3)]
    first = [sum(m * x[i] for m, x in points) for i in range(3)]
    return [sum(m for m, _ in points), *first, about[0][0], about[0][1], about[1][1], about[0][2], about[1][2], about[2][2]]


def body(dice, rotation, place, axis):
    return [*sum(rotation, []), *place, *axis, *inertia(dice), dice.uniform(0, 0.3)]


def of_frames(frames):
    """A chain of revolute joints."""
    def one(dice, frame):
        alpha, a, theta, d = frame
        tilt = turn([1, 0, 0], alpha)
        place = [a, -math.sin(alpha) * d, math.cos(alpha) * d]
        return body(dice, times(tilt, turn([0, 0, 1], theta)), place, [0, 0, 1])
    return [(k - 1, 0) for k in range(len(frames))], lambda dice: [one(dice, frame) for frame in frames]


def of_tree(tree):
    """Axes and places that stand askew."""
    def one(dice):
        place = [dice.gauss(0, 0.4) for _ in range(3)]
        return body(dice, turn(direction(dice), dice.uniform(-3, 3)), place, direction(dice))
    return tree, lambda dice: [one(dice) for _ in tree]


ARMS = {"panda": of_frames(PANDA), "iiwa": of_frames(IIWA), "ur5": of_frames(UR5), "tree of 12": of_tree(TREE)}


def text(name, states, seed):
    """What both programs read."""
    dice = random.Random(f"{name} {seed}")
    tree, bodies = ARMS[name]
    weights = [0, 0, -9.81, *sum(bodies(dice), [])]
    numbers = [dice.gauss(0, 1) for _ in range(3 * len(tree) * states)]
    words = [len(tree), *sum(map(list, tree), []), *weights, states, *numbers]
    return " ".join(repr(word) for word in words)


def pinocchio(folder, flags):
    """The compiled C++ program."""
    need("g++", "install g++")
    try:
        import pinocchio as package
    except ImportError as error:
        raise Failure("Pinocchio is missing: pip install pin", code=2) from error
    prefix = Path(package.__file__).resolve()
    while prefix.name != "cmeel.prefix":
        if prefix == prefix.parent:
            raise Failure("Pinocchio's headers are not beside its Python package: pip install pin", code=2)
        prefix = prefix.parent
    eigen = next((path for path in [prefix / "include/eigen3", Path("/usr/include/eigen3")] if path.is_dir()), None)
    if eigen is None:
        raise Failure("Eigen's headers are missing: apt-get install libeigen3-dev", code=2)
    program = Path(folder) / "arm_pinocchio"
    library = prefix / "lib"
    # As its own build files have it.
    lists = ["-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS", "-DBOOST_MPL_LIMIT_LIST_SIZE=30", "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30",
             "-DBOOST_FUSION_INVOKE_MAX_ARITY=12"]
    run(["g++", "-std=c++17", *flags, *lists, "-I", prefix / "include", "-I", eigen, HERE / "arm_pinocchio.cpp", "-o", program, "-L", library,
         "-lpinocchio_default", f"-Wl,-rpath,{library}"])
    return program


def outcome(program, given):
    """Rows of numbers, and nanoseconds by name."""
    lines = run([program], input=given).splitlines()
    rows = [[float(word) for word in line.split()] for line in lines if line[0] in "-0123456789"]
    timed = dict(line.split() for line in lines if line[0] not in "-0123456789")
    return rows, {name: float(value) for name, value in timed.items()}


def differences(n, ours, theirs):
    """Of every quantity the largest difference over its largest entry in the state, and the state that has it."""
    lengths = [1, 1, n, n, n * n, n, n * n, n * n]
    worst = dict.fromkeys(QUANTITIES, 0.0)
    for own, other in zip(ours, theirs, strict=True):
        at = 0
        for name, length in zip(QUANTITIES, lengths):
            a, b = own[at:at + length], other[at:at + length]
            at += length
            worst[name] = max(worst[name], max(abs(x - y) for x, y in zip(a, b)) / max(abs(y) for y in b))
    return worst


def compare(options):
    ours = options.ours or build_ours("leastaction-tests", ["--bin", "peer_arm"], "--ours")
    report = {}
    with tempfile.TemporaryDirectory() as folder:
        theirs = pinocchio(folder, options.flags.split())
        for name, (tree, _) in ARMS.items():
            given = text(name, options.states, options.seed)
            best = [dict.fromkeys(TIMED, math.inf) for _ in range(2)]
            for _ in range(options.rounds):
                for program, times_of in zip((ours, theirs), best):
                    rows, timed = outcome(program, given)
                    times_of.update({key: min(times_of[key], timed[key]) for key in TIMED})
                    if program == ours:
                        own = rows
            worst = differences(len(tree), own, rows)
            report[name] = {"joints": len(tree), "differences": worst, "ours_ns": best[0], "pinocchio_ns": best[1]}
    if options.json:
        print(json.dumps(report))
    else:
        show(report)
    bad = [f"{name}: {key} {value:.1e}" for name, of in report.items() for key, value in of["differences"].items()
           if not value <= options.tolerance]
    if bad:
        raise Failure("the programs do not agree: " + "; ".join(bad))


def show(report):
    print(f"{'arm':<11} {'function':<17} {'ours, ns':>9} {'Pinocchio, ns':>14} {'times as fast':>14}")
    for name, of in report.items():
        for key in TIMED:
            mine, other = of["ours_ns"][key], of["pinocchio_ns"][key]
            print(f"{name:<11} {key:<17} {mine:>9.0f} {other:>14.0f} {other / mine:>14.2f}")
    print("largest difference over the largest entry: " + ", ".join(
        f"{name} {max(of['differences'].values()):.1e}" for name, of in report.items()))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true", help="one JSON object on stdout and nothing else")
    parser.add_argument("--flags", default="-O3 -march=native -DNDEBUG", help="of g++ [%(default)s]")
    parser.add_argument("--ours", type=Path, help="a peer_arm built otherwise")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--states", type=positive, default=200)
    parser.add_argument("--rounds", type=positive, default=3)
    parser.add_argument("--tolerance", type=float, default=1e-11)
    options = parser.parse_args()
    return exit_code(lambda: compare(options))


if __name__ == "__main__":
    sys.exit(main())
