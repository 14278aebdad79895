#!/usr/bin/env python3
"""Times ModLaNet's training loss of a double pendulum, f64, one thread: JAX beside leastaction.

Needs `pip install jax` and cargo. See README.md beside this file.
Exit codes: 0 success, 1 the programs disagree, a tool failed or a demanded ratio was missed, 2 usage or a missing tool.
"""

import argparse
import json
import os
import sys
import tempfile
from pathlib import Path

from common import Failure, build_ours, exit_code, positive, run
from one_core import Timed, jax, jnp, np, relative_error

SIZES = ((2, 16, 16, 2), (2, 16, 16, 1))  # (cos q, sin q) → x of one pendulum's end; x → U
CHUNKS = (1, 9)  # numbers of parts in which the rows of the Jacobian are multiplied


# ---------------------------------------------------------------- the loss, in JAX


def unpack(flat):
    """Both networks as lists of (matrix, bias), and c₁."""
    networks, start = [], 0
    for sizes in SIZES:
        layers = []
        for inputs, outputs in zip(sizes, sizes[1:]):
            end = start + inputs * outputs
            layers.append((flat[start:end].reshape(outputs, inputs), flat[end : end + outputs]))
            start = end + outputs
        networks.append(layers)
    return networks, flat[start]


def mlp(layers, x):
    for matrix, bias in layers[:-1]:
        x = jnp.tanh(matrix @ x + bias)
    matrix, bias = layers[-1]
    return matrix @ x + bias


def solve(m, r):
    """Solves with a symmetric 2 × 2 matrix in closed form: a library call for every row would be slower."""
    return jnp.stack([m[1, 1] * r[0] - m[0, 1] * r[1], m[0, 0] * r[1] - m[0, 1] * r[0]]) / (
        m[0, 0] * m[1, 1] - m[0, 1] * m[0, 1]
    )


def automatic(flat, q, v):
    """v̇ from the Lagrangian alone, all derivatives by JAX."""
    (position, potential), c1 = unpack(flat)

    def energies(q, v):
        place = lambda q: mlp(position, jnp.stack([jnp.cos(q), jnp.sin(q)]))
        parts, rates = zip(*(jax.jvp(place, (q[i],), (v[i],)) for i in range(2)))
        kinetic = 0.5 * (rates[0] @ rates[0] + (rates[0] + rates[1]) @ (rates[0] + rates[1]))
        return kinetic - c1 * (mlp(potential, parts[0])[0] + mlp(potential, parts[0] + parts[1])[0])

    l_q = jax.grad(energies, 0)(q, v)
    momentum = jax.grad(energies, 1)
    _, turned = jax.jvp(lambda q: momentum(q, v), (q,), (v,))
    return solve(jax.jacfwd(momentum, 1)(q, v), l_q - turned)


def structured(flat, q, v):
    """v̇ assembled by hand from x, x′, x″ of each pendulum and the potentials' gradients."""
    (position, potential), c1 = unpack(flat)

    def place(q):
        return mlp(position, jnp.stack([jnp.cos(q), jnp.sin(q)]))

    def slope(q):
        return jax.jvp(place, (q,), (1.0,))

    def bend(q):
        (s, g), (_, g_q) = jax.jvp(slope, (q,), (1.0,))
        return s, g, g_q

    s, g, g_q = jax.vmap(bend)(q)
    ends = jnp.stack([s[0], s[0] + s[1]])
    force = -c1 * jax.vmap(jax.grad(lambda x: mlp(potential, x)[0]))(ends)
    # The first coordinate moves both ends, the second moves one.
    carried = jnp.array([[2.0, 1.0], [1.0, 1.0]])
    mass = carried * (g @ g.T)
    turned = (carried * (g @ g_q.T)) @ (v * v)
    l_q = jnp.stack([g[0] @ (force[0] + force[1]), g[1] @ force[1]])
    return solve(mass, l_q - turned)


FORMULAS = {"automatic": automatic, "structured": structured}


def loss_of(formula):
    def loss(flat, rows):
        predicted = jax.vmap(formula, (None, 0, 0))(flat, rows[:, 0:2], rows[:, 2:4])
        return jnp.mean((predicted - rows[:, 4:6]) ** 2)

    return jax.value_and_grad(loss)


