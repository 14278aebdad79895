#!/usr/bin/env python3
"""Times a ring of springs by the LGNN authors' network, f64, one core: JAX in linear time beside leastaction.

Needs `pip install jax` and cargo. See README.md beside this file.
Exit codes: 0 success, 1 the programs disagree, a tool failed or a demanded ratio was missed, 2 usage or a missing tool.
"""

import argparse
import json
import sys
import tempfile
from pathlib import Path

from common import Failure, build_ours, exit_code, positive, run
from one_core import Timed, jax, jnp, np, relative_error

# f_b, f_v, f_e, f₁ and T of the authors' network; the network of our springs.
LGNN_SIZES = ((1, 5, 5, 5), (10, 5, 5, 5), (5, 5, 5, 5), (5, 5, 5, 1), (6, 10, 10, 1))
SPRING_SIZES = ((1, 16, 1),)
EMBEDDING = 5
LAW = (-2.0, 1.0)  # c₁ and c₂ of the squared distance: the authors' spring, (r² − 1)²
STEP = 1e-3  # s
LOOP = 100  # steps of a compiled loop
CALLS = 20  # calls of a compiled function per measurement
COMPARED = 10  # steps after which places and velocities are compared; as in our program
SIZES = (5, 50, 500, 5_000)  # numbers of springs for which our step is timed; as in our program


# ---------------------------------------------------------------- weights


def random_networks(rng, sizes):
    """Glorot-uniform matrices, biases in ±0.1."""
    glorot = lambda i, o: rng.uniform(-1, 1, (o, i)) * np.sqrt(6 / (i + o))
    return [[(glorot(i, o), rng.uniform(-0.1, 0.1, o)) for i, o in zip(of, of[1:])] for of in sizes]


def random_lgnn(rng):
    """Networks, kinetic embedding and embedding; T is increasing and convex in |v|², hence masses are positive."""
    networks = random_networks(rng, LGNN_SIZES)
    networks[-1] = [(np.abs(matrix), bias) for matrix, bias in networks[-1]]
    return networks, rng.uniform(-1, 1, EMBEDDING), rng.uniform(-1, 1, EMBEDDING)


def random_states(rng, nodes):
    """The authors' initial states, rows of q and v: q ∈ U(0, 2)², v ∈ U(0, 0.1)² minus the mean."""
    q, v = rng.uniform(0, 2, (nodes, 2)), rng.uniform(0, 0.1, (nodes, 2))
    return np.concatenate([q, v - v.mean(axis=0)], axis=1)


def flat(networks, *numbers):
    """All numbers in one array, in the order in which our program reads them."""
    layers = [np.concatenate([matrix.ravel(), bias]) for network in networks for matrix, bias in network]
    return np.concatenate([*layers, *numbers])


def without_constants(network, constants):
    """The network without its leading, constant inputs, which become part of the bias."""
    (matrix, bias), *others = network
    known = len(constants)
    return [(matrix[:, known:], bias + matrix[:, :known] @ constants), *others]


# ---------------------------------------------------------------- networks, in two arrangements of the items


def squareplus(x):
    return 0.5 * (x + jnp.sqrt(x * x + 4.0))


def layered(product):
    """y(x) of a network whose layers are `product(matrix, bias, x)`."""

    def network(layers, x):
        for matrix, bias in layers[:-1]:
            x = squareplus(product(matrix, bias, x))
        return product(*layers[-1], x)

    return network


class Rows:
    """Items along the first axis: X Wᵀ + b."""

    network = staticmethod(layered(lambda matrix, bias, x: x @ matrix.T + bias))
    of_numbers = staticmethod(lambda x: x[:, None])
    numbers = staticmethod(lambda x: x[:, 0])
    constant = staticmethod(lambda x: x)
    items = 0


class Columns:
    """Items along the last axis: W X + b."""

    network = staticmethod(layered(lambda matrix, bias, x: matrix @ x + bias[:, None]))
    of_numbers = staticmethod(lambda x: x[None])
    numbers = staticmethod(lambda x: x[0])
    constant = staticmethod(lambda x: x[:, None])
    items = -1


