"""Linear approximations of a model, and linear regulators."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple, Optional, cast

import numpy as np

from . import _leastaction as _core
from ._errors import InputError, SolveError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from ._model import Model

    Array = NDArray[np.float64]

UNHELD = 1e-3
"""Largest force on an undriven coordinate at rest, relative to the largest force or 1."""


@dataclass(frozen=True)
class Linearization:
    """Derivatives of accelerations and of inverse dynamics at a state, in double precision.

    u is the command: τ = gain · u + offset, without delay and lag. Row i, column j is the derivative of number i by number j. Units are those of
    the quotients: m or rad, s, and the commands' own.
    """

    acceleration: Array
    """v̇(q, v, u), [n], m/s² or rad/s²."""
    acceleration_q: Array
    """∂v̇/∂q, [n, n]."""
    acceleration_v: Array
    """∂v̇/∂v, [n, n]."""
    acceleration_u: Array
    """∂v̇/∂u, [n, n]."""
    control_q: Array
    """∂u/∂q of inverse dynamics u(q, v, a), [n, n]."""
    control_v: Array
    """∂u/∂v of inverse dynamics, [n, n]."""
    control_a: Array
    """∂u/∂a of inverse dynamics, [n, n]."""

    @property
    def A(self) -> Array:
        """∂ẋ/∂x of x = (q, v), [2n, 2n]."""
        n = len(self.acceleration)
        return np.block([[np.zeros((n, n)), np.eye(n)], [self.acceleration_q, self.acceleration_v]])

    @property
    def B(self) -> Array:
        """∂ẋ/∂u of x = (q, v), [2n, n]."""
        return np.vstack([np.zeros_like(self.acceleration_u), self.acceleration_u])


class LinearStep(NamedTuple):
    """A linear step x⁺ = A x + B u of x = (q, v), as deviations."""

    A: Array
    """[2n, 2n]."""
    B: Array
    """[2n, n]."""


class Regulator(NamedTuple):
    """A linear regulator u = −K x, in the order of python-control's `dlqr`."""

    K: Array
    """Gain, [m, states]."""
    P: Array
    """Cost xᵀPx that remains, [states, states]."""
    E: NDArray[np.complex128]
    """Eigenvalues of the closed loop A − BK, [states]."""


def lqr(A: ArrayLike, B: ArrayLike, Q: ArrayLike, R: ArrayLike, *, delay: float = 0.0, lag: float = 0.0) -> Regulator:
    """The regulator u = −K x of x⁺ = A x + B u that minimises Σ xᵀQx + uᵀRu, in discrete time: K, P, E as by python-control's `dlqr`.

    A      [n, n].
    B      [n, m].
    Q, R   symmetric weights [n, n] and [m, m], Q ≥ 0 and R > 0; or their diagonals, [n] and [m].
    delay  time until a command acts, in steps, any number from 0 to 256. The commands already sent are then states: K and P are of
           (x, u one step ago, u two steps ago, …), with as many past commands as the delay has steps, a part of one counted as one.
           With a delay of 1.3 steps the command of two steps ago acts for the first 0.3 of a step, that of one step ago for the rest.
    lag    time constant T of a drive that answers gradually, in steps: T ẏ = u − y, behind the delay. y of every command is then a
           state: K and P are of (x, y, past commands).

    SolveError: no feedback stabilises the system, or Q does not see a motion that does not die out.
    """
    a, b = _matrix("A", A), _matrix("B", B)
    gain, cost, closed = _core.regulator((a, b), (_weights("Q", Q), _weights("R", R)), float(delay), float(lag))
    return Regulator(gain, cost, np.linalg.eigvals(closed).astype(complex))


@dataclass(frozen=True)
class RestRegulator:
    """A regulator that holds a model at rest: u = ū − K (x − x̄), x = (q, v), then the commands as they act behind a lag, if there is one,
    and then the commands already sent, the latest first."""

    K: Array
    """Gain, [driven, 2n + driven · past], and with a lag [driven, 2n + driven · (1 + past)]."""
    P: Array
    """Cost δᵀPδ that remains, δ being the deviation of the state with the past commands."""
    E: NDArray[np.complex128]
    """Eigenvalues of the closed loop."""
    q: Array
    """Position of rest, [n], m or rad."""
    u: Array
    """Command that holds it, [driven]."""
    driven: tuple[int, ...]
    """Coordinates that commands act on."""
    h: float
    """Time between commands, s."""
    delay: float
    """Time until a command acts, s."""
    turns: tuple[bool, ...]
    """Flags of the coordinates that are angles, whose deviations are taken the short way round."""
    lag: float = 0.0
    """Time constant of the drives' lag, s; 0: none."""

    @property
    def past(self) -> int:
        """Number of past commands that are states."""
        return (self.K.shape[1] - 2 * len(self.q)) // len(self.driven) - (self.lag > 0.0)

    def command(self, q: ArrayLike, v: ArrayLike, past: ArrayLike | None = None) -> Array:
        """The command at a state, [driven]. `past` are the commands already sent, the latest first, [past or more, driven]; by default
        those that hold the rest. With a lag, give as many as there are: the force depends on all of them, and those before are taken to
        be those that hold the rest."""
        dq = np.asarray(q, float) - self.q
        dq = np.where(self.turns, np.remainder(dq + np.pi, 2 * np.pi) - np.pi, dq)
        sent = np.tile(self.u, (self.past, 1)) if past is None else np.asarray(past, float).reshape(-1, len(self.driven))
        if len(sent) < self.past:
            raise InputError(f"past has {len(sent)} commands; the delay needs the last {self.past}")
        late = (sent[: self.past] - self.u).ravel()
        acting = self._acting(sent) - self.u if self.lag > 0.0 else np.empty(0)
        return cast("Array", self.u - self.K @ np.concatenate([dq, np.asarray(v, float), acting, late]))

    def _acting(self, sent: Array) -> Array:
        """The commands as they act behind the lag, after all that were sent, the latest first."""
        steps = self.delay / self.h
        whole = int(steps + 1e-6)
        part = max(steps - whole, 0.0) * self.h
        early, late = np.exp(-part / self.lag), np.exp((part - self.h) / self.lag)
        y = before = self.u
        for u in sent[whole:][::-1]:
            y = before + (y - before) * early
            y, before = u + (y - u) * late, u
        return cast("Array", y)


