"""Compares trees of rigid bodies in space with Pinocchio, MuJoCo and a Rust crate: results and speed in f64, one state per call, on one core."""

import argparse
import importlib.util
import json
import math
import os
import random
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from common import HERE, Failure, build_ours, exit_code, need, positive, run

# Quantities of every state; with n coordinates, a quantity of exponent k has n^k numbers.
QUANTITIES = {"T": 0, "V": 0, "inverse_dynamics": 1, "gravity": 1, "mass_matrix": 2, "acceleration": 1, "force_q": 2, "force_v": 2}
WITHOUT_DERIVATIVES = [name for name in QUANTITIES if not name.startswith("force")]
TIMED = ["inverse_dynamics", "mass_matrix", "derivatives", "acceleration"]
# Quantities that phyz-rigid computes.
IN_RUST = ["inverse_dynamics", "gravity", "mass_matrix", "acceleration"]
RIVALS = ["pinocchio", "mujoco", "phyz-rigid"]
FLAGS = ["-O3", "-march=native", "-DNDEBUG"]
# Flags that Pinocchio is compiled with; the faster build counts, function by function.
CONFIGURATIONS = {"g++": [], "g++ -ffast-math": ["-ffast-math"]}
HALF = math.pi / 2
GRAVITY = [0, 0, -9.81]
# Joint frames (α, a, θ, d), each relative to the one before: Rx(α) Tx(a) Rz(θ) Tz(d), Craig's convention, from the makers' documents.
PANDA = [(0, 0, 0, 0.333), (-HALF, 0, 0, 0), (HALF, 0, 0, 0.316), (HALF, 0.0825, 0, 0), (-HALF, -0.0825, 0, 0.384),
         (HALF, 0, 0, 0), (HALF, 0.088, 0, 0)]
IIWA = [(0, 0, 0, 0.36), (-HALF, 0, 0, 0), (HALF, 0, 0, 0.42), (HALF, 0, 0, 0), (-HALF, 0, 0, 0.4), (-HALF, 0, 0, 0),
        (HALF, 0, 0, 0.126)]
UR5 = [(0, 0, 0, 0.089159), (HALF, 0, 0, 0), (0, -0.425, 0, 0), (0, -0.39225, 0, 0.10915), (HALF, 0, 0, 0.09465),
       (-HALF, 0, 0, 0.0823)]
# Two arms on a trunk with sliding joints: (parent, whether the joint slides).
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
    """The ten inertial numbers of a cloud of point masses, hence of a physical body."""
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
    """A tree of joints with random axes and places."""
    def one(dice):
        place = [dice.gauss(0, 0.4) for _ in range(3)]
        return body(dice, turn(direction(dice), dice.uniform(-3, 3)), place, direction(dice))
    return tree, lambda dice: [one(dice) for _ in tree]


ARMS = {"panda": of_frames(PANDA), "iiwa": of_frames(IIWA), "ur5": of_frames(UR5), "tree of 12": of_tree(TREE)}


def text(name, states, seed):
    """The input of all programs, and the bodies in it."""
    dice = random.Random(f"{name} {seed}")
    tree, bodies = ARMS[name]
    bodies = bodies(dice)
    weights = [*GRAVITY, *sum(bodies, [])]
    numbers = [dice.gauss(0, 1) for _ in range(3 * len(tree) * states)]
    words = [len(tree), *sum(map(list, tree), []), *weights, states, *numbers]
    return " ".join(repr(word) for word in words), bodies


# ---------------------------------------------------------------- the same arm for MuJoCo


def mjcf(tree, bodies):
    """The arm as MJCF, MuJoCo's format: inertias about the centres of mass."""
    def words(numbers):
        return " ".join(map(repr, numbers))

    def one(k):
        (_, slides), numbers = tree[k], bodies[k]
        place, axis, (mass, *rest), rotor = numbers[9:12], numbers[12:15], numbers[15:25], numbers[25]
        centre, (xx, xy, yy, xz, yz, zz) = [first / mass for first in rest[:3]], rest[3:]
        x, y, z = centre
        about = [xx - mass * (y * y + z * z), yy - mass * (x * x + z * z), zz - mass * (x * x + y * y),
                 xy + mass * x * y, xz + mass * x * z, yz + mass * y * z]
        children = "".join(one(child) for child, (parent, _) in enumerate(tree) if parent == k)
        return (f'<body pos="{words(place)}" xyaxes="{words([*numbers[0:9:3], *numbers[1:9:3]])}">'
                f'<joint type="{"slide" if slides else "hinge"}" axis="{words(axis)}" armature="{rotor!r}"/>'
                f'<inertial pos="{words(centre)}" mass="{mass!r}" fullinertia="{words(about)}"/>{children}</body>')

    roots = "".join(one(k) for k, (parent, _) in enumerate(tree) if parent == -1)
    off = " ".join(f'{what}="disable"' for what in ["constraint", "contact", "spring", "damper", "actuation", "sensor"])
    return (f'<mujoco><compiler angle="radian"/><option gravity="{words(GRAVITY)}"><flag {off}/></option>'
            f"<worldbody>{roots}</worldbody></mujoco>")


