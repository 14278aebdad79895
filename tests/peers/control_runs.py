"""Runs of `control_casadi.py`: IPOPT from several starts with several options, our program, and our trajectory in CasADi's formulas."""

import csv
import json
import time
from dataclasses import dataclass, field

import casadi as ca
import numpy as np

from common import Failure, run

LIGHT = {"mumps_scaling": 0, "mumps_permuting_scaling": 0, "mumps_pivot_order": 0}  # no scaling, AMD
OPTIONS = {
    "monotone": {"mu_strategy": "monotone"},
    "monotone, light MUMPS": {"mu_strategy": "monotone"} | LIGHT,
    "adaptive": {"mu_strategy": "adaptive"},
    "adaptive, light MUMPS": {"mu_strategy": "adaptive"} | LIGHT,
    "probing, light MUMPS": {"mu_strategy": "adaptive", "mu_oracle": "probing"} | LIGHT,
}
# IPOPT's own advice for a start that is a solution already.
WARM = {
    "warm": {"mu_strategy": "monotone", "mu_init": 1e-7, "bound_push": 1e-9, "bound_frac": 1e-9} | LIGHT,
}


@dataclass
class Run:
    """One optimisation, with the fastest times of its repetitions."""

    start: str
    options: str
    status: str
    solved: bool
    cost: float
    violation: float
    iterations: int
    wall_s: float
    processor_s: float
    states: np.ndarray = field(repr=False)
    controls: np.ndarray = field(repr=False)

    def row(self):
        return {key: value for key, value in vars(self).items() if key not in ("states", "controls")}


# ---------------------------------------------------------------- starts


def straight_line(problem, layout):
    """States between start and the nearest point of the goal, at the speed of the line."""
    n, ticks = problem.coordinates, layout.ticks
    end = np.clip(problem.start, *problem.goal.T)
    states = problem.start + np.linspace(0, 1, ticks + 1)[:, None] * (end - problem.start)
    states[:, n:] = (end - problem.start)[:n] / (ticks * problem.tick)
    return states


def random_start(problem, layout, seed):
    """The straight line with four sine waves of random amplitude, and random controls."""
    n, rng, states = problem.coordinates, np.random.default_rng(seed), straight_line(problem, layout)
    s, seconds = np.linspace(0, np.pi, layout.ticks + 1)[:, None], layout.ticks * problem.tick
    for wave in range(1, 5):
        amplitude = rng.standard_normal(n) / np.sqrt(wave)
        states[:, :n] += amplitude * np.sin(wave * s)
        states[:, n:] += amplitude * np.cos(wave * s) * wave * np.pi / seconds
    return states, np.clip(0.3 * rng.standard_normal((problem.nodes, n)), -1, 1) * problem.u[:, 1]


def guessed_controls(problem, seed):
    """Controls of a random start for both programs: four sine waves that together stay within a third of the limits."""
    rng, s = np.random.default_rng([seed, 1]), np.linspace(0, 2 * np.pi, problem.nodes)[:, None]
    waves = [rng.uniform(-1, 1, problem.coordinates) * np.sin(wave * s + rng.uniform(0, 6)) for wave in range(1, 5)]
    return sum(waves) / 12 * problem.u[:, 1]


def starts(problem, layout, seeds, first_seed):
    yield "line", straight_line(problem, layout), np.zeros((problem.nodes, problem.coordinates))
    for seed in range(first_seed, first_seed + seeds):
        yield f"random {seed}", *random_start(problem, layout, seed)


# ---------------------------------------------------------------- files of controls and trajectories


def write_controls(path, problem, controls):
    """A log with these controls; its positions are not used."""
    header = ["t", *named("qu", problem)]
    zeros = [0.0] * problem.coordinates
    rows = [[node * problem.node_seconds, *zeros, *row] for node, row in enumerate(controls.tolist())]
    with open(path, "w", newline="") as file:
        csv.writer(file).writerows([header, *rows])


def read_columns(path, names):
    """Columns of a log; an empty cell is not a number."""
    try:
        with open(path, newline="") as file:
            rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
        return np.array([[float(row[name] or "nan") for name in names] for row in rows])
    except OSError as error:
        raise Failure(f"{path} cannot be read: {error}", code=2) from error
    except (KeyError, ValueError, TypeError) as error:
        raise Failure(f"{path}: a column of {', '.join(names)} is missing or no number: {error}") from error


def named(letters, problem):
    return [f"{letter}{i}" for letter in letters for i in range(problem.coordinates)]


def read_controls(path, problem):
    controls = read_columns(path, named("u", problem))[: problem.nodes]
    if len(controls) != problem.nodes or not np.isfinite(controls).all():
        raise Failure(f"{path} has no controls of {problem.nodes} nodes")
    return controls


def read_trajectory(path, problem):
    """States at nodes, the last included, and controls."""
    states = read_columns(path, named("qv", problem))
    if len(states) != problem.nodes + 1:
        raise Failure(f"{path} has {len(states)} rows, expected one for each of {problem.nodes} nodes and the end")
    return states, read_controls(path, problem)


# ---------------------------------------------------------------- IPOPT


def violation(problem, layout, constraints, z):
    """Largest violation of a tick's equations, of limits and of the goal."""
    least, most = layout.bounds()
    beyond = np.maximum(least - z, z - most).max()
    return float(max(np.abs(np.array(constraints(z, []))).max(), beyond, 0.0))


