"""Plans: motions within the limits of drives, joints and speeds, with the gains that follow them."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple, Union

import numpy as np

from . import _leastaction as _core
from ._errors import InputError
from ._model import Model
from ._toml import to_toml

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    PathLike = Union[str, os.PathLike[str]]
    Array = NDArray[np.float64]


class PlanProgress(NamedTuple):
    """The state of one of the searches of a plan after an iteration."""

    guess: str
    """Name of the start guess."""
    nodes: int
    """Number of nodes."""
    iteration: int
    """Number of iterations done."""
    cost: float
    """Cost with the penalties of limits and goal."""
    violation: float
    """Largest violation of limits and goal, m, rad, m/s or rad/s."""


class Start(NamedTuple):
    """Result of the search from one start guess."""

    guess: str
    """Name of the start guess."""
    nodes: int
    """Number of nodes."""
    ending: str
    """How the search ended."""
    cost: float
    """Cost without that of time."""
    violation: float
    """Largest violation of limits and goal, m, rad, m/s or rad/s."""
    iterations: int
    """Number of iterations."""
    seconds: float
    """Duration of the search, s."""


class Plan:
    """A motion with its commands and with the gains that follow it. A node is a time over which a command is held.

    The law is u = u_k − K_k (x − x_k) with x = (q, v). The last row is the end: its state, the command that holds it, and the gain there.
    """

    def __init__(self, core: _core.Plan) -> None:
        self._core = core
        facts = core.facts()
        n = facts["u"].shape[1]
        count = len(facts["u"])
        self.t: Array = facts["node_seconds"] * np.arange(count)
        """Times of the nodes and of the end, [nodes + 1], s."""
        self.q: Array = facts["x"][:, :n]
        """Positions, [nodes + 1, n], m or rad."""
        self.v: Array = facts["x"][:, n:]
        """Velocities, [nodes + 1, n], m/s or rad/s."""
        self.u: Array = facts["u"]
        """Commands, [nodes + 1, n]; 0 for coordinates that are not driven."""
        self.gains: Array = facts["gains"]
        """Gains K, [nodes + 1, n, 2n]; 0 for coordinates that are not driven."""
        self.tube: Array = facts["tube"]
        """Half-widths of (q, v) within which the feedback stays inside the limits of the drives, [nodes, 2n]."""
        self.cost: float = facts["cost"]
        """Cost, that of the time included."""
        self.feasible: bool = facts["feasible"]
        """Whether limits and goal are met."""
        self.violation: float = facts["violation"]
        """Largest violation of limits and goal, m, rad, m/s or rad/s."""
        self.worst: str | None = facts["worst"]
        """The limit, or the part of the goal, that is missed most, in words; None if all are met."""
        self.seconds: float = facts["seconds"]
        """Duration of the motion, s."""
        self.iterations: int = facts["iterations"]
        """Number of iterations of the search that found the motion."""
        self.ending: str = facts["ending"]
        """How that search ended."""
        self.holds: bool = facts["holds"]
        """Whether the end is a rest that the drives can hold."""
        self.interrupted: bool = facts["interrupted"]
        """Whether Ctrl-C stopped the search; the motion is then the best one so far."""
        self.tick: float = facts["tick"]
        """Step h of the model, s."""
        self.order: int = facts["order"]
        """Order of the step, 2 or 4."""
        self.ticks_per_node: int = facts["ticks_per_node"]
        """Number of ticks in a node."""
        self.names: list[str] = facts["names"]
        """Names of the coordinates."""
        self.notes: list[str] = facts["notes"]
        """Remarks on the robot description."""
        self.starts = [Start(*row) for row in core.starts()]
        """All searches; the first one is that of the plan."""

    @property
    def model(self) -> Model:
        """The model that the plan is for."""
        return Model(self._core.model())

    def to_bytes(self) -> bytes:
        """The bytes of the plan file. WorkError if limits or goal are not met."""
        if not self.feasible:
            from ._errors import WorkError

            raise WorkError(f"no plan to be shipped: {self.worst}. Allow more time, larger limits or more starts")
        return self._core.to_bytes()

    def save(self, path: PathLike) -> None:
        """Writes the plan file for the chip, bound to the model; `plan.model.save` writes that. A file of another kind is never
        overwritten."""
        _core.write_file(os.fspath(path), self.to_bytes(), "plan")

    def __repr__(self) -> str:
        state = "" if self.feasible else f", misses: {self.worst}"
        return f"<leastaction.Plan: {self.seconds:.3f} s in {len(self.t) - 1} nodes, cost {self.cost:.5g}{state}>"


def plan(
    config: PathLike | Mapping[str, Any] | None = None,
    *,
    model: Model | PathLike | None = None,
    guess: ArrayLike | None = None,
    callback: Callable[[PlanProgress], Any] | None = None,
    **keys: Any,
) -> Plan:
    """Plans a motion from a start to a goal within limits, as `leastaction plan` does.

        plan = la.plan("swing-up.toml")
        plan = la.plan(model=model, seconds=4.0, start=[np.pi], goal=[0.0], limits={"u": [1.5]})

    config    configuration: a file, its text, or a dictionary with the same keys. Paths are relative to the file, else to the working
              folder.
    model     a model, or the path of a model file, run folder or robot description, in place of the configuration's.
    guess     commands to begin with, [nodes, n], instead of start guesses.
    callback  function that is called with a `PlanProgress` after every iteration of every search. If it raises an exception, the
              search stops and the exception is raised.
    keys      keys of a configuration, besides or instead of a dictionary: tick, order, seconds (a number, or the shortest and the
              longest), ticks_per_node, start, goal, limits, soft, cost, search, follow. `start` and `goal` may be positions alone.

    The interpreter's lock is released; start guesses are searched side by side on all threads. Ctrl-C keeps the best motion so far:
    `plan.interrupted` is then true. A motion that misses limits or goal is returned, too: look at `plan.feasible` and `plan.worst`.
    """
    core_model = model._core if isinstance(model, Model) else None
    file, text = _configuration(config, model, keys)
    rows = None if guess is None else np.asarray(guess, np.float64)
    if rows is not None and rows.ndim != 2:
        raise InputError(f"guess has the shape {rows.shape}; it must be [nodes, n]")
    told = callback and (lambda *row: callback(PlanProgress(*row)))
    return Plan(_core.plan_motion((file, text), core_model, rows, told))


def _configuration(
    config: PathLike | Mapping[str, Any] | None, model: Model | PathLike | None, keys: Mapping[str, Any]
) -> tuple[str, str | None]:
    """Returns the name of a configuration, and its text unless it is a file."""
    if isinstance(config, (str, os.PathLike)):
        if keys or not (model is None or isinstance(model, Model)):
            given = ", ".join([*keys, *([] if model is None or isinstance(model, Model) else ["model"])])
            raise InputError(f"{given} beside a configuration's text: change the text, or give the configuration as a dictionary")
        text = os.fspath(config)
        return ("the configuration", text) if "\n" in text or "=" in text and not os.path.exists(text) else (text, None)
    tables = {key: value for key, value in {**(config or {}), **keys}.items() if value is not None}
    for key in ("start", "goal"):
        if key in tables and not isinstance(tables[key], Mapping):
            tables[key] = {"q": np.atleast_1d(tables[key]) if np.ndim(tables[key]) == 0 else tables[key]}
    if model is not None:
        tables["model"] = "the model" if isinstance(model, Model) else os.fspath(model)
    if "model" not in tables:
        raise InputError("no model: give model=, or the key model of the configuration")
    return "the configuration", to_toml(tables)
