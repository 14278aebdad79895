"""Estimation of a mechanism's state from its encoder readings alone."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from . import _leastaction as _core

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from ._model import Model

    Array = NDArray[Any]


class Estimate(NamedTuple):
    """An estimated state."""

    q: Array
    """Positions, [n], m or rad."""
    v: Array
    """Velocities, [n], m/s or rad/s."""


class Observer:
    """The observer of the firmware, bit for bit: the model is stepped under the acting force, and every sample corrects the estimate.

    model     Model in generalised coordinates (graphs have no observer)
    h, order  step size (s) and order of the integrator; by default those of training
    memory    maximum number of samples in memory: a longer memory smooths the noise more, but trusts a wrong model longer
    patience  number of consecutive missing samples of one encoder after which the estimate is no longer trusted
    zeros     standard deviations (of the encoders' zeros, of an innovation), rad or m: learns the zeros; by default they are 0

    One tick is `correct(y)`, then `predict(u)` with the force until the next tick; or `update(y, u)`, which does both and returns the
    estimate at the sample.
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
        """The estimate of q and v; None until every coordinate has been measured."""
        known = self._core.estimate()
        return None if known is None else Estimate(*known)

    @property
    def zeros(self) -> Array:
        """Zero offsets of the encoders (reading minus true position), [n], rad or m; 0 unless they are learned."""
        return self._core.zeros()

    @property
    def trusted(self) -> bool:
        """Whether the estimate can be relied on: every encoder has given three samples (fewer if `memory` is shorter), and none has been
        silent for longer than `patience`."""
        return self._core.trusted()

    def correct(self, y: ArrayLike) -> None:
        """Takes the samples of a step, [n], rad or m; NaN for a missing one."""
        self._core.correct(self._row(y))

    def predict(self, u: ArrayLike | None = None, *, u_end: ArrayLike | None = None) -> int | None:
        """Steps the model under the force u [n] (N or N m), or a force that goes linearly from u to u_end; returns the number of Newton
        updates, None before the first samples."""
        start = self._row(np.zeros(self._n) if u is None else u)
        return self._core.predict(start, start if u_end is None else self._row(u_end))

    def update(self, y: ArrayLike, u: ArrayLike | None = None) -> Estimate | None:
        """Takes samples, steps under the force until the next ones, and returns the estimate at the samples."""
        self.correct(y)
        estimate = self.estimate
        self.predict(u)
        return estimate

    def _row(self, x: ArrayLike) -> Array:
        return np.ascontiguousarray(np.broadcast_to(np.asarray(x, np.float32), (self._n,)))
