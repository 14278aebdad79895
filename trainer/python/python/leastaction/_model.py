"""A learned model, vectorised over leading axes."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple, Union

import numpy as np

from . import _leastaction as _core
from ._errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from ._observer import Observer
    from ._regulators import Linearization, LinearStep, RestRegulator

    Array = NDArray[Any]
    Control = Union[ArrayLike, Callable[[float, Array, Array], ArrayLike], None]


class Trajectory(NamedTuple):
    """Positions and velocities at every sample of one motion, or of motions side by side."""

    t: Array
    """Times, [steps + 1], s."""
    q: Array
    """Positions, […, steps + 1, n], m or rad."""
    v: Array
    """Velocities, […, steps + 1, n], m/s or rad/s."""


class StepReport(NamedTuple):
    """The cost and accuracy of a step, for every motion."""

    iterations: Array
    """Number of Newton updates, […]."""
    residual: Array
    """Largest remaining relative residual, […]."""


class AccelerationJacobians(NamedTuple):
    """Derivatives of accelerations a(q, v, u). Row i, column j is the derivative of number i by number j."""

    q: Array
    """∂a/∂q, […, n, n]."""
    v: Array
    """∂a/∂v, […, n, n]."""
    u: Array
    """∂a/∂u, […, n, n]."""


class StepJacobians(NamedTuple):
    """Derivatives of the state x′ = (q′, v′) after a step. Row i, column j is the derivative of number i by number j."""

    x: Array
    """∂x′/∂x, x being the state before the step, […, 2n, 2n]."""
    u: Array
    """∂x′/∂u, u being the force held over the step, […, 2n, n]."""


class Model:
    """A learned Lagrangian L = T − V with its forces: a model file in memory.

    q, v, u and a are arrays whose last axis has the model's n coordinates; the leading axes hold states side by side and broadcast as in
    numpy. u is the generalised force at the output of the actuator (N or N m), 0 by default.

    Everything is computed in single precision (float32), bit for bit by the code that runs on a microcontroller; `double` is the same
    model in double precision (float64). Neither the number of threads nor the grouping of states changes a bit. The interpreter's lock
    is released meanwhile; RAYON_NUM_THREADS limits the number of threads of a call.
    """

    def __init__(self, core: _core.Model, path: str | None = None, *, double: bool = False) -> None:
        self._core = core
        self._path = path
        self._double = double
        self._facts = core.facts()
        self._n: int = self._facts["n"]
        self._other: Model | None = None

    # Facts of the file.

    @property
    def family(self) -> str:
        """Family of the model: inertia-network, modular, graph, bodies or arm."""
        return self._facts["family"]

    @property
    def n(self) -> int:
        """Number of coordinates."""
        return self._n

    @property
    def coordinates(self) -> str:
        """One letter per coordinate: t translation (m), a angle (rad), c cyclic."""
        return self._facts["coordinates"]

    @property
    def units(self) -> list[str]:
        """The unit of every coordinate, m or rad; "m or rad" for one that is cyclic, of which the file does not say it."""
        return [{"t": "m", "a": "rad"}.get(letter, "m or rad") for letter in self.coordinates]

    @property
    def order(self) -> int | None:
        """Order of the step that the model was trained with, 2 or 4; None if it was trained without a step."""
        return self._facts["order"]

    @property
    def h(self) -> float | None:
        """Size of the step that the model was trained with, s; None if it was trained without a step."""
        return self._facts["h"]

    @property
    def control(self) -> str | None:
        """Behaviour of u between samples in training, held or linear; None if the model was trained without a step."""
        return self._facts["control"]

    @property
    def parameters(self) -> int:
        """Number of parameters in the weight block."""
        return self._facts["parameters"]

    @property
    def weights(self) -> NDArray[np.float64]:
        """The weight block, [parameters], as it is in the file."""
        return self._core.weights()

    @property
    def range(self) -> dict[str, NDArray[np.float64]] | None:
        """Range of the training data: minimum and maximum of q, v and u of every coordinate, [n, 2] each; None if the file does not
        give it."""
        covered = self._facts["range"]
        return covered and {name: np.array(ends, dtype=float) for name, ends in covered.items()}

    @property
    def actuator(self) -> dict[str, Any] | None:
        """gain [n], offset [n] (N or N m), delay and lag (s) between a command and its force; None if the command is the force."""
        actuator = self._facts["actuator"]
        return actuator and {
            "gain": np.array(actuator["gain"]),
            "offset": np.array(actuator["offset"]),
            "delay": actuator["delay"],
            "lag": actuator["lag"],
        }

    @property
    def parts(self) -> list[str]:
        """Names of all trees or graphs in the file; empty for other families."""
        return self._facts["parts"]

    @property
    def part(self) -> str | None:
        """Name of the selected tree or graph; None for other families."""
        return self._facts["part"]

    @property
    def provenance(self) -> str:
        """Origin of the model, as the file states it."""
        return self._facts["provenance"]

    @property
    def dtype(self) -> np.dtype[Any]:
        """Type of all results: float32, or float64 for `double`."""
        return np.dtype(np.float64 if self._double else np.float32)

    @property
    def double(self) -> Model:
        """This model in double precision, for studies and adaptive integrators: works for any size, but not with the chip's bits."""
        return self._in_precision(True)

    @property
    def single(self) -> Model:
        """This model in the chip's arithmetic."""
        return self._in_precision(False)

    def _in_precision(self, double: bool) -> Model:
        if self._double == double:
            return self
        if self._other is None:
            self._other = Model(self._core, self._path, double=double)
            self._other._other = self
        return self._other

    def __repr__(self) -> str:
        step = f", order {self.order}, h = {self.h} s" if self.h else ""
        part = f" {self.part!r}" if self.part else ""
        name = "leastaction.Model" + (".double" if self._double else "")
        return f"<{name}: {self.family}{part}, {self.n} coordinates {self.coordinates!r}, {self.parameters} numbers{step}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (self.to_bytes(), self.part, self._path, self._double)

    # Energies and continuous dynamics.

    def energies(self, q: ArrayLike, v: ArrayLike) -> tuple[Array, Array]:
        """Kinetic and potential energy T(q, v) and V(q), J, [...] each."""
        found = self._of_states("energies", [q, v], (2,), "nan")
        return found[..., 0], found[..., 1]

    def acceleration(self, q: ArrayLike, v: ArrayLike, u: ArrayLike | None = None, *, errors: str = "raise") -> Array:
        """v̇ = M⁻¹(L_q − L_vq v + Q + u), m/s² or rad/s², [..., n]; for particles on rods, the constrained acceleration.

        `errors="nan"` gives NaN if it does not exist, instead of raising SolveError.
        """
        return self._of_states("acceleration", [q, v, self._or_zero(u)], (self._n,), errors)

    def inverse_dynamics(self, q: ArrayLike, v: ArrayLike, a: ArrayLike, *, errors: str = "raise") -> Array:
        """The force u that gives the acceleration a (m/s² or rad/s²), N or N m, [..., n]."""
        return self._of_states("inverse_dynamics", [q, v, a], (self._n,), errors)

    def mass_matrix(self, q: ArrayLike) -> Array:
        """M(q) = L_vv at rest, symmetric, [..., n, n]; kg, kg m or kg m²."""
        return self._of_states("mass_matrix", [q], (self._n, self._n), "nan")

    # Steps.

    def step(
        self,
        q: ArrayLike,
        v: ArrayLike,
        u: ArrayLike | None = None,
        *,
        u_end: ArrayLike | None = None,
        h: float | None = None,
        order: int | None = None,
        errors: str = "raise",
    ) -> tuple[Array, Array]:
        """Position and velocity after one step of the discrete Euler–Lagrange equation, [..., n] each.

        u [..., n] is held over the step or, with u_end, goes linearly from u to u_end. h (s) and order (2 or 4) are by
        default those of training. For many consecutive steps `rollout` and `motion` are more accurate: they keep
        the momentum and the rounding remainders.
        """
        u = self._or_zero(u)
        start = self._as_array("u", u)[..., None, :]
        end = start if u_end is None else self._as_array("u_end", u_end)[..., None, :]
        _, q_all, v_all = self._fly((q, v), (start, end), 1, False, h, order, errors)
        return q_all[..., 1, :], v_all[..., 1, :]

    def step_from_positions(
        self,
        q0: ArrayLike,
        q1: ArrayLike,
        u: ArrayLike | None = None,
        *,
        h: float | None = None,
        order: int | None = None,
        errors: str = "raise",
    ) -> Array:
        """The position one step after two positions that are one step apart, [..., n]: no velocity is needed.

        u is [..., 2, n], first between q0 and q1, then after q1; or [n] for both.
        """
        forces = self._as_array("u", self._or_zero(u))
        forces = np.broadcast_to(forces, (2, self._n)) if forces.ndim == 1 else forces
        _, q_all, _ = self._fly((q0, q1), (forces, forces), 2, True, h, order, errors)
        return q_all[..., 2, :]

    def rollout(
        self,
        q: ArrayLike,
        v: ArrayLike | None = None,
        u: ArrayLike | None = None,
        *,
        q1: ArrayLike | None = None,
        steps: int | None = None,
        h: float | None = None,
        order: int | None = None,
        control: str = "held",
        commands: bool = False,
        errors: str = "raise",
    ) -> Trajectory:
        """Motions by the discrete Euler–Lagrange equation from a position and a velocity, or (q1) from two positions one step apart.

        q, v (or q1): [..., n]. If `control` is "held", u has the shape [..., steps, n] and row k acts from sample k to k + 1; if it is
        "linear", u has steps + 1 rows, one per sample. Without u, `steps` is needed. With `commands`, u holds the commands to the drives,
        which the file's gain, offset, delay and lag turn into forces. h (s) and order (2 or 4) are by default those of training.

        `errors="nan"` gives NaN from the first step that cannot be solved, instead of raising SolveError. If a motion starts from two
        positions, its velocity at the first is NaN.
        """
        second = v if q1 is None else q1
        if second is None or (v is not None and q1 is not None):
            raise InputError("a rollout begins with q and v, or with q and q1: give one of them")
        h, order = self._step(h, order)
        start, end, steps = self._controls(u, steps, control, commands, h)
        return self._fly((q, second), (start, end), steps, q1 is not None, h, order, errors)

    def motion(
        self, q: ArrayLike, v: ArrayLike, *, h: float | None = None, order: int | None = None
    ) -> Motion:
        """Begins motions side by side from q and v, [..., n], to be stepped one step at a time, as firmware does."""
        return Motion(self, (q, v), None, False, h, order)

    def motion_from_positions(
        self,
        q0: ArrayLike,
        q1: ArrayLike,
        u: ArrayLike | None = None,
        *,
        h: float | None = None,
        order: int | None = None,
    ) -> Motion:
        """Like `motion`, from two positions one step apart, [..., n], and the force between them; the motion begins at q1."""
        return Motion(self, (q0, q1), u, True, h, order)

    def forces(self, commands: ArrayLike, *, h: float | None = None, control: str = "held") -> tuple[Array, Array]:
        """The forces at the start and the end of each step, by the file's gain, offset, delay and lag, N or N m: the steps begin at the
        samples of `commands`, [samples, n]. The first command is assumed to have been in effect before."""
        h, _ = self._step(h, 2)
        rows = _rows(np.asarray(commands, self.dtype), self._n, "commands")
        forces = self._core.forces_double if self._double else self._core.forces
        return forces(rows, h, _is_linear(control))

    def inside(self, q: ArrayLike, v: ArrayLike | None = None, u: ArrayLike | None = None) -> Array:
        """Whether a state lies in the range of the training data, [...]; always true if the file does not give a range."""
        middle = self._facts["range"]
        if not middle:
            return np.ones(np.shape(q)[:-1], bool)
        inner = {name: np.array([0.5 * (a + b) for a, b in ends], np.float32) for name, ends in middle.items()}
        arrays = [np.asarray(x if x is not None else inner[name], np.float32) for name, x in zip("qvu", (q, v, u))]
        lead, rows = _side_by_side(arrays, self._n, "qvu")
        return (self._core.outside(*rows) < 0).reshape(lead)

    def observer(self, **settings: Any) -> Observer:
        """The observer of the firmware: estimates the state from encoder readings alone; see `leastaction.Observer`."""
        from ._observer import Observer

        return Observer(self, **settings)

    # Linear approximations and regulators.

    def acceleration_jacobians(
        self, q: ArrayLike, v: ArrayLike, u: ArrayLike | None = None, *, errors: str = "raise"
    ) -> AccelerationJacobians:
        """Exact derivatives of the acceleration under the force u, […, n, n] each, for any size without rods, in double precision.
        Where they do not exist, SolveError is raised, or with errors="nan" they are NaN."""
        n, found = self._n, self._jacobians((q, v, u), None, errors)
        return AccelerationJacobians(found[..., :n], found[..., n : 2 * n], found[..., 2 * n :])

    def step_jacobians(
        self,
        q: ArrayLike,
        v: ArrayLike,
        u: ArrayLike | None = None,
        *,
        h: float | None = None,
        order: int | None = None,
        errors: str = "raise",
    ) -> StepJacobians:
        """Exact derivatives of `double.step` from (q, v) under the held force u, for any size without rods, in double precision. h (s)
        and order are by default those of training; errors as for `acceleration_jacobians`."""
        found = self._jacobians((q, v, u), self._step(h, order), errors)
        return StepJacobians(found[..., : 2 * self._n], found[..., 2 * self._n :])

    def _jacobians(
        self, state: tuple[ArrayLike, ArrayLike, ArrayLike | None], step: tuple[float, int] | None, errors: str
    ) -> Array:
        q, v, u = state
        arrays = [np.asarray(x, np.float64) for x in (q, v, self._or_zero(u))]
        lead, rows = _side_by_side(arrays, self._n, "qvu")
        found = _core.jacobians(self._core, rows, step, _gives_nan(errors))
        return found.reshape(lead + found.shape[1:])

    def linearize(self, q: ArrayLike, v: ArrayLike, u: ArrayLike | None = None) -> Linearization:
        """Derivatives of acceleration and inverse dynamics at a single state, q, v and u [n], in double precision. u is the command
        (gain and offset of the drives included, without delay and lag). SolveError where they do not exist."""
        from ._regulators import linearize

        return linearize(self, q, v, u)

    def linearize_step(
        self,
        q: ArrayLike,
        v: ArrayLike,
        u: ArrayLike | None = None,
        *,
        h: float | None = None,
        order: int | None = None,
        ticks: int = 1,
    ) -> LinearStep:
        """A and B of x = (q, v) over `ticks` steps of the chip's arithmetic, from a single state under a held command u [n] (gain and
        offset of the drives included, without delay and lag). h (s) and order are by default those of training."""
        from ._regulators import linearize_step

        return linearize_step(self, (q, v, u), self._step(h, order), ticks)

    def lqr(
        self,
        q: ArrayLike,
        Q: ArrayLike,
        R: ArrayLike,
        *,
        driven: Sequence[int] | None = None,
        delay: float | None = None,
        h: float | None = None,
        order: int | None = None,
        ticks: int = 1,
    ) -> RestRegulator:
        """The regulator that holds the model at rest at q [n], a command every `ticks` steps: `regulator.command(q, v, past)`.

        Q, R    weights of (q, v) and of the commands, as in `leastaction.lqr`; [2n] and [driven] are diagonals.
        driven  coordinates that commands act on; by default all. The others must be at rest by themselves.
        delay   time until a command acts, s; by default that of the model's drives. Commands already sent are then states.
                A lag is that of the model's drives; the commands as they act behind it are states too.
        """
        from ._regulators import regulate

        return regulate(self, q, (Q, R), self._step(h, order), ticks, delay, driven)

    # Other programs.

    def scipy_rhs(self, u: Control = None) -> Callable[[float, Array], Array]:
        """The function f(t, y) of ẏ = f(t, y), y = (q, v), for `scipy.integrate.solve_ivp` and the like, in double precision.

        u is None, an array [n], or a function u(t, q, v) that returns one. y may be [2n], or [2n, k] with vectorized=True.
        """
        model, n = self.double, self._n

        def rhs(t: float, y: Array) -> Array:
            q, v = np.moveaxis(y[:n], 0, -1), np.moveaxis(y[n:], 0, -1)
            force = u(t, q, v) if callable(u) else u
            a = model.acceleration(q, v, force, errors="nan")
            return np.concatenate([y[n:], np.moveaxis(a, -1, 0)])

        return rhs

    def to_bytes(self) -> bytes:
        """The bytes of the model file."""
        return self._core.to_bytes()

    def save(self, path: str | os.PathLike[str], *, half: bool = False) -> None:
        """Writes the model file, m.postcard; with `half`, weights take two bytes each. A file of another kind is never overwritten."""
        _core.write_file(os.fspath(path), self._core.encoded(half), "model")

    def save_rust(self, path: str | os.PathLike[str]) -> None:
        """Writes a Rust module that holds the file as a constant and needs only `leastaction-core`."""
        _core.write_file(os.fspath(path), self._core.rust_source().encode(), "rust")

    def save_c(self, path: str | os.PathLike[str], name: str = "leastaction_model_file") -> None:
        """Writes a C header that holds the file as a constant of this name, for `leastaction_load` of the C library."""
        _core.write_file(os.fspath(path), self._core.c_source(name).encode(), "c")

    # Shapes.

    def _or_zero(self, u: ArrayLike | None) -> ArrayLike:
        return np.zeros(self._n, self.dtype) if u is None else u

    def _as_array(self, name: str, x: ArrayLike) -> Array:
        array = np.asarray(x, self.dtype)
        if array.ndim == 0 or array.shape[-1] != self._n:
            raise InputError(f"{name} has the shape {array.shape}; its last axis must be {self._n}, one number a coordinate")
        return array

    def _of_states(self, name: str, arrays: list[ArrayLike], tail: tuple[int, ...], errors: str) -> Array:
        names = "qva" if name == "inverse_dynamics" else "qvu"
        lead, rows = _side_by_side([np.asarray(x, self.dtype) for x in arrays], self._n, names)
        of = self._core.double if self._double else self._core.single
        return of(name, rows, _gives_nan(errors)).reshape(lead + tail)

    def _step(self, h: float | None, order: int | None) -> tuple[float, int]:
        h = self.h if h is None else h
        if h is None:
            raise InputError("the model was trained without a step: give h, s")
        return float(h), int(order or self.order or 4)

    def _controls(
        self, u: ArrayLike | None, steps: int | None, control: str, commands: bool, h: float
    ) -> tuple[Array, Array, int]:
        linear = _is_linear(control)
        if u is None:
            if steps is None:
                raise InputError("say how many steps, where there is no u")
            none = np.zeros((steps, self._n), self.dtype)
            return none, none, steps
        rows = self._as_array("u", u)
        if rows.ndim < 2:
            raise InputError(f"u has the shape {rows.shape}; its last axes must be [steps, {self._n}]")
        count = rows.shape[-2] - 1 if linear else rows.shape[-2]
        steps = count if steps is None else steps
        if not 0 <= steps <= count:
            raise InputError(f"u has rows for {count} steps, {steps} are asked for")
        if commands:
            flat = rows.reshape((-1,) + rows.shape[-2:])
            pairs = [self.forces(one, h=h, control=control) for one in flat]
            start, end = (np.stack(part).reshape(rows.shape) for part in zip(*pairs))
        else:
            start, end = rows, rows[..., 1:, :] if linear else rows
        return start[..., :steps, :], end[..., :steps, :], steps

    def _fly(
        self,
        start: tuple[ArrayLike, ArrayLike],
        tau: tuple[Array, Array],
        steps: int,
        positions: bool,
        h: float | None,
        order: int | None,
        errors: str,
    ) -> Trajectory:
        n = self._n
        h, order = self._step(h, order)
        names = ("q0", "q1") if positions else ("q", "v")
        states = [self._as_array(name, x) for name, x in zip(names, start)]
        leads = [x.shape[:-1] for x in states] + [x.shape[:-2] for x in tau]
        lead = _broadcast(leads)
        first, second = (_flat(x, lead, (n,)) for x in states)
        before, after = (_flat(x, lead, (steps, n)) for x in tau)
        fly = self._core.rollout_double if self._double else self._core.rollout
        found = fly((first, second), (before, after), steps, positions, (h, order), _gives_nan(errors))
        found = found.reshape(lead + (steps + 1, 2 * n))
        q, v = found[..., :n], found[..., n:]
        if self._double:
            v = self._velocities(q, v)
        return Trajectory(h * np.arange(steps + 1), q, v)

    def _velocities(self, q: Array, p: Array) -> Array:
        """Solves p = M v for v; NaN where q or p is not finite."""
        known = np.isfinite(q).all(-1) & np.isfinite(p).all(-1)
        v = np.full_like(p, np.nan)
        if known.any():
            v[known] = np.linalg.solve(self.mass_matrix(q[known]), p[known][..., None])[..., 0]
        return v