def normal_of(formula, chunks):
    """JᵀJ and Jᵀr of the residuals; `jacrev` of a sample's two residuals gives rows of J."""

    def residual(flat, row):
        r = formula(flat, row[0:2], row[2:4]) - row[4:6]
        return r, r

    rows_of = jax.vmap(jax.jacrev(residual, has_aux=True), (None, 0))

    def part(flat, rows):
        jacobian, r = rows_of(flat, rows)
        jacobian = jacobian.reshape(-1, flat.size)
        return jacobian.T @ jacobian, jacobian.T @ r.reshape(-1)

    def normal(flat, rows):
        if chunks == 1:
            return part(flat, rows)
        zero = (jnp.zeros((flat.size, flat.size)), jnp.zeros(flat.size))
        add = lambda sums, rows: (jax.tree.map(jnp.add, sums, part(flat, rows)), None)
        return jax.lax.scan(add, zero, rows.reshape(chunks, -1, rows.shape[1]))[0]

    return normal


# ---------------------------------------------------------------- our program


class Ours:
    """Our program, with its best times, s, and its last output."""

    def __init__(self, executable, folder):
        self.command = [executable, "measure", *(folder / name for name in ("weights.f64", "rows.f64", "gram.f64"))]
        self.best = {"gradient_s": np.array([np.inf] * 2), "normal_s": np.array([np.inf] * 2)}

    def measure(self):
        self.report = json.loads(run(self.command, env=os.environ | {"RAYON_NUM_THREADS": "1"}))
        for key, best in self.best.items():
            self.best[key] = np.minimum(best, self.report[key])

    def gram(self):
        numbers = np.fromfile(self.command[-1])
        return numbers.reshape(len(self.report["gradient"]), -1)


# ---------------------------------------------------------------- weights and rows


def random_weights(rng):
    """Glorot-uniform matrices, biases in ±0.1, c₁ = 1."""
    parts = []
    for sizes in SIZES:
        for inputs, outputs in zip(sizes, sizes[1:]):
            bound = np.sqrt(6 / (inputs + outputs))
            parts += [rng.uniform(-bound, bound, inputs * outputs), rng.uniform(-0.1, 0.1, outputs)]
    return np.concatenate([*parts, [1.0]])


def read_rows(options, executable, folder):
    """q, v and v̇ of every training row."""
    file = options.data
    if file is None:
        file = folder / "data.npz"
        run([executable, "generate", file])
    try:
        with np.load(file) as arrays:
            rows = np.concatenate([arrays[key] for key in ("x", "v", "ac")], axis=1)
    except (OSError, KeyError, ValueError) as error:
        raise Failure(f"{file}: {error}: a double pendulum's .npz with x, v and ac is needed", code=2) from error
    if rows.shape[1] != 6:
        raise Failure(f"{file}: {rows.shape[1] // 3} coordinates; a double pendulum has 2", code=2)
    return rows.astype(np.float64)


# ---------------------------------------------------------------- the report


def errors_of(gradients, normals, ours):
    """The largest relative errors of JAX's formulas against ours."""
    gram, gradient = ours.gram(), np.array(ours.report["gradient"])
    errors = {"loss": 0.0, "gradient": 0.0, "gram": 0.0}
    for timed in gradients:
        errors["loss"] = max(errors["loss"], relative_error(timed.output[0], ours.report["loss"]))
        errors["gradient"] = max(errors["gradient"], relative_error(timed.output[1], gradient))
    for timed in normals:
        errors["gram"] = max(errors["gram"], relative_error(timed.output[0], gram))
    return errors


def comparison(candidates, ours):
    """Times of JAX's fastest variant of each formula and ours, s, and our speed relative to JAX."""
    wall, cpu = (float(x) for x in ours)
    row = {"ours_wall_s": wall, "ours_cpu_s": cpu}
    for formula in FORMULAS:
        best = min((timed for timed in candidates if timed.name.startswith(formula)), key=lambda timed: timed.cpu)
        row |= {f"{formula}_ratio_cpu": best.cpu / cpu, f"{formula}_ratio_wall": best.wall / wall}
    return row