LAYOUTS = {"rows": Rows, "columns": Columns}


# ---------------------------------------------------------------- edges of a ring: i → i + 1


class Rolled:
    """A ring whose neighbours are neighbours in the list."""

    def __init__(self, nodes, axis):
        self.axis = axis

    def ends(self, x):
        return x, jnp.roll(x, -1, self.axis)

    def sums(self, m):
        return m + jnp.roll(m, 1, self.axis)


class Indexed:
    """Any graph: ends are gathered by index, messages summed by segments."""

    def __init__(self, nodes, axis):
        self.axis, self.nodes = axis, nodes
        self.first = np.arange(nodes)
        self.second = (self.first + 1) % nodes

    def ends(self, x):
        return jnp.take(x, self.first, self.axis), jnp.take(x, self.second, self.axis)

    def sums(self, m):
        items = jnp.moveaxis(m, self.axis, 0)
        of = lambda ends: jax.ops.segment_sum(items, ends, self.nodes)
        return jnp.moveaxis(of(self.first) + of(self.second), 0, self.axis)


GATHERS = {"roll": Rolled, "index": Indexed}


# ---------------------------------------------------------------- models: q and v are 2 × nodes


def lgnn_acceleration(weights, layout, gather, nodes):
    """(L_q, v̇). Both directions of an edge have the same message and the same e′, computed once: half the work."""
    (embed, message, update, potential, kinetic), kinetic_h, h = weights
    message, kinetic = without_constants(message, h), without_constants(kinetic, kinetic_h)
    of, edges, vectors = layout.network, gather(nodes, layout.items), gather(nodes, -1)

    def energy(q):
        a, b = vectors.ends(q)
        r = jnp.sqrt(jnp.sum((a - b) ** 2, axis=0))
        e = of(embed, layout.of_numbers(r))
        n = layout.constant(h) + edges.sums(of(message, e))
        a, b = edges.ends(n)
        return 2.0 * jnp.sum(of(potential, e + of(update, a * b)))

    def slope(s):
        """T′ of every node, by forward differentiation with respect to |v|²."""
        return jax.jvp(lambda s: layout.numbers(of(kinetic, layout.of_numbers(s))), (s,), (jnp.ones_like(s),))[1]

    def acceleration(q, v):
        """Inverts M = 2T′ + 4T″vvᵀ of each node in closed form."""
        force = -jax.grad(energy)(q)
        s = jnp.sum(v * v, axis=0)
        first, second = jax.jvp(slope, (s,), (jnp.ones_like(s),))
        along = 2.0 * second * jnp.sum(v * force, axis=0) / (first + 2.0 * second * s)
        return force, (force - along * v) / (2.0 * first)

    return acceleration


def spring_acceleration(weights, layout, gather, nodes):
    """(L_q, v̇) of our springs, mass 1."""
    (potential,), (c1, c2) = weights
    vectors = gather(nodes, -1)

    def energy(q):
        a, b = vectors.ends(q)
        s = jnp.sum((a - b) ** 2, axis=0)
        return jnp.sum((c1 + c2 * s) * s) + jnp.sum(layout.network(potential, layout.of_numbers(s)))

    def acceleration(q, v):
        force = -jax.grad(energy)(q)
        return force, force

    return acceleration


def verlet(acceleration):
    """The authors' step of velocity Verlet: one acceleration per step, at the new place and the old velocity."""

    def step(q, v, a):
        q = q + STEP * (v + 0.5 * STEP * a)
        b = acceleration(q, v)[1]
        return q, v + 0.5 * STEP * (a + b), b

    return step


def repeated(step, times):
    return lambda q, v, a: jax.lax.fori_loop(0, times, lambda _, state: step(*state), (q, v, a))