class Rival:
    """A problem compiled for IPOPT."""

    def __init__(self, program, library, options):
        self.problem, self.layout, self.library, self.options = program.problem, program.layout, str(library), options
        self.constraints = ca.external("nlp_g", self.library)

    def solver(self, settings):
        limits = {"print_level": 0, "sb": "yes", "tol": 1e-8, "max_iter": self.options.iterations, "max_wall_time": self.options.seconds}
        ipopt = {f"ipopt.{key}": value for key, value in (limits | settings).items()}
        return ca.nlpsol("solver", "ipopt", self.library, ipopt | {"print_time": False, "no_nlp_grad": True})

    def solve(self, name, settings, start, states, controls):
        """Optimises once, and again for the time if there is a solution."""
        least, most = self.layout.bounds()
        arguments = {"x0": self.layout.pack(states, controls), "lbx": least, "ubx": most, "lbg": 0, "ubg": 0}
        solver = self.solver(settings)
        found, wall, processor = timed(solver, arguments)
        for _ in range(self.options.repetitions - 1 if solver.stats()["success"] else 0):
            _, again, cpu = timed(solver, arguments)
            wall, processor = min(wall, again), min(processor, cpu)
        stats, z = solver.stats(), np.array(found["x"]).ravel()
        return Run(
            start=start,
            options=name,
            status=stats["return_status"],
            solved=bool(stats["success"]),
            cost=float(found["f"]),
            violation=violation(self.problem, self.layout, self.constraints, z),
            iterations=stats["iter_count"],
            wall_s=wall,
            processor_s=processor,
            states=self.layout.unpack(z)[0],
            controls=self.layout.unpack(z)[1],
        )

    def from_start(self, start, states, controls, table=OPTIONS):
        return [self.solve(name, settings, start, states, controls) for name, settings in table.items()]


def timed(solver, arguments):
    """Output, wall seconds and processor seconds of one call."""
    wall, processor = time.perf_counter(), time.process_time()
    found = solver(**arguments)
    return found, time.perf_counter() - wall, time.process_time() - processor


def best(runs, tolerance=1e-3):
    """The fastest of the solved runs whose costs are within a thousandth of the least."""
    solved = [each for each in runs if each.solved]
    least = min((each.cost for each in solved), default=np.inf)
    close = [each for each in solved if each.cost <= least + tolerance * abs(least)]
    return min(close, key=lambda each: each.wall_s, default=None)


# ---------------------------------------------------------------- our program


class Ours:
    """Our program on a configuration."""

    def __init__(self, executable, config, problem, options):
        self.executable, self.config, self.problem, self.options = executable, config, problem, options

    def plan(self, name, folder, guess=None):
        """Runs the program, several times for the time, and reads the trajectory of the last run."""
        folder.mkdir(parents=True)
        arguments = [self.executable, "plan", self.config, "--json", "--output", folder, *(["--guess", guess] if guess else [])]
        printed = [self.printed(arguments) for _ in range(self.options.repetitions)]
        try:
            last, wall = printed[-1], min(float(one["solve_s"]) for one in printed)
            states, controls = read_trajectory(self.found(folder, last["files"]["csv"]), self.problem)
            numbers = {"cost": float(last["cost"]), "violation": float(last["violation"]), "iterations": int(last["iterations"])}
        except (KeyError, TypeError, ValueError) as error:
            raise Failure(f"{self.executable} plan did not print the object that README.md describes: {error!r}") from error
        solved = numbers["violation"] <= self.options.tolerance
        # The program reports the wall seconds of one core; there is no second clock.
        return Run(name, "", "solved" if solved else "violated", solved, wall_s=wall, processor_s=wall, states=states, controls=controls, **numbers)

    def printed(self, arguments):
        text = run(arguments)
        try:
            return json.loads(text)
        except ValueError as error:
            raise Failure(f"{self.executable} plan --json printed no JSON object: {error}") from error

    def found(self, folder, name):
        """The trajectory's file, whose name may be relative to the folder."""
        inside = folder / name
        return inside if inside.exists() else name


def judged(stepper, layout, states, controls):
    """Our trajectory by CasADi's formulas: cost, and the largest violations of step, limits, goal and start."""
    problem, per = stepper.problem, stepper.problem.ticks_per_node
    ticks, step = [states[0]], 0.0
    for x, tau, following in zip(states, controls, states[1:]):
        ticks += stepper.node(x, tau)
        step = max(step, np.abs(ticks[-1] - following).max())
        ticks[-1] = following
    weights, targets = layout.costs()
    z, (least, most) = layout.pack(np.array(ticks), controls), layout.bounds()
    z[layout.x[-1]] -= whole_turns(problem, layout, z)
    beyond = np.maximum(np.maximum(least - z, z - most), 0)
    seconds = problem.nodes * problem.node_seconds
    return {
        "cost": float(weights @ (z - targets) ** 2 / 2 + problem.weights["time"] * seconds),
        "step": float(step),
        "rollout": float(np.abs(stepper.rollout(controls)[::per] - states).max()),
        "limits": float(max(beyond[layout.x[1:-1]].max(), beyond[layout.u].max(), undriven(problem, controls))),
        "goal": float(beyond[layout.x[-1]].max()),
        "start": float(beyond[layout.x[0]].max()),
    }


def whole_turns(problem, layout, z):
    """Whole turns between the end and the goal, of positions without limits: any will do."""
    least, most = layout.bounds()
    last, before = layout.x[-1], layout.x[-2]
    middle = np.where(np.isfinite(least[last]), (least[last] + most[last]) / 2, z[last])
    turns = 2 * np.pi * np.round((z[last] - middle) / (2 * np.pi))
    free = np.isinf(least[before]) & np.isinf(most[before])
    return np.where(free & (np.arange(len(last)) < problem.coordinates), turns, 0.0)


def undriven(problem, controls):
    """Largest control of a coordinate that is not driven."""
    rest = np.delete(controls, problem.driven, axis=1)
    return float(np.abs(rest).max()) if rest.size else 0.0