class Motion:
    """Motions side by side in the chip's arithmetic, step by step: q with its rounding remainder and p, as firmware keeps them."""

    def __init__(
        self,
        model: Model,
        start: tuple[ArrayLike, ArrayLike],
        u: ArrayLike | None,
        positions: bool,
        h: float | None,
        order: int | None,
    ) -> None:
        self._model = model.single
        self.h, self.order = self._model._step(h, order)
        n, force = model.n, self._model._as_array("u", self._model._or_zero(u))
        states = [self._model._as_array(name, x) for name, x in zip(("q0", "q1") if positions else ("q", "v"), start)]
        self._lead = _broadcast([x.shape[:-1] for x in (*states, force)])
        first, second = (np.broadcast_to(x, self._lead + (n,)).reshape(-1, n) for x in states)
        force = _flat(force, self._lead, (n,))
        self._core = self._model._core.motions((first, second), (force, force), positions, (self.h, self.order))
        self._steps = 0

    @property
    def t(self) -> float:
        """Time since the beginning, s."""
        return self._steps * self.h

    @property
    def q(self) -> Array:
        """Positions, [..., n], m or rad."""
        return self._core.q().reshape(self._lead + (self._model.n,))

    @property
    def v(self) -> Array:
        """Velocities that correspond to the momenta, [..., n], m/s or rad/s."""
        return self._core.v().reshape(self._lead + (self._model.n,))

    @property
    def p(self) -> Array:
        """Generalised momenta L_v, [..., n]."""
        return self._core.p().reshape(self._lead + (self._model.n,))

    def step(self, u: ArrayLike | None = None, *, u_end: ArrayLike | None = None) -> StepReport:
        """Advances by one step under the force u [..., n] (N or N m), or a force that goes linearly from u to u_end.

        If a motion cannot be stepped, SolveError is raised: that motion and those after it are left unchanged, those before it have
        been stepped.
        """
        model = self._model
        start = _flat(model._as_array("u", model._or_zero(u)), self._lead, (model.n,))
        end = start if u_end is None else _flat(model._as_array("u_end", u_end), self._lead, (model.n,))
        iterations, residual = self._core.step(start, end)
        self._steps += 1
        return StepReport(iterations.reshape(self._lead), residual.reshape(self._lead))