def print_report(report):
    print(f"JAX {report['jax']}, {report['rows']} rows, {report['parameters']} parameters, f64, one thread;")
    print(f"seconds (wall, processor), fastest of {report['rounds']} alternating rounds\n")
    for title, rows in report["candidates"].items():
        for name, (wall, cpu) in rows.items():
            print(f"{title:<18}JAX {name:<26}{wall:>10.4f}{cpu:>10.4f}")
        row = report["comparison"][title]
        print(f"{title:<18}{'ours':<30}{row['ours_wall_s']:>10.4f}{row['ours_cpu_s']:>10.4f}")
        for formula in FORMULAS:
            cpu, wall = row[f"{formula}_ratio_cpu"], row[f"{formula}_ratio_wall"]
            print(f"  {cpu:.2f} times faster than JAX {formula} by processor time, {wall:.2f} by wall time")
        print()
    print("largest relative difference: " + ", ".join(f"{k} {e:.1e}" for k, e in report["relative_error"].items()))


def check(report, options):
    """Raises when the programs disagree or a demanded ratio is missed."""
    for key, error in report["relative_error"].items():
        if not error <= options.tolerance:
            raise Failure(f"{key} differs by {error:.1e} relative, allowed {options.tolerance:.1e}")
    for title, row in report["comparison"].items():
        ratio = row["automatic_ratio_cpu"]
        if options.require is not None and ratio < options.require:
            raise Failure(f"{title}: {ratio:.2f} times faster than JAX, demanded {options.require}")


# ---------------------------------------------------------------- command line


def parse(arguments):
    parser = argparse.ArgumentParser(description="Time JAX's acceleration loss of a double pendulum beside leastaction.")
    parser.add_argument("--json", action="store_true", help="print one JSON object and nothing else")
    parser.add_argument("--data", type=Path, metavar="FILE", help="train rows in ModLaNet's layout instead of generated ones")
    parser.add_argument("--ours", type=Path, metavar="PATH", help="use this peer_modlanet instead of building it")
    parser.add_argument("--require", type=float, metavar="RATIO", help="fail unless ours is RATIO times faster than JAX automatic (processor time)")
    parser.add_argument("--tolerance", type=float, default=1e-9, help="allowed relative difference (default %(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="of the weights (default %(default)s)")
    parser.add_argument("--rounds", type=positive, default=5, help="alternations of the programs (default %(default)s)")
    return parser.parse_args(arguments)


def benchmark(options, folder):
    executable = options.ours.resolve() if options.ours else build_ours("leastaction-learning", ["--example", "peer_modlanet"], "--ours PATH")
    weights, rows = random_weights(np.random.default_rng(options.seed)), read_rows(options, executable, folder)
    weights.astype("<f8").tofile(folder / "weights.f64")
    rows.astype("<f8").tofile(folder / "rows.f64")
    arguments = (jnp.asarray(weights), jnp.asarray(rows))
    gradients = [Timed(name, loss_of(formula), arguments) for name, formula in FORMULAS.items()]
    divisors = [parts for parts in CHUNKS if len(rows) % parts == 0]
    normals = [
        Timed(f"{name}, {parts} part{'s' * (parts > 1)}", normal_of(formula, parts), arguments)
        for name, formula in FORMULAS.items()
        for parts in divisors
    ]
    ours = Ours(executable, folder)
    for _ in range(options.rounds):
        for program in [*gradients, *normals, ours]:
            program.measure()
    return report_of(gradients, normals, ours, weights, rows, options)


def report_of(gradients, normals, ours, weights, rows, options):
    times = lambda candidates: {timed.name: [timed.wall, timed.cpu] for timed in candidates}
    report = {"jax": jax.__version__, "rows": len(rows), "parameters": weights.size, "rounds": options.rounds}
    report |= {"loss": ours.report["loss"], "relative_error": errors_of(gradients, normals, ours)}
    report["candidates"] = {"value+gradient": times(gradients), "normal equations": times(normals)}
    report["comparison"] = {
        "value+gradient": comparison(gradients, ours.best["gradient_s"]),
        "normal equations": comparison(normals, ours.best["normal_s"]),
    }
    return report


def main(arguments):
    options = parse(arguments)

    def compare():
        with tempfile.TemporaryDirectory(prefix="leastaction-peers-") as folder:
            report = benchmark(options, Path(folder))
        print(json.dumps(report)) if options.json else print_report(report)
        check(report, options)

    return exit_code(compare)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
