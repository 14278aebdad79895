"""An environment with the interface of gymnasium, which need not be installed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ._errors import InputError, SolveError
from ._model import Model, Motion

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[Any]


class Box:
    """Numbers between bounds: a stand-in for `gymnasium.spaces.Box` if gymnasium is not installed."""

    def __init__(self, low: Array, high: Array, dtype: Any = np.float32) -> None:
        self.low, self.high = np.asarray(low, dtype), np.asarray(high, dtype)
        self.shape, self.dtype = self.low.shape, np.dtype(dtype)
        self._random = np.random.default_rng()

    def seed(self, seed: int | None = None) -> None:
        """Seeds the samples."""
        self._random = np.random.default_rng(seed)

    def sample(self) -> Array:
        """Draws a sample: uniform between the bounds, standard normal where a bound is infinite."""
        bounded = np.isfinite(self.low) & np.isfinite(self.high)
        low, high = np.where(bounded, self.low, 0.0), np.where(bounded, self.high, 1.0)
        return np.where(bounded, self._random.uniform(low, high), self._random.normal(size=self.shape)).astype(self.dtype)

    def contains(self, x: Any) -> bool:
        """Whether x has the shape and lies between the bounds."""
        x = np.asarray(x)
        return x.shape == self.shape and bool(np.all((self.low <= x) & (x <= self.high)))

    def __repr__(self) -> str:
        return f"Box({self.low}, {self.high}, {self.shape}, {self.dtype})"


class Environment:
    """A learned mechanism to act on: `reset` and `step` of gymnasium, computed by the discrete steps of the chip, bit for bit.

    model      a Model with or without friction; it is stepped in single precision
    actuated   coordinates that an action drives; by default all
    max_u      largest force on each actuated coordinate, N or N m; by default the range of the training data; no bound if that is unknown
    start      initial state (q, v), or a function that draws one from a numpy Generator; by default rest at q = 0
    reward     function reward(q, v, u) of the new state and the force
    done       function done(q, v) that says whether the task has ended
    max_steps  number of steps after which an episode is truncated; None: never
    h, order   step size (s) and order of the integrator; by default those of training
    commands   whether an action is the command to the drives, which the file's gain, offset, delay and lag turn into forces

    Observations are (q, v), 2n numbers: m or rad, m/s or rad/s. An action has one force for each actuated coordinate; it is clipped to
    the bounds and held over a step. Before an episode, all commands were 0.
    """

    metadata: dict[str, Any] = {"render_modes": []}
    render_mode = None

    def __init__(
        self,
        model: Model,
        *,
        actuated: Sequence[int] | None = None,
        max_u: ArrayLike | None = None,
        start: tuple[ArrayLike, ArrayLike] | Callable[[np.random.Generator], tuple[ArrayLike, ArrayLike]] | None = None,
        reward: Callable[[Array, Array, Array], float] | None = None,
        done: Callable[[Array, Array], bool] | None = None,
        max_steps: int | None = 500,
        h: float | None = None,
        order: int | None = None,
        commands: bool = False,
    ) -> None:
        self.model = model.single
        self.h, self.order = self.model._step(h, order)
        self._actuated = np.arange(model.n) if actuated is None else np.asarray(actuated, int)
        if len(self._actuated) and not (0 <= self._actuated.min() and self._actuated.max() < model.n):
            raise InputError(f"actuated={actuated!r}: the model has the coordinates 0 to {model.n - 1}")
        self._start, self._reward, self._done, self._max_steps = start, reward, done, max_steps
        bound = np.asarray(self._bounds(max_u), np.float32)
        if bound.shape not in ((), self._actuated.shape) or not (bound > 0.0).all():
            count = len(self._actuated)
            raise InputError(f"the largest force is {max_u!r}; it must be positive, one number or one for each of {count} coordinates")
        bound = np.broadcast_to(bound, self._actuated.shape)
        self.action_space = _box(-bound, bound)
        wide = np.full(2 * model.n, np.inf, np.float32)
        self.observation_space = _box(-wide, wide)
        self._random = np.random.default_rng()
        self._motion: Motion | None = None
        drives = self.model.actuator if commands else None
        # Single precision resolves nothing of commands older than 20 time constants of a lag.
        late = drives["delay"] + 20.0 * drives["lag"] if drives else 0.0
        self._commands = commands
        # A delay's last part of a step needs the command before it.
        self._past = np.zeros((int(np.ceil(late / self.h)) + 2, model.n), np.float32)
        self._count = 0

    @property
    def unwrapped(self) -> Environment:
        """This environment itself: it wraps no other."""
        return self

    def _bounds(self, max_u: ArrayLike | None) -> Array:
        if max_u is not None:
            return np.asarray(max_u, float)
        covered = self.model.range
        if covered is None:
            return np.asarray(np.inf)
        most = np.abs(covered["u"]).max(axis=1)[self._actuated]
        return np.where(most > 0.0, most, np.inf)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Array, dict[str, Any]]:
        """Begins an episode and returns observation and info; `options` may contain the initial q and v."""
        if seed is not None:
            self._random = np.random.default_rng(seed)
        zero = np.zeros(self.model.n)
        start = self._start(self._random) if callable(self._start) else self._start or (zero, zero)
        q, v = ((options or {}).get(name, x) for name, x in zip("qv", start))
        self._motion, self._count = self.model.motion(q, v, h=self.h, order=self.order), 0
        self._past[:] = 0.0
        return self._observed(), {}

    def step(self, action: ArrayLike) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """Advances by one step and returns observation, reward, terminated, truncated and info. A step that cannot be solved ends the
        episode, and info says so."""
        if self._motion is None:
            raise InputError("begin an episode with reset()")
        u = np.zeros(self.model.n, np.float32)
        u[self._actuated] = np.clip(self._checked(action), self.action_space.low, self.action_space.high)
        info: dict[str, Any] = {}
        try:
            start, end = self._forces(u)
            report = self._motion.step(start, u_end=end)
            info["newton_iterations"] = int(report.iterations)
        except SolveError as error:
            info["error"] = str(error)
        self._count += 1
        q, v = self._motion.q, self._motion.v
        reward = float(self._reward(q, v, u)) if self._reward else 0.0
        terminated = "error" in info or bool(self._done and self._done(q, v))
        truncated = self._max_steps is not None and self._count >= self._max_steps
        return self._observed(), reward, terminated, truncated, info

    def _checked(self, action: ArrayLike) -> Array:
        numbers = np.asarray(action, np.float32)
        if numbers.shape != self._actuated.shape or np.isnan(numbers).any():
            count = len(self._actuated)
            raise InputError(f"the action is {action!r}; it must have a number for each of {count} actuated coordinates")
        return numbers

    def _forces(self, u: Array) -> tuple[Array, Array]:
        """The forces at the start and the end of the step over which u is held."""
        if not self._commands:
            return u, u
        self._past[:-1] = self._past[1:]
        self._past[-1] = u
        start, end = self.model.forces(self._past, h=self.h)
        return start[-1], end[-1]

    def render(self) -> None:
        """Does nothing; plot the observations instead."""

    def close(self) -> None:
        """Does nothing: there is nothing to close."""

    def _observed(self) -> Array:
        assert self._motion is not None
        return np.concatenate([self._motion.q, self._motion.v])


def _box(low: Array, high: Array) -> Any:
    try:
        from gymnasium.spaces import Box as Known  # type: ignore[import-not-found,unused-ignore]
    except ImportError:
        return Box(low, high)
    return Known(low, high, dtype=np.float32)
