"""`control_casadi.py --tinympc`: TinyMPC as the regulator of a cart-pole, beside the least cost that any control can have.

TinyMPC solves at every tick a linear problem with limits over a short horizon, and its first control drives the nonlinear tick. IPOPT and our
program plan the whole motion of the same nonlinear problem with the same weights at once, with the goal reached exactly. Costs are those of
`control/balance.toml`, times those of one call of its solver, without the copies to Python.
"""

import contextlib
import os
import sys
import time

import numpy as np

from common import Failure
from control_check import difference
from control_tick import Stepper

HORIZON = 50  # ticks
PENALTIES = (0.01, 0.1, 1.0, 10.0)  # ρ of ADMM; the cheapest motion counts
ITERATIONS = (10, 100)


def linearised(problem, stepper):
    """A and B of a tick at rest in the goal."""
    n = problem.coordinates
    ab = difference(lambda x: stepper.node(x[: 2 * n], x[2 * n :])[-1], np.concatenate([problem.target, np.zeros(n)]))
    return ab[:, : 2 * n], ab[:, 2 * n :][:, problem.driven]


@contextlib.contextmanager
def quiet():
    """Silences what a library writes to the process's standard output."""
    sys.stdout.flush()
    kept, nothing = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nothing)


def regulator(problem, a, b, penalty, iterations):
    from tinympc import TinyMPC

    states = np.concatenate([problem.weights["q"], problem.weights["v"]])
    controls = problem.weights["u"][problem.driven]
    limits = np.clip(problem.limits, -1e10, 1e10)
    solver = TinyMPC()
    settings = {"max_iter": iterations, "abs_pri_tol": 1e-3, "abs_dua_tol": 1e-3, "check_termination": 1}
    solver.setup(a, b, np.diag(states), np.diag(controls), HORIZON, rho=penalty, **settings)
    u = problem.u[problem.driven]
    solver.set_bound_constraints(limits[:, 0], limits[:, 1], u[:, 0], u[:, 1])
    solver.update_settings(en_state_bound=True, en_input_bound=True)
    solver.set_x_ref(np.tile(problem.target[:, None], HORIZON))
    solver.set_u_ref(np.zeros((len(u), HORIZON - 1)))
    return solver


def drive(problem, stepper, solver):
    """The regulated motion: states, controls, and seconds of every call."""
    states, controls, seconds = [problem.start], [], []
    for _ in range(problem.nodes):
        solver.set_x0(states[-1])
        began = time.perf_counter()
        solver._solver.solve()  # without the copy of the solution to Python
        seconds.append(time.perf_counter() - began)
        tau = np.zeros(problem.coordinates)
        first = np.array(solver._solver.solution.u).reshape(len(problem.driven), -1)[:, 0]
        tau[problem.driven] = np.clip(first, *problem.u[problem.driven].T)
        controls.append(tau)
        states.append(stepper.node(states[-1], tau)[-1])
    return np.array(states), np.array(controls), np.array(seconds)


def cost(problem, states, controls):
    away = states[:-1] - problem.target
    weights = np.concatenate([problem.weights["q"], problem.weights["v"]])
    return problem.node_seconds / 2 * float((weights * away**2).sum() + (problem.weights["u"] * controls**2).sum())


def regulate(problem):
    """The motions by TinyMPC of all penalties and numbers of iterations, as rows of the report."""
    try:
        import tinympc  # noqa: F401
    except ImportError as error:
        raise Failure(f"{error}: run `pip install tinympc` for the interpreter {sys.executable}", code=2) from error
    stepper = Stepper(problem)
    a, b = linearised(problem, stepper)
    return [row(problem, stepper, a, b, penalty, iterations) for penalty in PENALTIES for iterations in ITERATIONS]


def cheapest(rows, tolerance=1e-3):
    """The cheapest motion within the limits."""
    return min((each for each in rows if each["limits"] <= tolerance), key=lambda each: each["cost"], default=None)


def row(problem, stepper, a, b, penalty, iterations):
    with quiet():
        states, controls, seconds = drive(problem, stepper, regulator(problem, a, b, penalty, iterations))
    least, most = problem.limits.T
    return {
        "penalty": penalty,
        "iterations": iterations,
        "cost": cost(problem, states, controls),
        "limits": float(np.maximum(np.maximum(least - states, states - most), 0).max()),
        "end": float(np.abs(states[-1] - problem.target).max()),
        "median_s": float(np.median(seconds)),
    }


def print_rows(rows):
    print(f"TinyMPC, {HORIZON} ticks ahead, closed loop")
    print(f"  {'ρ':>6}{'most iterations':>17}{'cost':>12}{'beyond limits':>15}{'from the goal':>15}{'median µs':>11}")
    for each in rows:
        print(f"  {each['penalty']:>6}{each['iterations']:>17}{each['cost']:>12.6f}{each['limits']:>15.1e}{each['end']:>15.1e}{1e6 * each['median_s']:>11.0f}")
    best = cheapest(rows)
    print(f"  cheapest within limits: {best['cost']:.6f}\n" if best else "  none stays within its limits\n")