def load(path: str | os.PathLike[str], part: str | None = None) -> Model:
    """Reads a model file; `part` names one of several trees or graphs, by default the first."""
    return Model(_core.Model.load(os.fspath(path), part), os.fspath(path))


def from_bytes(data: bytes, part: str | None = None) -> Model:
    """Reads a model from the bytes of a model file."""
    return Model(_core.Model.from_bytes(bytes(data), part))


def from_description(path: str | os.PathLike[str]) -> Model:
    """Reads a robot description, URDF (.urdf, .xacro) or MuJoCo's MJCF (.xml, .mjcf), whose masses and inertias are all known, as an
    exact model. Coordinates are in the order of the description's joints; friction is not part of it. Remarks are warnings."""
    core, _, notes = _core.model_of_description(os.fspath(path))
    for note in notes:
        warnings.warn(note, stacklevel=2)
    return Model(core)


def _restored(data: bytes, part: str | None, path: str | None, double: bool) -> Model:
    return Model(_core.Model.from_bytes(data, part), path, double=double)


def _gives_nan(errors: str) -> bool:
    if errors not in ("raise", "nan"):
        raise InputError(f'errors={errors!r}: it must be "raise" or "nan"')
    return errors == "nan"


def _is_linear(control: str) -> bool:
    if control not in ("held", "linear"):
        raise InputError(f'control={control!r}: it must be "held" or "linear"')
    return control == "linear"