class Candidates:
    """A model in all formulations; each has forces and accelerations, a step, and a loop of steps."""

    def __init__(self, formula, weights, states, compared):
        q, v = (jnp.asarray(np.ascontiguousarray(x.T)) for x in (states[:, :2], states[:, 2:]))
        self.accelerations, self.steps, self.compared = [], [], []
        for layout, gather in ((layout, gather) for layout in LAYOUTS for gather in GATHERS):
            name = f"{layout}, {gather}"
            acceleration = formula(weights, LAYOUTS[layout], GATHERS[gather], len(states))
            step = verlet(acceleration)
            self.accelerations.append(Timed(name, acceleration, (q, v), CALLS))
            state = (q, v, self.accelerations[-1].output[1])
            self.steps.append(Timed(f"{name}, call by call", step, state, CALLS))
            self.steps.append(Timed(f"{name}, in a loop", repeated(step, LOOP), state, units=LOOP))
            self.compared.append(jax.jit(repeated(step, compared))(*state)[:2])

    def measure(self):
        for timed in [*self.accelerations, *self.steps]:
            timed.measure()


# ---------------------------------------------------------------- our program


class Ours:
    """Our program, with its best times, s, and its last output."""

    def __init__(self, executable, folder):
        files = [folder / name for name in ("lgnn.f64", "springs.f64")]
        self.output = folder / "output.f64"
        self.measuring = [executable, "measure", *files, folder / "states.f64", self.output]
        self.scaling = [executable, "scale", *files, folder / "many_states.f64"]
        self.best, self.by_size = {}, {}

    def measure(self):
        for program, best in ((self.measuring, self.best), (self.scaling, self.by_size)):
            self.report = json.loads(run(program))
            for key, seconds in self.report.items():
                if key.endswith("_s"):
                    best[key] = np.minimum(best.get(key, np.inf), seconds)

    def vectors(self):
        """L_q and v̇ of LGNN's network, q and v of our springs after `COMPARED` steps; each 2 × nodes."""
        numbers = np.fromfile(self.output)
        return [part.T for part in numbers.reshape(4, -1, 2)]

    def exponents(self):
        """The exponents p of a step's processor time ∝ nᵖ."""
        logs = np.log(SIZES)
        return {key: float(np.polyfit(logs, np.log(times[:, 1]), 1)[0]) for key, times in self.by_size.items()}


# ---------------------------------------------------------------- the report


def errors_of(lgnn, springs, ours):
    """The largest relative differences between any formulation in JAX and ours."""
    l_q, acceleration, q, v = ours.vectors()
    pairs = {"L_q": [(timed.output[0], l_q) for timed in lgnn.accelerations]}
    pairs["acceleration"] = [(timed.output[1], acceleration) for timed in lgnn.accelerations]
    pairs["place"] = [(place, q) for place, _ in springs.compared]
    pairs["velocity"] = [(velocity, v) for _, velocity in springs.compared]
    return {key: max(relative_error(*pair) for pair in of) for key, of in pairs.items()}


def comparison(candidates, ours):
    """Times of JAX's fastest formulation and ours, wall and processor, µs, and our speed relative to JAX."""
    best = min(candidates, key=lambda timed: timed.cpu)
    row = {"jax": best.name, "jax_us": [1e6 * best.wall, 1e6 * best.cpu], "ours_us": [float(1e6 * x) for x in ours]}
    return row | {"ratio_wall": best.wall / float(ours[0]), "ratio_cpu": best.cpu / float(ours[1])}


DEMANDED = "step: LGNN's network in JAX, our springs"


def report_of(lgnn, springs, ours, options):
    times = lambda candidates: {timed.name: [1e6 * timed.wall, 1e6 * timed.cpu] for timed in candidates}
    best = ours.best
    return {
        "jax": jax.__version__,
        "springs": options.springs,
        "rounds": options.rounds,
        "relative_error": errors_of(lgnn, springs, ours),
        "candidates": {
            "LGNN's network, acceleration": times(lgnn.accelerations),
            "LGNN's network, step": times(lgnn.steps),
            "our springs, step": times(springs.steps),
        },
        "comparison": {
            "acceleration: LGNN's network in both": comparison(lgnn.accelerations, best["acceleration_s"]),
            "step: LGNN's network in both": comparison(lgnn.steps, best["lgnn_step_s"]),
            DEMANDED: comparison(lgnn.steps, best["springs_step_s"]),
            "step: our springs in both": comparison(springs.steps, best["springs_step_s"]),
        },
        "sizes": SIZES,
        "by_size_us": {key: (1e6 * times).tolist() for key, times in ours.by_size.items()},
        "exponents": ours.exponents(),
    }


