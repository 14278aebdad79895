#!/usr/bin/env python3
"""Cart-pole network in f32: CasADi's generated C beside leastaction, in one run.

Needs `pip install casadi` (which brings numpy), gcc and cargo. See README.md beside this file.
Exit codes: 0 success, 1 the outputs disagree, a tool failed or a demanded ratio was missed, 2 usage or a missing tool.
"""

import argparse
import json
import re
import shutil
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from common import HERE, Failure, build_ours, exit_code, need, positive, run

try:
    import casadi as ca
    import numpy as np
except ImportError as error:
    print(f"error: {error}: run `pip install casadi` for the interpreter {sys.executable}", file=sys.stderr)
    sys.exit(2)

SIZES = (3, 32, 32, 4)  # features (x, cos θ, sin θ) → … → (d0, d1, l10, V)
EPSILON = 1e-9  # H = LLᵀ + EPSILON I
H = 0.05  # step h in seconds, a constant of both programs
STATE_BOUNDS = np.array([0.5, np.pi, 1.0, 3.0, 1.0, 1.0, 2.0, 2.0])  # q0, w, p0, u
KERNELS = ("acceleration_ns", "residual_jacobian_ns")
OUTPUTS = ("acceleration", "residual", "jacobian")
# Names of our functions in the executable, with the compiler's functions for closures over arrays.
OUR_FUNCTIONS = re.compile(r"leastaction_core::|libm::|peer_cartpole::peer_|core::ops::try_trait::|core::array::")
BASE_FLAGS = "-O2"
FLAG_SETS = {
    "-O2": ["-O2"],
    "-O2 tgmath": ["-O2", "-include", "tgmath.h"],
    "-O3 native": ["-O3", "-march=native"],
    "-O3 native tgmath": ["-O3", "-march=native", "-include", "tgmath.h"],
}
# Flags of our builds beside those of the workspace: names and flags of rustc, from the fastest code to the smallest.
IN_REGISTERS = ["-Copt-level=2", "-Cpasses=slp-vectorizer", "-Cllvm-args=-unroll-runtime=false"]
OUTLINED = "-Cllvm-args=-enable-machine-outliner=always"
OUR_FLAG_SETS = {"": [], "2, SLP": IN_REGISTERS, "2, SLP, outlined": [*IN_REGISTERS, OUTLINED], "s, outlined": ["-Copt-level=s", OUTLINED]}
# Ratio to CasADi's best with -O2 that our smaller build must keep.
KEPT = 4


# ---------------------------------------------------------------- the network and its Lagrangian, in CasADi


@dataclass(frozen=True)
class Variant:
    """A variant of the generated C: graph type (scalar SX or matrix MX), weights as constants or as inputs."""

    symbol: type
    weights_as_input: bool

    @property
    def name(self):
        kind = "SX" if self.symbol is ca.SX else "MX"
        return f"{kind}, weights {'as input' if self.weights_as_input else 'constant'}"

    @property
    def stem(self):
        return f"{self.symbol.__name__.lower()}_{'input' if self.weights_as_input else 'constant'}"


VARIANTS = [Variant(symbol, as_input) for symbol in (ca.SX, ca.MX) for as_input in (False, True)]


def softplus(x):
    return ca.log1p(ca.exp(x))


def network(q, weights):
    x = ca.vertcat(q[0], ca.cos(q[1]), ca.sin(q[1]))
    for matrix, bias in zip(weights[0:4:2], weights[1:4:2]):
        x = ca.tanh(matrix @ x + bias)
    return weights[4] @ x + weights[5]


def energies(q, weights):
    """The entries H00, H01, H11 of the mass matrix, and V."""
    d0, d1, l10, potential = ca.vertsplit(network(q, weights))
    l00, l11 = softplus(d0), softplus(d1)
    return l00 * l00 + EPSILON, l00 * l10, l10 * l10 + l11 * l11 + EPSILON, potential


def lagrangian(q, v, weights):
    """L and the momentum L_v."""
    h00, h01, h11, potential = energies(q, weights)
    momentum = ca.vertcat(h00 * v[0] + h01 * v[1], h01 * v[0] + h11 * v[1])
    return ca.dot(v, momentum) / 2 - potential, momentum