def _broadcast(leads: list[tuple[int, ...]]) -> tuple[int, ...]:
    try:
        return np.broadcast_shapes(*leads)
    except ValueError:
        raise InputError(f"the axes before the last ones do not fit each other: {leads}") from None


def _flat(x: Array, lead: tuple[int, ...], tail: tuple[int, ...]) -> Array:
    """Flattens the leading axes to one; a single row is used for all."""
    if x.size == np.prod(tail, dtype=int):
        return x.reshape((1,) + tail)
    return np.broadcast_to(x, lead + tail).reshape((-1,) + tail)


def _rows(x: Array, n: int, name: str) -> Array:
    if x.ndim == 0 or x.shape[-1] != n:
        raise InputError(f"{name} has the shape {x.shape}; its last axis must be {n}, one number a coordinate")
    return x.reshape(-1, n)


def _side_by_side(arrays: list[Array], n: int, names: str) -> tuple[tuple[int, ...], list[Array]]:
    for name, x in zip(names, arrays):
        if x.ndim == 0 or x.shape[-1] != n:
            raise InputError(f"{name} has the shape {x.shape}; its last axis must be {n}, one number a coordinate")
    lead = arrays[0].shape[:-1]
    if any(x.shape[:-1] != lead for x in arrays):
        lead = _broadcast([x.shape[:-1] for x in arrays])
    return lead, [_flat(x, lead, (n,)) for x in arrays]