def print_report(report):
    print(f"JAX {report['jax']}, a ring of {report['springs']} springs, f64, one core;")
    print(f"µs (wall, processor), fastest of {report['rounds']} alternating rounds\n")
    for title, rows in report["candidates"].items():
        print(f"JAX, {title}")
        for name, (wall, cpu) in rows.items():
            print(f"  {name:<30}{wall:>9.1f}{cpu:>9.1f}")
    print()
    for title, row in report["comparison"].items():
        print(title)
        for name, (wall, cpu) in (("JAX, " + row["jax"], row["jax_us"]), ("ours", row["ours_us"])):
            print(f"  {name:<36}{wall:>9.1f}{cpu:>9.1f}")
        print(f"  {row['ratio_cpu']:.2f} times JAX's speed by processor time, {row['ratio_wall']:.2f} by wall time")
    print("\nours by number of springs, µs of the processor a step")
    for key, times in report["by_size_us"].items():
        shown = "".join(f"{n:>8}: {cpu:.2f}" for n, (_, cpu) in zip(report["sizes"], times))
        print(f"  {key.removesuffix('_step_s'):<8}{shown}   ∝ n^{report['exponents'][key]:.3f}")
    print("\nlargest relative difference: " + ", ".join(f"{k} {e:.1e}" for k, e in report["relative_error"].items()))


def check(report, options):
    """Raises when the programs disagree or the demanded ratio is missed."""
    for key, error in report["relative_error"].items():
        if not error <= options.tolerance:
            raise Failure(f"{key} differs by {error:.1e} relative, allowed {options.tolerance:.1e}")
    ratio = report["comparison"][DEMANDED]["ratio_cpu"]
    if options.require is not None and ratio < options.require:
        raise Failure(f"{DEMANDED}: {ratio:.2f} times faster than JAX, demanded {options.require}")


# ---------------------------------------------------------------- command line


def parse(arguments):
    parser = argparse.ArgumentParser(description="Time a ring of springs by LGNN's network in JAX beside leastaction.")
    parser.add_argument("--json", action="store_true", help="print one JSON object and nothing else")
    parser.add_argument("--ours", type=Path, metavar="PATH", help="use this peer_lgnn instead of building it")
    parser.add_argument("--require", type=float, metavar="RATIO", help="fail unless a step of our springs is RATIO times faster than one of LGNN's network in JAX (processor time)")
    parser.add_argument("--tolerance", type=float, default=1e-9, help="allowed relative difference (default %(default)s)")
    parser.add_argument("--springs", type=positive, default=500, help="in the ring (default %(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="of the weights and states (default %(default)s)")
    parser.add_argument("--rounds", type=positive, default=5, help="alternations of the programs (default %(default)s)")
    return parser.parse_args(arguments)


def benchmark(options, folder):
    executable = options.ours.resolve() if options.ours else build_ours("leastaction-programs", ["--example", "peer_lgnn"], "--ours PATH")
    rng = np.random.default_rng(options.seed)
    lgnn, springs = random_lgnn(rng), (random_networks(rng, SPRING_SIZES), LAW)
    states = random_states(rng, options.springs)
    files = {"lgnn": flat(*lgnn), "springs": flat(*springs), "states": states, "many_states": random_states(rng, SIZES[-1])}
    for name, numbers in files.items():
        numbers.astype("<f8").tofile(folder / f"{name}.f64")
    programs = [
        Candidates(lgnn_acceleration, lgnn, states, COMPARED),
        Candidates(spring_acceleration, springs, states, COMPARED),
        Ours(executable, folder),
    ]
    for _ in range(options.rounds):
        for program in programs:
            program.measure()
    return report_of(*programs, options)


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
