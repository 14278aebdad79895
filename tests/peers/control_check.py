"""`control_casadi.py --self-test`: CasADi's tick beside numpy, its derivatives beside differences, and the order of the step."""

from dataclasses import replace

import casadi as ca
import numpy as np

from common import Failure
from control_nlp import Program
from control_tick import GRAVITY, Stepper

STEP = 1e-3  # of fourth-order central differences


def rotation_about(axis, angle):
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.cos(angle) * np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * np.outer(axis, axis)


def frames(links, q):
    """Rotation and origin of every link in the base's frame; q may be complex."""
    found, used = [], iter(q)
    for link in links:
        rotation, origin = found[link.parent] if link.parent >= 0 else (np.eye(3), np.zeros(3))
        origin, rotation = origin + rotation @ link.place, rotation @ link.rotation
        value = 0 if link.kind == "fixed" else next(used)
        if link.kind == "prismatic":
            origin = origin + rotation @ link.axis * value
        else:
            rotation = rotation @ rotation_about(link.axis, value)
        found.append((rotation, origin))
    return found


def numpy_lagrangian(links, q, v):
    """T − V with positions in the base's frame and velocities by a complex step along v."""
    total = 0.0
    for link, (rotation, origin) in zip(links, frames(links, q + 1e-30j * v)):
        centre = origin + rotation @ link.centre
        velocity, spin = centre.imag / 1e-30, rotation.real.T @ rotation.imag / 1e-30
        turn = np.array([spin[2, 1], spin[0, 2], spin[1, 0]])
        total += link.mass * (velocity @ velocity / 2 - GRAVITY * centre[2].real) + turn @ link.inertia @ turn / 2
    return total


def difference(function, x):
    """Jacobian by central differences."""
    columns = []
    for e in STEP * np.eye(len(x)):
        near, far = function(x + e) - function(x - e), function(x + 2 * e) - function(x - 2 * e)
        columns.append((8 * near - far) / (12 * STEP))
    return np.array(columns).T


def relative(got, expected):
    got, expected = np.array(got, dtype=float).squeeze(), np.array(expected).squeeze()
    return float(np.abs(got - expected).max() / max(np.abs(expected).max(), 1e-300))


def tick_errors(problem, rng):
    """Errors of p, a and b at a random state, relative to the largest entry."""
    q, v, q1, tau = rng.normal(size=(4, problem.coordinates))
    functions, h = Stepper(problem).functions, problem.tick
    q1 = q + h * q1
    m, w = (q + q1) / 2, (q1 - q) / h

    def momentum(q, v):
        return difference(lambda x: numpy_lagrangian(problem.links, q, x), v)

    push = h / 2 * (difference(lambda x: numpy_lagrangian(problem.links, x, w), m) + tau)
    expected = [momentum(q, v), push - momentum(m, w), push + momentum(m, w)]
    got = [functions["momentum"](q, v), *functions["halves"](q, q1, tau)]
    return {"tick": max(map(relative, got, expected))}


def program_errors(problem, rng):
    """Errors of gradient, Jacobian and Hessian of the whole problem along a random direction."""
    program = Program(problem)
    functions = {function.name(): function for function in program.functions()}
    z, along = rng.normal(size=(2, program.layout.size)) / 10
    weight, multipliers = 0.7, rng.normal(size=functions["nlp_g"].size1_out(0))

    def cost(z):
        return np.array(functions["nlp_f"](z, [])).ravel()

    def constraints(z):
        return np.array(functions["nlp_g"](z, [])).ravel()

    def jacobian(z):
        return functions["nlp_jac_g"](z, [])[1]

    def gradient(z):
        return np.array(weight * functions["nlp_grad_f"](z, [])[1] + jacobian(z).T @ multipliers).ravel()

    def slope(function):
        return difference(lambda t: function(z + t[0] * along), np.zeros(1))

    upper = functions["nlp_hess_l"](z, [], weight, multipliers)
    hessian = upper + upper.T - ca.diag(ca.diag(upper))
    return {
        "gradient": relative(functions["nlp_grad_f"](z, [])[1].T @ along, slope(cost)),
        "jacobian": relative(jacobian(z) @ along, slope(constraints)),
        "hessian": relative(hessian @ along, slope(gradient)),
    }


def order(problem):
    """Slope of the error at .2 s against the tick, with a constant control, a twentieth of the limits."""
    seconds, tick = 0.2, problem.tick

    def end(parts):
        problem.tick = 0.02 / parts
        tau = problem.u[:, 1] / 20
        return Stepper(problem).rollout([tau] * round(seconds / problem.tick / problem.ticks_per_node))[-1]

    try:
        exact = end(64)
        errors = [np.abs(end(parts) - exact).max() for parts in (2, 4, 8)]
    finally:
        problem.tick = tick
    return float(np.polyfit(np.log([2, 4, 8]), np.log(errors), 1)[0] * -1)


def self_test(problem, seed):
    """Checks a problem, and returns its errors and the order."""
    rng = np.random.default_rng(seed)
    errors = tick_errors(problem, rng)
    for ticks in (1, 3):
        short = replace(problem, nodes=7, ticks_per_node=ticks)
        errors |= {f"{key}, {ticks} ticks a node": error for key, error in program_errors(short, rng).items()}
    slope = order(problem)
    if not max(errors.values()) < 1e-7:
        raise Failure(f"{problem.name}: CasADi's functions disagree with numpy or with differences: {errors}, allowed 1e-7")
    if not abs(slope - 2) < 0.1:
        raise Failure(f"{problem.name}: the step has order {slope:.2f} instead of 2")
    return errors | {"order": slope}