def linearize(model: Model, q: ArrayLike, v: ArrayLike, u: ArrayLike | None) -> Linearization:
    """See `Model.linearize`."""
    found = _core.linearize(model._core, *_state(model, q, v, u))
    if found is None:
        raise SolveError("the derivatives do not exist here: the inertia is singular, a number is not finite, or the model has rods")
    acceleration, *others = found
    return Linearization(acceleration[0], *others)


def linearize_step(
    model: Model, at: tuple[ArrayLike, ArrayLike, Optional[ArrayLike]], step: tuple[float, int], ticks: int
) -> LinearStep:
    """See `Model.linearize_step`."""
    if not 1 <= ticks <= 65535:
        raise InputError(f"ticks is {ticks}; it must be between 1 and 65535")
    return LinearStep(*_core.linearize_step(model._core, _state(model, *at), step, ticks))


def regulate(
    model: Model,
    q: ArrayLike,
    weights: tuple[ArrayLike, ArrayLike],
    step: tuple[float, int],
    ticks: int,
    delay: float | None,
    driven: Sequence[int] | None,
) -> RestRegulator:
    """See `Model.lqr`."""
    chosen = _driven(driven, model.n)
    rest, v, _ = _state(model, q, np.zeros(model.n), None)
    u = _holding(model, rest, chosen)
    a, b = linearize_step(model, (rest, v, u), step, ticks)
    h = step[0] * ticks
    if delay is None:
        delay = model.actuator["delay"] if model.actuator else 0.0
    lag = model.actuator["lag"] if model.actuator else 0.0
    found = lqr(a, b[:, chosen], *weights, delay=delay / h, lag=lag / h)
    turns = tuple(letter == "a" for letter in model.coordinates)
    return RestRegulator(*found, rest, u[list(chosen)], chosen, h, float(delay), turns, lag)


def _driven(driven: Sequence[int] | None, n: int) -> tuple[int, ...]:
    chosen = tuple(range(n)) if driven is None else tuple(int(i) for i in driven)
    if not chosen or len(set(chosen)) < len(chosen) or not all(0 <= i < n for i in chosen):
        raise InputError(f"driven is {driven}; it must name different coordinates between 0 and {n - 1}, at least one")
    return chosen


def _holding(model: Model, q: Array, driven: tuple[int, ...]) -> Array:
    """The command that holds q at rest, [n]; 0 for coordinates that are not driven."""
    none = np.zeros(model.n)
    actuator = model.actuator or {"gain": np.ones(model.n), "offset": none}
    force = model.double.inverse_dynamics(q, none, none) - actuator["offset"]
    for i in set(range(model.n)) - set(driven):
        if abs(force[i]) > UNHELD * max(1.0, np.abs(force).max()):
            raise InputError(f"q is not a rest: coordinate {i}, which is not driven, needs a force of {force[i]:.3g}")
    return np.where([i in driven for i in range(model.n)], force / actuator["gain"], 0.0)


def _state(model: Model, q: ArrayLike, v: ArrayLike, u: ArrayLike | None) -> tuple[Array, Array, Array]:
    arrays = [np.asarray(x if x is not None else np.zeros(model.n), np.float64) for x in (q, v, u)]
    for name, x in zip("qvu", arrays):
        if x.shape != (model.n,):
            raise InputError(f"{name} has the shape {x.shape}; it must be [{model.n}], a single state")
    return arrays[0], arrays[1], arrays[2]


def _matrix(name: str, x: ArrayLike) -> Array:
    array = np.asarray(x, np.float64)
    if array.ndim != 2 or array.size == 0:
        raise InputError(f"{name} has the shape {array.shape}; it must be a matrix")
    return array


def _weights(name: str, x: ArrayLike) -> Array:
    array = np.atleast_1d(np.asarray(x, np.float64))
    return _matrix(name, np.diag(array) if array.ndim == 1 else array)


__all__: list[Any] = ["LinearStep", "Linearization", "Regulator", "RestRegulator", "lqr"]
