"""An environment of gymnasium, of any model file.

    import leastaction as la
    from leastaction.gymnasium import Env

    env = Env(la.load("m.postcard"), goal=[0.0, 0.0], limits=[5.0], driven=[0])
    observation, info = env.reset(seed=1)
    observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

try:
    import gymnasium  # type: ignore[import-not-found,unused-ignore]
except ImportError:
    raise ImportError("leastaction.gymnasium needs gymnasium: pip install gymnasium") from None

from ._environment import Environment
from ._errors import InputError
from ._model import Model

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[Any]

SPREAD = 0.05
"""Largest deviation of a start from rest at q = 0, in every number of q and v, by default."""

COLUMN = 120
"""Width of the picture of a coordinate, in pixels."""


class Env(gymnasium.Env):  # type: ignore[misc,unused-ignore]
    """A model to act on, stepped by its discrete Euler–Lagrange equation with the bits of the chip.

    model        a Model; it is stepped in single precision
    driven       coordinates that a command drives; by default those that were driven in the training data, or all if that is unknown
    limits       largest command of each driven coordinate; by default the largest of the training data, and needed if that is unknown
    goal         posture q*, [n]; by default 0
    start        initial state (q, v), or a function that draws one from a numpy Generator; by default each number is drawn within 0.05
                 (m, rad, m/s or rad/s) of rest at q = 0
    reward       function reward(q, v, u) of the new state and the command, [n] each; by default −distance(q)
    terminated   function terminated(q, v) that says whether the task has ended; by default never
    max_steps    number of steps after which an episode is truncated; None: never
    h, order     step size (s) and order of the integrator; by default those of training
    render_mode  "svg": `render` returns a picture of the coordinates as text; None: none

    An observation is (q, v), 2n numbers: m or rad, m/s or rad/s. An action is a command of each driven coordinate; it is clipped to the
    limits, held over a step, and turned into forces by gain, offset, delay and lag of the model's drives. `info` has `inside`, whether the
    state lies in the range of the training data, and `distance`. A step that cannot be solved truncates the episode, with its reason in
    `info["error"]`: the state before it is observed again.
    """

    metadata: dict[str, Any] = {"render_modes": ["svg"]}

    def __init__(
        self,
        model: Model,
        *,
        driven: Sequence[int] | None = None,
        limits: ArrayLike | None = None,
        goal: ArrayLike | None = None,
        start: tuple[ArrayLike, ArrayLike] | Callable[[np.random.Generator], tuple[ArrayLike, ArrayLike]] | None = None,
        reward: Callable[[Array, Array, Array], float] | None = None,
        terminated: Callable[[Array, Array], bool] | None = None,
        max_steps: int | None = 500,
        h: float | None = None,
        order: int | None = None,
        render_mode: str | None = None,
    ) -> None:
        if render_mode not in (None, "svg"):
            raise InputError(f'render_mode={render_mode!r}: it must be "svg" or None')
        self.model, self.render_mode = model.single, render_mode
        self.goal = _posture(model.n, goal)
        self._turns = np.array([letter == "a" for letter in model.coordinates])
        self._environment = Environment(
            model,
            actuated=_driven(model) if driven is None else driven,
            max_u=limits,
            start=start or self._near_rest,
            reward=reward or (lambda q, v, u: -self.distance(q)),
            done=terminated,
            max_steps=max_steps,
            h=h,
            order=order,
            commands=True,
        )
        self.action_space = actions = self._environment.action_space
        self.observation_space = self._environment.observation_space
        if not np.isfinite(actions.high).all():
            raise InputError("the model's file does not say how large commands were: give limits, one for each driven coordinate")
        self.metadata = {**Env.metadata, "render_fps": max(1, round(1.0 / self._environment.h))}

    def distance(self, q: ArrayLike) -> float:
        """√Σ(qᵢ − qᵢ*)², every coordinate with equal weight, angles the short way round."""
        deviation = np.asarray(q, float) - self.goal
        short = np.remainder(deviation + np.pi, 2 * np.pi) - np.pi
        return float(np.linalg.norm(np.where(self._turns, short, deviation)))

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Array, dict[str, Any]]:
        """Begins an episode and returns observation and info; `options` may contain the initial q and v."""
        super().reset(seed=seed)
        self._environment._random = self.np_random
        observation, info = self._environment.reset(options=options)
        return observation, {**info, **self._facts(observation)}

    def step(self, action: ArrayLike) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """Advances by one step and returns observation, reward, terminated, truncated and info."""
        observation, reward, terminated, truncated, info = self._environment.step(action)
        if "error" in info:
            terminated, truncated = False, True
        return observation, reward, terminated, truncated, {**info, **self._facts(observation)}

    def render(self) -> str | None:  # type: ignore[override,unused-ignore]
        """A picture of the coordinates as SVG, with the goal in grey: an angle is a hand that hangs down at 0 and turns
        counterclockwise, any other coordinate a mark on a rail from −1 to 1, which stays at its end beyond. None without a render mode."""
        if self.render_mode is None:
            return None
        q = self._environment._observed()[: self.model.n]
        columns = "".join(self._column(i, float(x)) for i, x in enumerate(q))
        size = f'width="{COLUMN * self.model.n}" height="{COLUMN}"'
        return f'<svg xmlns="http://www.w3.org/2000/svg" {size} stroke-width="4" stroke-linecap="round">{columns}</svg>'

    def _column(self, i: int, x: float) -> str:
        draw = _hand if self._turns[i] else _mark
        middle = COLUMN * (i + 0.5)
        return draw(middle, float(self.goal[i]), "silver") + draw(middle, x, "black")

    def _near_rest(self, random: np.random.Generator) -> tuple[Array, Array]:
        q, v = random.uniform(-SPREAD, SPREAD, (2, self.model.n))
        return q, v

    def _facts(self, observation: Array) -> dict[str, Any]:
        q, v = np.split(observation, 2)
        return {"inside": bool(self.model.inside(q, v)), "distance": self.distance(q)}


def _posture(n: int, goal: ArrayLike | None) -> Array:
    posture = np.zeros(n) if goal is None else np.asarray(goal, float)
    if posture.shape != (n,) or not np.isfinite(posture).all():
        raise InputError(f"goal={goal!r}: it must be {n} finite numbers, one a coordinate")
    return posture


def _driven(model: Model) -> list[int] | None:
    """The coordinates that were driven in the training data; None if that is unknown."""
    covered = model.range
    driven = [] if covered is None else np.flatnonzero(np.abs(covered["u"]).max(axis=1)).tolist()
    return driven or None


def _hand(middle: float, angle: float, colour: str) -> str:
    length, half = 0.4 * COLUMN, 0.5 * COLUMN
    x, y = middle + length * np.sin(angle), half + length * np.cos(angle)
    return f'<line x1="{middle:.1f}" y1="{half:.1f}" x2="{x:.1f}" y2="{y:.1f}" stroke="{colour}"/>'


def _mark(middle: float, x: float, colour: str) -> str:
    place = middle + 0.4 * COLUMN * float(np.clip(x, -1.0, 1.0))
    return f'<line x1="{place:.1f}" y1="{0.4 * COLUMN:.1f}" x2="{place:.1f}" y2="{0.6 * COLUMN:.1f}" stroke="{colour}"/>'


__all__ = ["Env"]
