"""Builds the programs that arm_pinocchio.py compares with ours."""

import functools
import importlib.util
import json
import os
import shutil
import sys
from dataclasses import dataclass
from pathlib import Path

from common import HERE, Failure, need, run

# Quantities of every state; with n coordinates, a quantity of exponent k has n^k numbers.
QUANTITIES = {"T": 0, "V": 0, "inverse_dynamics": 1, "gravity": 1, "mass_matrix": 2, "acceleration": 1, "force_q": 2, "force_v": 2}
WITHOUT_DERIVATIVES = [name for name in QUANTITIES if not name.startswith("force")]
TIMED = ["inverse_dynamics", "mass_matrix", "derivatives", "acceleration"]
# Quantities that phyz-rigid computes.
IN_RUST = ["inverse_dynamics", "gravity", "mass_matrix", "acceleration"]
# Quantities that Pinocchio's generated code computes.
GENERATED = [name for name in QUANTITIES if name not in ["T", "V"]]
RIVALS = ["pinocchio", "pinocchio-generated", "mujoco", "phyz-rigid"]
# Compilers and flags of Pinocchio and of its generated code; the fastest build counts, function by function.
CONFIGURATIONS = ["g++", "g++ -ffast-math", "clang++", "clang++ -ffast-math"]
FOR_GENERATED = ["gcc", "gcc -ffast-math", "clang -ffast-math", "clang -ffast-math -fno-slp-vectorize"]


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


def prefix_of_wheels():
    """The folder with the headers and libraries of Pinocchio's wheel."""
    prefix = package("pinocchio", "pin")
    while prefix.name != "cmeel.prefix":
        if prefix == prefix.parent:
            raise Failure("Pinocchio's headers are not beside its Python package: pip install pin", code=2)
        prefix = prefix.parent
    return prefix


def headers():
    """Flags of a compiler for programs with Pinocchio's headers, which need no library."""
    prefix = prefix_of_wheels()
    eigen = next((path for path in [prefix / "include/eigen3", Path("/usr/include/eigen3")] if path.is_dir()), None)
    if eigen is None:
        raise Failure("Eigen's headers are missing: pip install cmeel-eigen", code=2)
    # Settings from Pinocchio's own build files.
    lists = ["-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS", "-DBOOST_MPL_LIMIT_LIST_SIZE=30", "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30",
             "-DBOOST_FUSION_INVOKE_MAX_ARITY=12"]
    return ["-std=c++17", "-DNDEBUG", "-w", *lists, "-I", prefix / "include", "-I", eigen]


@functools.cache
def compiler(name):
    """The command of a compiler; clang may be the one in the package ziglang, and may be missing."""
    if shutil.which(name) or not name.startswith("clang"):
        need(name, f"install {name}")
        return [name]
    if importlib.util.find_spec("ziglang") is None:
        print(f"without {name}: install it, or pip install ziglang", file=sys.stderr)
        return None
    return [sys.executable, "-m", "ziglang", {"clang": "cc", "clang++": "c++"}[name]]


def compilers(configurations, quick):
    """Commands of these compilers and flags, or of the first only."""
    for how in configurations[:1 if quick else None]:
        name, *flags = how.split()
        if command := compiler(name):
            yield how, [*command, "-O3", "-march=native", *flags]


def pinocchio(folder, quick):
    """Builds Pinocchio's program, the same for all arms, with every configuration, or the first only."""
    for how, command in compilers(CONFIGURATIONS, quick):
        program = folder / f"pinocchio {how}"
        build(program, [*command, *headers(), HERE / "arm_pinocchio.cpp"])
        yield Program("pinocchio", how, [program], list(QUANTITIES))


def generator(folder):
    """Builds the program that writes C for an arm; none without the package that it needs."""
    if not (prefix_of_wheels() / "include/cppad/cg.hpp").exists():
        print("without Pinocchio's generated code: pip install cmeel-cppadcodegen", file=sys.stderr)
        return None
    program = folder / "generator"
    # Compiling takes minutes, generating less than a second.
    build(program, [*compiler("g++"), "-O0", *headers(), HERE / "arm_generator.cpp", "-ldl"])
    return program


def generated(folder, writer, given, quick):
    """Writes C for an arm and builds a program from it with every configuration, or the first only."""
    folder.mkdir(exist_ok=True)
    if not any(folder.glob("*.c")):
        run([writer, folder], input=given)
    sources = sorted([*folder.glob("*_forward_zero.c"), *folder.glob("*_jacobian.c")])
    for how, command in compilers(FOR_GENERATED, quick):
        objects, program = folder / f"objects {how}", folder / how
        if not program.exists():
            objects.mkdir(exist_ok=True)
            run([*command, "-c", *sources], cwd=objects)
            build(program, ["g++", "-std=c++17", "-O3", HERE / "arm_generated.cpp", *objects.glob("*.o"), "-lm"])
        yield Program("pinocchio-generated", how, [program], GENERATED)


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