def acceleration(q, v, u, weights):
    """M v̇ = L_q − L_vq v + u, solved in closed form.

    The energies' Jacobian by q (two forward passes) measured 5% faster in scalar and 20% in matrix graphs than
    the gradient of L with a directional derivative of the momentum.
    """
    entries = ca.vertcat(*energies(q, weights))
    by_q = ca.jacobian(entries, q)
    l_q = by_q.T @ ca.vertcat(v[0] ** 2 / 2, v[0] * v[1], v[1] ** 2 / 2, -1)
    rate = by_q @ v
    l_vq_v = ca.vertcat(rate[0] * v[0] + rate[1] * v[1], rate[1] * v[0] + rate[2] * v[1])
    r = l_q - l_vq_v + u
    h00, h01, h11, _ = ca.vertsplit(entries)
    return ca.vertcat(h11 * r[0] - h01 * r[1], h00 * r[1] - h01 * r[0]) / (h00 * h11 - h01 * h01)


def residual_jacobian(symbol, q0, w, p0, u, weights):
    """R(w) = p0 + (h/2) L_q − L_v + (h/2) u at m = q0 + h w/2 with velocity w, and ∂R/∂w."""
    m, v = symbol.sym("m", 2), symbol.sym("v", 2)
    value, momentum = lagrangian(m, v, weights)
    at_midpoint = p0 + H / 2 * ca.gradient(value, m) - momentum + H / 2 * u
    (residual,) = ca.substitute([at_midpoint], [m, v], [q0 + H / 2 * w, w])
    return residual, ca.densify(ca.jacobian(residual, w))


def symbolic_weights(symbol):
    shapes = [shape for fan_in, fan_out in zip(SIZES, SIZES[1:]) for shape in ((fan_out, fan_in), (fan_out, 1))]
    return [symbol.sym(f"weights{i}", *shape) for i, shape in enumerate(shapes)]


def functions(variant, weights):
    """CasADi's `acceleration(q, v, u[, weights])` and `residual_jacobian(q0, w, p0, u[, weights])`."""
    q, v, p, u = (variant.symbol.sym(name, 2) for name in "qvpu")
    inputs = symbolic_weights(variant.symbol) if variant.weights_as_input else []
    values = inputs or [ca.DM(w.astype(np.float64)) for w in weights]
    accelerations = ca.cse([acceleration(q, v, u, values)])
    residuals = ca.cse(list(residual_jacobian(variant.symbol, q, v, p, u, values)))
    return (
        ca.Function("acceleration", [q, v, u, *inputs], accelerations),
        ca.Function("residual_jacobian", [q, v, p, u, *inputs], residuals),
    )


def reference_outputs(weights, states):
    """CasADi's own evaluation in f64, for the same f32 weights and states."""
    acc, del_ = functions(Variant(ca.SX, False), weights)
    q, w, p, u = (states[:, i : i + 2].T.astype(np.float64) for i in (0, 2, 4, 6))
    count = len(states)
    residual, jacobian = del_.map(count)(q, w, p, u)
    return {
        "acceleration": np.array(acc.map(count)(q, w, u)).T,
        "residual": np.array(residual).T,
        "jacobian": np.array(jacobian).reshape(2, count, 2).transpose(1, 0, 2).reshape(count, 4),
    }


# ---------------------------------------------------------------- an independent check, numpy only


def numpy_lagrangian(q, v, weights):
    """L(q, v) in plain numpy; analytic, hence a complex step differentiates it to rounding precision."""
    x = np.array([q[0], np.cos(q[1]), np.sin(q[1])])
    x = np.tanh(weights[0] @ x + weights[1])
    x = np.tanh(weights[2] @ x + weights[3])
    d0, d1, l10, potential = weights[4] @ x + weights[5]
    factor = np.array([[np.log(1 + np.exp(d0)), 0], [l10, np.log(1 + np.exp(d1))]])
    momentum = (factor @ factor.T + EPSILON * np.eye(2)) @ v
    return v @ momentum / 2 - potential


def complex_step(function, x):
    """Gradient of a scalar function, exact to rounding."""
    steps = 1e-30j * np.eye(len(x))
    return np.array([function(x + step).imag for step in steps]) / 1e-30


def central_difference(function, x, step=1e-3):
    """Jacobian of a vector function, fourth order in the step."""
    columns = []
    for e in step * np.eye(len(x)):
        near, far = function(x + e) - function(x - e), function(x + 2 * e) - function(x - 2 * e)
        columns.append((8 * near - far) / (12 * step))
    return np.array(columns).T


def numpy_outputs(weights, state):
    q, w, p, u = state[0:2], state[2:4], state[4:6], state[6:8]

    def l_q(q, v):
        return complex_step(lambda x: numpy_lagrangian(x, v, weights), q)

    def l_v(q, v):
        return complex_step(lambda x: numpy_lagrangian(q, x, weights), v)

    mass = central_difference(lambda v: l_v(q, v), w)
    coriolis = central_difference(lambda x: l_v(x, w), q) @ w

    def residual(w):
        m = q + H / 2 * w
        return p + H / 2 * l_q(m, w) - l_v(m, w) + H / 2 * u

    jacobian = central_difference(residual, w)
    return {
        "acceleration": np.linalg.solve(mass, l_q(q, w) - coriolis + u),
        "residual": residual(w),
        "jacobian": jacobian.ravel(),
    }


