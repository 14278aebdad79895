"""A whole problem as compiled functions for IPOPT: multiple shooting over q and v at every tick and τ of every node.

Graphs of a tick are evaluated at all ticks by `map`, and sparse matrices are put together from them. Momentum, its Jacobian and its Hessian
at a tick are computed once, although two constraints have them.
"""

import casadi as ca
import numpy as np

from common import run
from control_tick import tick_functions


class Layout:
    """Places of the variables: the start, then for each node its controls and the states after its ticks."""

    def __init__(self, problem):
        self.problem = problem
        width, per, driven = 2 * problem.coordinates, problem.ticks_per_node, len(problem.driven)
        self.ticks, self.size = problem.nodes * per, width + problem.nodes * (driven + per * width)
        places = np.arange(width, self.size).reshape(problem.nodes, -1)
        self.u = places[:, :driven]
        self.x = np.vstack([np.arange(width), places[:, driven:].reshape(self.ticks, width)])

    def pack(self, states, controls):
        z = np.zeros(self.size)
        z[self.x], z[self.u] = states, controls[:, self.problem.driven]
        return z

    def unpack(self, z):
        """States at all ticks, and controls of all coordinates."""
        z = np.array(z).ravel()
        controls = np.zeros((self.problem.nodes, self.problem.coordinates))
        controls[:, self.problem.driven] = z[self.u]
        return z[self.x], controls

    def bounds(self):
        """Least and most of all variables; limits hold at nodes, the start is given, the end is in the goal."""
        problem = self.problem
        result = np.tile([-np.inf, np.inf], (self.size, 1))
        result[self.x[:: problem.ticks_per_node]] = problem.limits
        result[self.u] = problem.u[problem.driven]
        result[self.x[0]] = problem.start[:, None]
        least, most = np.maximum(problem.goal[:, 0], problem.limits[:, 0]), np.minimum(problem.goal[:, 1], problem.limits[:, 1])
        result[self.x[-1]] = np.column_stack([least, most])
        return result.T

    def costs(self):
        """Weights w and targets t of J = ½ Σ w (z − t)², without the cost of time."""
        problem = self.problem
        starts, seconds = self.x[: -1 : problem.ticks_per_node], problem.node_seconds
        weights, targets = np.zeros(self.size), np.zeros(self.size)
        weights[starts] = seconds * np.concatenate([problem.weights["q"], problem.weights["v"]])
        weights[self.u] = seconds * problem.weights["u"][problem.driven]
        targets[starts] = problem.target
        return weights, targets


