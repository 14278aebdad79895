"""Maps of arrays with their Jacobians: the part that PyTorch and JAX have in common."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ._errors import InputError
from ._model import Model

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]


@dataclass(frozen=True)
class Map:
    """A function of q, v, u, […, n] each, in double precision: the acceleration, or with a step the state (q, v) at its end.

    A state without a value gives NaN, since an exception cannot leave a compiled function of JAX.
    """

    model: Model
    step: tuple[float, int] | None

    @property
    def n(self) -> int:
        """Number of coordinates."""
        return self.model.n

    @property
    def width(self) -> int:
        """Numbers of the result: n, or 2n after a step."""
        return self.n if self.step is None else 2 * self.n

    def values(self, *at: Any) -> Array:
        """The results, […, width]."""
        q, v, u = (np.asarray(x, np.float64) for x in at)
        double = self.model.double
        if self.step is None:
            return double.acceleration(q, v, u, errors="nan")
        h, order = self.step
        return np.concatenate(double.step(q, v, u, h=h, order=order, errors="nan"), -1)

    def jacobians(self, *at: Any) -> Array:
        """Their derivatives by (q, v, u), […, width, 3n]."""
        q, v, u = (np.asarray(x, np.float64) for x in at)
        return self.model._jacobians((q, v, u), self.step, "nan")

    def check(self, shapes: list[tuple[int, ...]]) -> None:
        """Refuses arguments whose last axis is not n."""
        for name, shape in zip("qvu", shapes):
            if not shape or shape[-1] != self.n:
                raise InputError(f"{name} has the shape {tuple(shape)}; its last axis must be {self.n}, one number a coordinate")


def acceleration(model: Model) -> Map:
    """The acceleration of a model, which must have no rods."""
    return _probed(Map(model, None))


def step(model: Model, h: float | None, order: int | None) -> Map:
    """A step of a model, which must have no rods."""
    return _probed(Map(model, model._step(h, order)))


def _probed(of: Map) -> Map:
    """Asks for no derivatives, so that a model or a step that has none is refused at once."""
    none = np.zeros((0, of.n))
    of.jacobians(none, none, none)
    return of
