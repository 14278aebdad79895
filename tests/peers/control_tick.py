"""The tick of `leastaction plan` in CasADi.

With w = (q₁ − q₀)/h, m = (q₀ + q₁)/2 and p = M(q)v a tick of order 2 is p₀ + a = 0 and p₁ − b = 0, where
a = (h/2)(L_q(m, w) + τ) − L_v(m, w) and b = (h/2)(L_q(m, w) + τ) + L_v(m, w). All derivatives are CasADi's, of scalar graphs (SX) in which
common subexpressions are computed once.
"""

import casadi as ca
import numpy as np

from common import Failure

GRAVITY = 9.81


def turned(link, q):
    """Rotation from the parent's frame to that of the link, and place of the link in the frame of its parent."""
    rotation, place = ca.DM(link.rotation), ca.DM(link.place)
    if link.kind == "revolute":
        x, y, z = link.axis
        cross = ca.DM([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        rotation = rotation @ (ca.DM.eye(3) + ca.sin(q) * cross + (1 - ca.cos(q)) * (cross @ cross))
    elif link.kind == "prismatic":
        place = place + ca.DM(link.rotation @ link.axis) * q
    return ca.sparsify(rotation).T, ca.sparsify(place)


def moved(link, carrier, q, v):
    """Angular velocity, velocity, upward direction in its own frame, and height of a link, from those of its carrier."""
    turn, speed, up, height = carrier
    rotation, place = turned(link, q)
    own = ca.sparsify(ca.DM(link.axis)) * v
    speed, height = rotation @ (speed + ca.cross(turn, place)), height + ca.dot(up, place)
    turn, up = rotation @ turn, rotation @ up
    return (turn + own, speed, up, height) if link.kind == "revolute" else (turn, speed + own, up, height)


def lagrangian(links, q, v):
    """T − V, body by body from the base."""
    base = (ca.SX(3, 1), ca.SX(3, 1), ca.SX(ca.sparsify(ca.DM([0, 0, 1]))), ca.SX(0))
    bodies, used, total = [], 0, 0
    for link in links:
        moves = link.kind != "fixed"
        carrier = bodies[link.parent] if link.parent >= 0 else base
        bodies.append(moved(link, carrier, *((q[used], v[used]) if moves else (0, 0))))
        used += moves
        total += body_lagrangian(link, *bodies[-1])
    return total


def body_lagrangian(link, turn, speed, up, height):
    centre = ca.sparsify(ca.DM(link.centre))
    velocity = speed + ca.cross(turn, centre)
    kinetic = link.mass * ca.dot(velocity, velocity) / 2 + ca.dot(turn, ca.DM(link.inertia) @ turn) / 2
    return kinetic - link.mass * GRAVITY * (height + ca.dot(up, centre))


def function(name, inputs, outputs):
    return ca.Function(name, inputs, ca.cse([ca.densify(output) for output in outputs]))


def tick_functions(problem):
    """`momentum(q, v)` and `halves(q0, q1, tau)` → a, b; both with Jacobians; the Hessians of λᵀp and of λₐᵀa − λ_bᵀb."""
    n = problem.coordinates
    q, v, la = (ca.SX.sym(name, n) for name in ("q", "v", "la"))
    energy, both = lagrangian(problem.links, q, v), ca.vertcat(q, v)
    p = ca.gradient(energy, v)
    of_momentum = [
        function("momentum", [q, v], [p]),
        function("momentum_jacobian", [q, v], [p, ca.jacobian(p, q), ca.jacobian(p, v)]),
        function("momentum_hessian", [q, v, la], [ca.hessian(ca.jtimes(energy, v, la), both)[0]]),
    ]
    return {each.name(): each for each in [*of_momentum, *halves_functions(problem.tick, energy, q, v)]}


def halves_functions(h, energy, q, v):
    n = q.numel()
    q0, q1, tau, la, lb = (ca.SX.sym(name, n) for name in ("q0", "q1", "tau", "la", "lb"))
    push, p, both = h / 2 * (ca.gradient(energy, q) + tau), ca.gradient(energy, v), ca.vertcat(q, v)
    a, b = push - p, push + p
    ends = ca.blockcat([[ca.DM.eye(n) / 2, ca.DM.eye(n) / 2], [-ca.DM.eye(n) / h, ca.DM.eye(n) / h]])
    # λₐᵀa − λ_bᵀb is but for τ a derivative of L in one direction.
    along = ca.jtimes(energy, q, h / 2 * (la - lb)) - ca.jtimes(energy, v, la + lb)

    def between(name, inputs, outputs):
        return function(name, inputs, ca.substitute(outputs, [q, v], [(q0 + q1) / 2, (q1 - q0) / h]))

    return [
        between("halves", [q0, q1, tau], [a, b]),
        between("halves_jacobian", [q0, q1, tau], [a, b, ca.jacobian(a, both) @ ends, ca.jacobian(b, both) @ ends]),
        between("halves_hessian", [q0, q1, la, lb], [ends.T @ ca.hessian(along, both)[0] @ ends]),
    ]


class Stepper:
    """The tick solved by Newton's method, one after the other."""

    def __init__(self, problem):
        self.problem, self.functions = problem, tick_functions(problem)

    def tick(self, x, tau):
        n = self.problem.coordinates
        q, p = x[:n], self.functions["momentum"](x[:n], x[n:])
        q1 = self.position(q, p, q + self.problem.tick * x[n:], tau)
        b = self.functions["halves"](q, q1, tau)[1]
        mass = self.functions["momentum_jacobian"](q1, x[n:])[2]
        return np.concatenate([q1, np.array(ca.solve(mass, b)).ravel()])

    def position(self, q, p, q1, tau):
        """Solves p + a = 0 for the next position, from a guess."""
        for _ in range(50):
            a, _, a_q, _ = self.functions["halves_jacobian"](q, q1, tau)
            step = np.array(ca.solve(a_q[:, len(q) :], p + a)).ravel()
            q1 = q1 - step
            if np.abs(step).max() < 1e-13 * (1 + np.abs(q1).max()):
                return q1
        raise Failure(f"{self.problem.name}: a tick from q = {q} has no solution after 50 updates of Newton's method")

    def node(self, x, tau):
        """States after every tick of a node."""
        found = [x]
        for _ in range(self.problem.ticks_per_node):
            found.append(self.tick(found[-1], tau))
        return found[1:]

    def rollout(self, controls):
        """States at all ticks from the start."""
        states = [self.problem.start]
        for tau in controls:
            states += self.node(states[-1], tau)
        return np.array(states)