def self_test(weights, states):
    """Compares CasADi in f64 with finite differences of the numpy Lagrangian; returns the largest relative errors."""
    doubles = [w.astype(np.float64) for w in weights]
    rows = [numpy_outputs(doubles, state) for state in states.astype(np.float64)]
    expected = {key: np.array([row[key] for row in rows]) for key in OUTPUTS}
    return relative_errors(reference_outputs(weights, states), expected)


def relative_errors(outputs, expected):
    """The largest ‖Δ‖∞ / ‖expected‖∞ over all states, for each output."""
    errors = {}
    for key in OUTPUTS:
        got, want = np.array(outputs[key], dtype=np.float64), expected[key]
        if got.shape != want.shape:
            raise Failure(f"`{key}` has shape {got.shape}, expected {want.shape}: [states][components]")
        distance = np.abs(got - want).max(axis=1) / np.abs(want).max(axis=1)
        errors[key] = float(np.nan_to_num(distance, nan=np.inf).max())
    return errors


# ---------------------------------------------------------------- data


def random_weights(rng):
    """Glorot-uniform matrices and biases in ±0.1, as f32: [W1, b1, W2, b2, W3, b3], W[out][in]."""
    weights = []
    for fan_in, fan_out in zip(SIZES, SIZES[1:]):
        bound = np.sqrt(6 / (fan_in + fan_out))
        weights.append(rng.uniform(-bound, bound, (fan_out, fan_in)).astype("<f4"))
        weights.append(rng.uniform(-0.1, 0.1, fan_out).astype("<f4"))
    return weights


def write_inputs(folder, weights, states):
    (folder / "weights.f32").write_bytes(b"".join(w.tobytes(order="C") for w in weights))
    (folder / "weights_column_major.f32").write_bytes(b"".join(w.tobytes(order="F") for w in weights))
    (folder / "states.f32").write_bytes(states.astype("<f4").tobytes())


# ---------------------------------------------------------------- building and running


@dataclass
class Build:
    """One compiled variant: executable, size of its machine code in bytes (`text` of `size`), best times so far, outputs."""

    name: str
    flags: str
    executable: Path
    code_bytes: int
    best: dict
    outputs: dict

    def measure(self, arguments):
        printed = run([self.executable, *arguments])
        try:
            result = json.loads(printed)
            for key in KERNELS:
                self.best[key] = min(self.best.get(key, np.inf), float(result[key]))
            self.outputs = {key: result[key] for key in OUTPUTS}
        except (ValueError, KeyError, TypeError) as error:
            raise Failure(f"{self.executable} did not print the object README.md describes: {error!r}") from error


def generate_c(variant, weights, folder):
    generator = ca.CodeGenerator(f"{variant.stem}.c", {"casadi_real": "float"})
    for function in functions(variant, weights):
        generator.add(function)
    generator.generate(f"{folder}/")
    return folder / f"{variant.stem}.c"


def compile_build(variant, source, flags, folder):
    stem = f"{variant.stem}{''.join(FLAG_SETS[flags])}".replace("=", "")
    generated, executable = folder / f"{stem}.o", folder / stem
    run(["gcc", *FLAG_SETS[flags], "-c", source, "-o", generated])
    define = f"-DWEIGHTS_AS_INPUT={int(variant.weights_as_input)}"
    run(["gcc", "-O2", define, HERE / "harness.c", generated, "-o", executable, "-lm"])
    code_bytes = int(run(["size", generated]).splitlines()[1].split()[0])
    return Build(variant.name, flags, executable, code_bytes, {}, {})


def casadi_builds(weights, folder, flag_sets):
    builds = []
    for variant in VARIANTS:
        source = generate_c(variant, weights, folder)
        builds += [compile_build(variant, source, flags, folder) for flags in flag_sets]
    return builds


def our_code_bytes(executable):
    """Size of our functions in bytes: both entry points and everything linked from the crate and libm."""
    sizes = {}
    for line in run(["nm", "--print-size", "--demangle", "--defined-only", executable]).splitlines():
        match line.split(maxsplit=3):
            case [address, size, "t" | "T", name] if OUR_FUNCTIONS.search(name):
                sizes[address] = int(size, 16)
    return sum(sizes.values())


