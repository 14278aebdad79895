"""Controllers: from anywhere to a posture, asked by a simulator at its own rate."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from . import _leastaction as _core
from ._errors import InputError
from ._model import Model
from ._planning import _configuration

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from ._planning import PathLike

    Array = NDArray[np.float64]


class LibraryProgress(NamedTuple):
    """The state of the search of a controller's library."""

    searched: int
    """Number of starts that were searched. It stays while starts from which nothing was found are tried again."""
    starts: int
    """Number of all starts."""


class Controller:
    """Brings a mechanism to a posture in as little time as its drives allow, from any state, holds it there, and begins anew after a push.

        controller = la.Controller("acrobot.urdf", tick=0.002, seconds=2.0, start=[0, 0], goal=[np.pi, 0], limits={"u": [0, 6]})
        u = controller(q, v, t)                 # whenever the simulator likes

    model     a model, or the path of a model file, run folder or robot description, in place of the configuration's
    config    configuration as for `la.plan`: a file, its text, or a dictionary with the same keys
    progress  function that is called with a `LibraryProgress` after every start that was searched; an exception of it stops the search and
              is raised
    keys      keys of a configuration, besides or instead of a dictionary, as for `la.plan`

    What counts: `tick`; `seconds`, the longest motion; `ticks_per_node`; `goal`, a posture that the drives can hold; `limits`; the weights
    `cost.u`; `follow`, deviations of equal weight in the feedback; `search.seed`; `policy.starts`, the number of starts from which motions
    are searched in advance, the configuration's `start` among them; `policy.q` and `policy.v`, distances from the goal within which the
    regulator is tried; `policy.speeds`, velocities of the starts. A delay of the model's drives is not made up for.

    Creating a controller searches its library, on all threads and without the interpreter's lock: seconds for a pendulum, minutes for an
    acrobot. Ctrl-C ends it after the starts that are being searched, and keeps the motions found by then (`interrupted` is true); it is
    raised if there are none. A call follows a motion in microseconds; where that no longer leads to the goal, the call searches a new one
    (`searched`), which takes longer than a tick. Calls of different threads are calls of one run. The same calls give the same bits,
    whatever the number of threads.
    """

    def __init__(
        self,
        model: Model | PathLike | None = None,
        config: PathLike | Mapping[str, Any] | None = None,
        *,
        progress: Callable[[LibraryProgress], Any] | None = None,
        **keys: Any,
    ) -> None:
        if isinstance(model, Mapping):
            raise InputError("model is a dictionary; a configuration is the second argument, or config=")
        text = _configuration(config, model, keys)
        told = progress and (lambda *row: progress(LibraryProgress(*row)))
        self._core = _core.Controller(text, model._core if isinstance(model, Model) else None, told)
        facts = self._core.facts()
        self.tick: float = facts["tick"]
        """Tick, s."""
        self.low: Array = facts["low"]
        """Least command of every coordinate, [n], N or N m; 0 for those that are not driven."""
        self.high: Array = facts["high"]
        """Greatest command of every coordinate, [n], N or N m; 0 for those that are not driven."""
        self.seconds: Array = facts["seconds"]
        """Durations of the motions of the library, s."""
        self.interrupted: bool = facts["interrupted"]
        """Whether Ctrl-C stopped the search of the library."""
        self.names: list[str] = facts["names"]
        """Names of the coordinates."""
        self.notes: list[str] = facts["notes"]
        """Remarks on the robot description."""
        self.state: str | None = None
        """What the last call did: "follow" a motion, "hold" the goal, or "brake", because no motion was found, until the next search;
        None before the first call."""
        self.searched: bool = False
        """Whether the last call searched a motion."""

    @property
    def n(self) -> int:
        """Number of coordinates."""
        return len(self.names)

    def command(self, q: ArrayLike, v: ArrayLike, t: float | None = None) -> Array:
        """The command of every coordinate, [n], N or N m, within the limits; 0 for those that are not driven. It is meant until the next
        call.

        q, v  state, [n]: m or rad, m/s or rad/s; angles need not be wrapped
        t     time, s, counted from the first call of the run in whole ticks, to the nearest: several calls within a tick are one to the
              motion that is followed, and a gap lets it go on. Without t, every call is a tick after the last one.

        InputError, and nothing changes, for wrong shapes, numbers that are not finite, a t that goes back by a tick or more (`reset` first:
        a new run is never guessed), and a t in only some calls of a run.
        """
        time = None if t is None else float(self._numbers("t", t, ()))
        q, v = (np.atleast_1d(self._numbers(name, x, (self.n,))) for name, x in (("q", q), ("v", v)))
        u, self.state, self.searched = self._core.decide(q, v, time)
        return u

    def __call__(self, q: ArrayLike, v: ArrayLike, t: float | None = None) -> Array:
        """`command(q, v, t)`."""
        return self.command(q, v, t)

    def reset(self) -> None:
        """Forgets the run; the next call is the first one of another run, with the same library."""
        self._core.reset()
        self.state, self.searched = None, False

    @staticmethod
    def _numbers(name: str, x: ArrayLike, shape: tuple[int, ...]) -> Array:
        try:
            numbers = np.asarray(x, np.float64)
        except (TypeError, ValueError):
            raise InputError(f"{name} is {x!r}; it must be numbers of the shape {shape}") from None
        # A single coordinate may be a number alone.
        if numbers.shape != shape and (numbers.shape, shape) != ((), (1,)):
            raise InputError(f"{name} has the shape {numbers.shape}; it must be {shape}")
        return numbers

    def __repr__(self) -> str:
        return f"<leastaction.Controller: {len(self.seconds)} motions, tick {self.tick:g} s>"