# ---------------------------------------------------------------- programs


@dataclass
class Program:
    """One of the compared programs: its name, its compiler flags, its command, and the quantities it prints."""

    rival: str
    how: str
    command: list
    quantities: list


def build(program, command):
    """Compiles a program, unless it exists from an earlier run."""
    if not program.exists():
        run([*command, "-o", program])


def package(name, install):
    """The folder of a Python package."""
    found = importlib.util.find_spec(name)
    if found is None or not found.submodule_search_locations:
        raise Failure(f"{name} is missing: pip install {install}", code=2)
    return Path(found.submodule_search_locations[0]).resolve()


def headers():
    """Flags of g++ to compile against Pinocchio's wheel, and to link with it."""
    need("g++", "install g++")
    prefix = package("pinocchio", "pin")
    while prefix.name != "cmeel.prefix":
        if prefix == prefix.parent:
            raise Failure("Pinocchio's headers are not beside its Python package: pip install pin", code=2)
        prefix = prefix.parent
    eigen = next((path for path in [prefix / "include/eigen3", Path("/usr/include/eigen3")] if path.is_dir()), None)
    if eigen is None:
        raise Failure("Eigen's headers are missing: pip install cmeel-eigen", code=2)
    # Settings from Pinocchio's own build files.
    lists = ["-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS", "-DBOOST_MPL_LIMIT_LIST_SIZE=30", "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30",
             "-DBOOST_FUSION_INVOKE_MAX_ARITY=12"]
    library = prefix / "lib"
    return [*lists, "-I", prefix / "include", "-I", eigen], ["-L", library, "-lpinocchio_default", f"-Wl,-rpath,{library}"]


def pinocchio(folder, quick):
    """Builds Pinocchio's program, the same for all arms, with every configuration, or the first only."""
    include, link = headers()
    for how, flags in list(CONFIGURATIONS.items())[:1 if quick else None]:
        program = folder / f"pinocchio {how}"
        build(program, ["g++", "-std=c++17", *FLAGS, *flags, *include, HERE / "arm_pinocchio.cpp", *link])
        yield Program("pinocchio", how, [program], list(QUANTITIES))


def phyz_rigid():
    """Builds the Rust crate's program, optimised for this machine."""
    need("cargo", "install Rust from https://rustup.rs")
    folder = HERE / "rust_rigid"
    messages = run(["cargo", "build", "--release", "--message-format=json"], cwd=folder, env=os.environ | {"RUSTFLAGS": "-Ctarget-cpu=native"})
    artifacts = [json.loads(line) for line in messages.splitlines() if line.startswith("{")]
    path = next(a["executable"] for a in reversed(artifacts) if a.get("executable"))
    return Program("phyz-rigid", "-Ctarget-cpu=native", [path], IN_RUST)


def mujoco(folder):
    """Builds MuJoCo's program, which calls the wheel's library from C++; it reads the arm from a file."""
    need("g++", "install g++")
    prefix, program = package("mujoco", "mujoco"), folder / "mujoco"
    library = next(prefix.glob("libmujoco.so*"), None)
    if library is None:
        raise Failure("MuJoCo's library is not in its Python package: pip install mujoco", code=2)
    build(program, ["g++", "-std=c++17", "-O3", HERE / "arm_mujoco.cpp", "-I", prefix / "include", library, f"-Wl,-rpath,{prefix}"])
    return program


# ---------------------------------------------------------------- comparison


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
        for name in options.arms:
            given, bodies = text(name, options.states, options.seed)
            programs = [ours, *natives, *crates]
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
    print(f"{'arm':<11} {'function':<17} {'ours, ns':>9}  {'rival':<10} {'ns':>6} {'times as fast':>14}  compiled with")
    for name, of in report.items():
        for key in TIMED:
            mine = of["ours_ns"][key]
            for rival, its in of["rivals"].items():
                if best := fastest(its["ns"], key):
                    print(f"{name:<11} {key:<17} {mine:>9.0f}  {rival:<10} {best[0]:>6.0f} {best[0] / mine:>14.2f}  {best[1]}")
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
    parser.add_argument("--quick", action="store_true", help="Pinocchio without -ffast-math alone")
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