def our_builds(path, folder, flag_sets):
    """The build at this path, or one with each set of flags."""
    if path:
        return [Build("leastaction", "", path.resolve(), our_code_bytes(path.resolve()), {}, {})]
    builds = []
    for name in flag_sets:
        built = build_ours("leastaction-tests", ["--bin", "peer_cartpole"], "--ours PATH or --casadi-only", flags=OUR_FLAG_SETS[name])
        # The next build replaces this one.
        executable = shutil.copy(built, folder / f"leastaction {name}")
        builds.append(Build("leastaction", name, executable, our_code_bytes(executable), {}, {}))
    return builds


def measure(builds, ours, options, folder):
    """Alternates the programs, round after round; each keeps its fastest time."""
    column_major = [folder / "weights_column_major.f32", folder / "states.f32", options.repetitions, options.passes]
    for _ in range(options.rounds):
        for build in builds:
            build.measure(column_major)
        for build in ours:
            build.measure([folder / "weights.f32", folder / "states.f32"])


# ---------------------------------------------------------------- the report


def fastest(builds, key):
    return min(builds, key=lambda build: build.best[key])


def comparison(builds, ours, key):
    """CasADi's best time with plain -O2 and with any flags, and our speed relative to each."""
    base = fastest([b for b in builds if b.flags == BASE_FLAGS], key)
    tuned = fastest(builds, key)
    rows = {"casadi_o2_ns": base.best[key], "casadi_o2_variant": base.name, "casadi_o2_code_bytes": base.code_bytes}
    rows |= {"casadi_any_ns": tuned.best[key], "casadi_any_variant": f"{tuned.name}, {tuned.flags}"}
    if ours:
        rows |= {"ours_ns": ours[0].best[key], "ours_code_bytes": ours[0].code_bytes}
        rows |= {"ratio_o2": base.best[key] / ours[0].best[key], "ratio_any": tuned.best[key] / ours[0].best[key]}
    return rows


def trade(builds, ours):
    """Size and speed of the fastest and the smallest code of both programs; the speed is relative to CasADi's best with -O2."""
    base = [build for build in builds if build.flags == BASE_FLAGS]

    def row(name, build):
        ratios = {key: fastest(base, key).best[key] / build.best[key] for key in KERNELS}
        return {"name": name, "flags": build.flags, "code_bytes": build.code_bytes} | ratios

    def slowest(build):
        return min(row("", build)[key] for key in KERNELS)

    def size(build):
        return build.code_bytes

    rows = []
    if ours:
        kept = [build for build in ours if slowest(build) >= KEPT]
        rows += [row("ours, fastest", max(ours, key=slowest))]
        rows += [row(f"ours, smallest that is {KEPT} times as fast", min(kept, key=size))] if kept else []
        rows += [row("ours, smallest", min(ours, key=size))]
    return [*rows, row("CasADi's fastest", max(builds, key=slowest)), row("CasADi's smallest", min(builds, key=size))]


def summary(build, expected):
    row = {"name": build.name, "flags": build.flags, "code_bytes": build.code_bytes} | build.best
    return row | {"relative_error": relative_errors(build.outputs, expected)}


def make_report(builds, ours, expected, options):
    report = {"casadi": ca.__version__, "gcc": run(["gcc", "-dumpfullversion"]).strip(), "h": H}
    report |= {"seed": options.seed, "states": options.states, "rounds": options.rounds}
    report["builds"] = [summary(build, expected) for build in builds]
    report["ours"] = [summary(build, expected) for build in ours]
    report["trade"] = trade(builds, ours)
    report["comparison"] = {key: comparison(builds, ours, key) for key in KERNELS}
    return report


def print_row(row):
    worst = max(row["relative_error"].values())
    code = f"{row['code_bytes']:,}" if row["code_bytes"] else ""
    times = "".join(f"{row[key]:>14,.0f}" for key in KERNELS)
    print(f"{row['name']:<24}{row['flags']:<20}{times}{code:>14}{worst:>12.1e}")


def print_report(report):
    print(f"CasADi {report['casadi']}, gcc {report['gcc']}; ns per call, {report['rounds']} alternating rounds, fastest kept\n")
    print(f"{'':<44}{'acceleration':>14}{'residual+jac':>14}{'code bytes':>14}{'rel. error':>12}")
    for row in report["builds"]:
        print_row(row)
    for row in report["ours"]:
        print_row(row)
    print()
    print("code of both functions, and speed relative to CasADi's best with -O2, acceleration and residual+jac:")
    for row in report["trade"]:
        print(f"  {row['name']:<40}{row['code_bytes']:>8,} bytes" + "".join(f"{row[key]:>8.2f}" for key in KERNELS) + f"  {row['flags']}")
    for key, row in report["comparison"].items():
        print_comparison(key.removesuffix("_ns"), row)