class Blocks:
    """Dense blocks of a sparse matrix, as many of one size as there are ticks; entries at one place add up."""

    def __init__(self):
        self.rows, self.columns, self.values = [], [], []

    def add(self, rows, columns, entries):
        """Adds blocks that stand side by side in `entries`; `rows` and `columns` have a line of places per block."""
        shape = (rows.shape[0], columns.shape[1], rows.shape[1])
        self.rows.append(np.broadcast_to(rows[:, None, :], shape).ravel())
        self.columns.append(np.broadcast_to(columns[:, :, None], shape).ravel())
        self.values.append(ca.vec(ca.densify(entries)))

    def matrix(self, shape, upper=False):
        """Puts the matrix together, of a symmetric one the upper triangle."""
        rows, columns = np.concatenate(self.rows), np.concatenate(self.columns)
        kept = np.flatnonzero((rows <= columns) | (not upper))
        places, entry = np.unique(columns[kept] * shape[0] + rows[kept], return_inverse=True)
        pattern = ca.Sparsity.triplet(*shape, (places % shape[0]).tolist(), (places // shape[0]).tolist())
        return ca.MX(pattern, self.sums(kept, entry, len(places)))

    def sums(self, kept, entry, count):
        """Sums the values of each entry: the first of all entries, the second where there is one, and so on."""
        values = ca.vertcat(*self.values, ca.MX.zeros(1))
        order = np.argsort(entry, kind="stable")
        starts = np.searchsorted(entry[order], np.arange(count + 1))
        contributors = np.append(kept[order], values.numel() - 1)
        total = 0
        for layer in range(int(np.diff(starts).max())):
            at = starts[:-1] + layer
            total += values[contributors[np.where(at < starts[1:], at, -1)].tolist()]
        return total


class Program:
    """A problem as functions of all variables z, under the names by which IPOPT's interface looks them up."""

    def __init__(self, problem):
        self.problem, self.layout = problem, Layout(problem)
        self.tick = tick_functions(problem)
        self.z = ca.MX.sym("z", self.layout.size)

    def at(self, places):
        """Variables at an array of places, a column per line of the array."""
        return ca.reshape(self.z[places.ravel().tolist()], places.shape[1], places.shape[0])

    def controls(self):
        """Controls of all coordinates at all ticks."""
        held = self.at(np.repeat(self.layout.u, self.problem.ticks_per_node, axis=0))
        rows = [ca.MX.zeros(1, self.layout.ticks)] * self.problem.coordinates
        for row, index in enumerate(self.problem.driven):
            rows[index] = held[row, :]
        return ca.vertcat(*rows)

    def states(self):
        n, x = self.problem.coordinates, self.at(self.layout.x)
        return x[:n, :], x[n:, :]

    def mapped(self, name, *inputs):
        return self.tick[name].map(inputs[0].shape[1])(*inputs)

    def gradient(self):
        weights, targets = self.layout.costs()
        return ca.DM(weights) * (self.z - targets)

    def cost(self):
        _, targets = self.layout.costs()
        seconds = self.problem.nodes * self.problem.node_seconds
        return ca.dot(self.gradient(), self.z - targets) / 2 + self.problem.weights["time"] * seconds

    def constraints(self):
        """p₀ + a and p₁ − b of all ticks."""
        q, v = self.states()
        p = self.mapped("momentum", q, v)
        a, b = self.mapped("halves", q[:, :-1], q[:, 1:], self.controls())
        return ca.vec(ca.vertcat(p[:, :-1] + a, p[:, 1:] - b))

    def jacobian(self):
        n, ticks, x = self.problem.coordinates, self.layout.ticks, self.layout.x
        q, v = self.states()
        _, p_q, p_v = self.mapped("momentum_jacobian", q, v)
        _, _, a_q, b_q = self.mapped("halves_jacobian", q[:, :-1], q[:, 1:], self.controls())
        first = 2 * n * np.arange(ticks)[:, None] + np.arange(n)
        ends, blocks = np.hstack([x[:-1, :n], x[1:, :n]]), Blocks()
        for at, entries in ((slice(None, n), p_q), (slice(n, None), p_v)):
            blocks.add(first, x[:-1, at], entries[:, : n * ticks])
            blocks.add(first + n, x[1:, at], entries[:, n:])
        blocks.add(first, ends, a_q)
        blocks.add(first + n, ends, -b_q)
        self.add_controls(blocks, first)
        return blocks.matrix((2 * n * ticks, self.layout.size))

    def add_controls(self, blocks, first):
        """Adds the derivatives h/2 and −h/2 with respect to controls."""
        n = self.problem.coordinates
        held = np.repeat(self.layout.u, self.problem.ticks_per_node, axis=0)
        half = ca.MX.ones(1, self.layout.ticks) * (self.problem.tick / 2)
        for column, index in enumerate(self.problem.driven):
            rows, columns = first[:, [index]], held[:, [column]]
            blocks.add(rows, columns, half)
            blocks.add(rows + n, columns, -half)

    def hessian(self, weight, multipliers):
        """Upper triangle of the Hessian of weight · J + multipliersᵀ g."""
        n, ticks, x = self.problem.coordinates, self.layout.ticks, self.layout.x
        q, v = self.states()
        of_tick = ca.reshape(multipliers, 2 * n, ticks)
        before, after, none = of_tick[:n, :], of_tick[n:, :], ca.MX.zeros(n, 1)
        blocks, diagonal = Blocks(), np.arange(self.layout.size)[:, None]
        blocks.add(x, x, self.mapped("momentum_hessian", q, v, ca.horzcat(before, none) + ca.horzcat(none, after)))
        ends = np.hstack([x[:-1, :n], x[1:, :n]])
        blocks.add(ends, ends, self.mapped("halves_hessian", q[:, :-1], q[:, 1:], before, after))
        weights = self.layout.costs()[0]
        weighted = np.flatnonzero(weights)
        blocks.add(diagonal[weighted], diagonal[weighted], weight * ca.DM(weights[weighted]).T)
        return blocks.matrix((self.layout.size,) * 2, upper=True)

    def functions(self):
        """All functions of IPOPT's interface."""
        z, p, weight = self.z, ca.MX.sym("p", 0), ca.MX.sym("weight")
        f, g = self.cost(), self.constraints()
        multipliers = ca.MX.sym("multipliers", g.numel())
        given, hessian = ["x", "p"], self.hessian(weight, multipliers)
        return [
            ca.Function("nlp", [z, p], [f, g], given, ["f", "g"]),
            ca.Function("nlp_f", [z, p], [f], given, ["f"]),
            ca.Function("nlp_g", [z, p], [g], given, ["g"]),
            ca.Function("nlp_grad_f", [z, p], [f, self.gradient()], given, ["f", "grad_f_x"]),
            ca.Function("nlp_jac_g", [z, p], [g, self.jacobian()], given, ["g", "jac_g_x"]),
            ca.Function("nlp_hess_l", [z, p, weight, multipliers], [hessian], [*given, "lam_f", "lam_g"], ["triu_hess_gamma_x_x"]),
        ]

    def compile(self, folder, flags):
        """Generates C of all functions, compiles it, and returns the shared library."""
        source, library = folder / f"{self.problem.name}.c", folder / f"{self.problem.name}.so"
        generator = ca.CodeGenerator(source.name)
        for function in self.functions():
            generator.add(function)
        generator.generate(f"{folder}/")
        run(["gcc", *flags, "-shared", "-fPIC", source, "-o", library, "-lm"])
        return library
