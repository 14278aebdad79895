"""The state of a mechanism from its encoders' readings alone."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from . import _leastaction as _core

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from ._model import Model

    Array = NDArray[Any]


class Estimate(NamedTuple):
    """A state as estimated."""

    q: Array
    """Positions, [n], m or rad."""
    v: Array
    """Velocities, [n], m/s or rad/s."""


class Observer:
    """The observer of the firmware, with its bits: between samples the model is stepped under the force that acted, a sample corrects it.

    model     a Model in generalised coordinates (graphs have no observer)
    h, order  of the step; by default those of training
    memory    most samples in memory: more smooth the noise more and follow a wrong model longer
    patience  samples of one encoder missing in a row after which the estimate is not trusted any more
    zeros     learns what the encoders read more than there is: (how far off they may be, the deviation of an innovation), rad or m

    One tick is `correct(y)`, then `predict(u)` with the force until the next one; or `update(y, u)`, which does both and gives the estimate
    at the sample.
    """

    def __init__(
        self,
        model: Model,
        *,
        h: float | None = None,
        order: int | None = None,
        memory: int = 5,
        patience: int = 25,
        zeros: tuple[float, float] | None = None,
    ) -> None:
        self._n = model.n
        self.h, self.order = model._step(h, order)
        self._core = _core.Observer(model._core, (self.h, self.order), memory, patience, zeros)

    @property
    def estimate(self) -> Estimate | None:
        """q and v; None until every coordinate was measured."""
        known = self._core.estimate()
        return None if known is None else Estimate(*known)

    @property
    def zeros(self) -> Array:
        """What the encoders read more than there is, [n], rad or m; 0 where it is not learned."""
        return self._core.zeros()

    @property
    def trusted(self) -> bool:
        """Whether the estimate is fit to act on: three samples of every encoder, and none silent for longer than the patience."""
        return self._core.trusted()

    def correct(self, y: ArrayLike) -> None:
        """Takes the samples of a step, [n], rad or m; NaN where one is missing."""
        self._core.correct(self._row(y))

    def predict(self, u: ArrayLike | None = None, *, u_end: ArrayLike | None = None) -> int | None:
        """Steps the model under the force u [n] (N or N m), or one that is linear from u to u_end; says how many updates of Newton's method
        it took, None before the first samples."""
        start = self._row(np.zeros(self._n) if u is None else u)
        return self._core.predict(start, start if u_end is None else self._row(u_end))

    def update(self, y: ArrayLike, u: ArrayLike | None = None) -> Estimate | None:
        """Takes samples, gives the estimate at them, and steps under the force until the next ones."""
        self.correct(y)
        estimate = self.estimate
        self.predict(u)
        return estimate

    def _row(self, x: ArrayLike) -> Array:
        return np.ascontiguousarray(np.broadcast_to(np.asarray(x, np.float32), (self._n,)))