def print_comparison(kernel, row):
    print(f"{kernel}: CasADi at -O2 {row['casadi_o2_ns']:,.0f} ns ({row['casadi_o2_variant']}, {row['casadi_o2_code_bytes']:,} bytes of code)")
    print(f"  with any flags {row['casadi_any_ns']:,.0f} ns ({row['casadi_any_variant']})")
    if "ours_ns" in row:
        print(f"  ours {row['ours_ns']:,.0f} ns, {row['ours_code_bytes']:,} bytes: {row['ratio_o2']:.2f} times faster than -O2, {row['ratio_any']:.2f} than any flags")


def check(report, options):
    """Raises when an output is wrong or a demanded ratio is missed."""
    for row in [*report["builds"], *report["ours"]]:
        for key, error in row["relative_error"].items():
            if not error <= options.tolerance:
                raise Failure(f"{row['name']} {row['flags']}: `{key}` is off by {error:.1e} relative, allowed {options.tolerance:.1e}")
    for key, row in report["comparison"].items():
        if options.require is not None and row["ratio_o2"] < options.require:
            raise Failure(f"{key}: {row['ratio_o2']:.2f} times faster than CasADi at -O2, demanded {options.require}")


# ---------------------------------------------------------------- command line


def parse(arguments):
    parser = argparse.ArgumentParser(description="Time CasADi's generated f32 C for the cart-pole network beside leastaction.")
    parser.add_argument("--json", action="store_true", help="print one JSON object and nothing else")
    parser.add_argument("--self-test", action="store_true", help="check CasADi's f64 outputs against numpy finite differences, and stop")
    parser.add_argument("--casadi-only", action="store_true", help="measure CasADi alone")
    parser.add_argument("--quick", action="store_true", help="only gcc -O2 and our usual build, without the further flags")
    parser.add_argument("--ours", type=Path, metavar="PATH", help="use this peer_cartpole instead of building it")
    parser.add_argument("--require", type=float, metavar="RATIO", help="fail unless ours is RATIO times faster than CasADi at -O2")
    parser.add_argument("--tolerance", type=float, default=1e-4, help="allowed relative error against CasADi in f64 (default %(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="of weights and states (default %(default)s)")
    parser.add_argument("--states", type=positive, default=256, help="number of random states (default %(default)s)")
    parser.add_argument("--rounds", type=positive, default=10, help="alternations of the programs (default %(default)s)")
    parser.add_argument("--repetitions", type=positive, default=5, help="repetitions in one run of CasADi's program (default %(default)s)")
    parser.add_argument("--passes", type=positive, default=4, help="passes over the states in a repetition (default %(default)s)")
    options = parser.parse_args(arguments)
    if options.casadi_only and (options.ours or options.require is not None):
        parser.error("--casadi-only excludes --ours and --require")
    return options


def run_self_test(weights, states, options):
    errors = self_test(weights, states)
    print(json.dumps({"self_test": errors}) if options.json else "\n".join(f"{k:<14}{e:.1e}" for k, e in errors.items()))
    if not max(errors.values()) < 1e-8:
        raise Failure(f"CasADi and numpy disagree: {errors}, allowed 1e-8")


def benchmark(weights, states, options, folder):
    need("gcc", "install a C compiler, e.g. `apt install gcc`")
    need("size", "install GNU binutils, e.g. `apt install binutils`")
    need("nm", "install GNU binutils, e.g. `apt install binutils`")
    ours = [] if options.casadi_only else our_builds(options.ours, folder, list(OUR_FLAG_SETS)[:1 if options.quick else None])
    write_inputs(folder, weights, states)
    builds = casadi_builds(weights, folder, [BASE_FLAGS] if options.quick else FLAG_SETS)
    measure(builds, ours, options, folder)
    report = make_report(builds, ours, reference_outputs(weights, states), options)
    print(json.dumps(report)) if options.json else print_report(report)
    check(report, options)


def main(arguments):
    options = parse(arguments)
    rng = np.random.default_rng(options.seed)
    weights = random_weights(rng)
    states = rng.uniform(-STATE_BOUNDS, STATE_BOUNDS, (options.states, len(STATE_BOUNDS))).astype("<f4")

    def compare():
        if options.self_test:
            run_self_test(weights, states, options)
            return
        with tempfile.TemporaryDirectory(prefix="leastaction-peers-") as folder:
            benchmark(weights, states, options, Path(folder))

    return exit_code(compare)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
