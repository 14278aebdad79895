"""Numbers of a model that follow a machine along a log: `leastaction adapt` as a function."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, Union

from . import _leastaction as _core
from ._logs import Log, _as_file, _as_model, _name, _names
from ._model import Model

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    PathLike = Union[str, os.PathLike[str]]


class AdaptedNumber(NamedTuple):
    """A number of a model at the end of a log."""

    name: str
    """Symbol, and the body or coordinate, from 0: m of body 5, c of coordinate 2."""
    unit: str
    """Unit."""
    model: float
    """Value in the model."""
    prior: float
    """Standard deviation of the distance from it, before anything was seen; 0 for a number that stays."""
    distance: float
    """Estimated distance from the model."""
    standard_error: float
    """Standard error of the distance."""
    used: float
    """Distance in use, within the limits."""


class Adaptation:
    """Numbers of a model that have followed a log: what is attached, how sure that is, and how friction changed."""

    def __init__(
        self, report: Mapping[str, Any], text: str, notes: list[str], course: Mapping[str, NDArray[Any]], model: Model
    ) -> None:
        self.report = dict(report)
        """The report of `leastaction adapt --json`."""
        self.notes = notes
        """Remarks on the logs and the model, one sentence each."""
        self.model = model
        """The model with the numbers in use at the end of the log."""
        self.mass: float | None = report["mass"]
        """Mass that is attached at the end of the log, kg; None for a model without bodies."""
        self.standard_error: float | None = report["standard_error"]
        """Standard error of the mass, kg."""
        self.announced: bool = report["announced"]
        """Whether something was announced as attached."""
        self.seconds_to_announce: float | None = report["seconds_to_announce"]
        """Time in motion before that, s."""
        self.nmse_before: float | None = report["nmse_before"]
        """Squared error of the torques over their variance, mean over coordinates, by the model as it was; None if it cannot be measured."""
        self.nmse_after: float | None = report["nmse_after"]
        """The error with the numbers at the end of the log."""
        self.numbers = [AdaptedNumber(**number) for number in report["numbers"]]
        """Numbers at the end of the log."""
        self.changes: list[float] = report["changes"]
        """Times at which something changed at once, s."""
        self.unlike: bool = report["unlike"]
        """Whether no choice of the numbers explains the machine: do not use them."""
        self.times: NDArray[np.float64] = course["times"]
        """Ends of the windows, [windows], s from the beginning of the log; trajectories follow each other."""
        self.moving: NDArray[np.float64] = course["moving"]
        """Time in motion until then, [windows], s."""
        self.estimates: NDArray[np.float32] = course["estimates"]
        """Estimated distances from the model, [windows, numbers]."""
        self.standard_errors: NDArray[np.float32] = course["standard_errors"]
        """Standard errors of the distances, [windows, numbers]."""
        self.used: NDArray[np.float32] = course["used"]
        """Distances in use, [windows, numbers]."""
        self.residuals: NDArray[np.float32] = course["residuals"]
        """Balance of momentum by the model as it was, mean over a window, [windows, n], N or N m."""
        self._text = text

    def __str__(self) -> str:
        return self._text

    __repr__ = __str__


def adapt(
    model: Any,
    log: Log | PathLike | Sequence[PathLike],
    *,
    config: PathLike | None = None,
    body: int | None = None,
    mass: float | None = None,
    friction: bool = True,
    networks: bool = False,
    window: float | None = None,
    memory: float = 20.0,
    false_alarms: float = 1e-3,
    page: PathLike | None = None,
) -> Adaptation:
    """Lets numbers of a model follow the machine along a log, as `leastaction adapt` does: the ten inertial numbers of a body, to which
    something may be attached, and the friction of every coordinate.

        found = la.adapt(run, "loaded.csv")
        found.mass, found.standard_error, found.announced

    model         Model, Run, or the name of a model file or of a run's folder
    log           Log or files, with u
    config        configuration that the model was trained by: its [data] says how files are read, and names the log on which the model is
                  right, which says how uncertain the model is in itself. By default that of the run; without one, the uncertainty is taken
                  from the log itself, after the numbers have followed it
    body          body to which something may be attached, from 0; by default the last one
    mass          standard deviation of what may be attached, kg; by default a quarter of the mechanism
    friction      False: friction stays what it is
    networks      True: the last layer of the potential's network and the strength of the network's dissipation follow, too
    window        length of a window, s; by default 0.2, and at least 40 samples
    memory        time that is remembered, s
    false_alarms  false alarms in an hour
    page          .html file to write: the numbers over time with their standard errors, and how well they explain the log
    """
    wishes = {
        "body": body,
        "mass": mass,
        "friction": friction,
        "networks": networks,
        "window": window,
        "memory": memory,
        "false_alarms": false_alarms,
    }
    with tempfile.TemporaryDirectory(prefix="leastaction-") as folder:
        files, native = _names(_as_file(log, folder)), isinstance(log, Log)
        request = {"config": _name(config), "files": files, "native": native, "order": None, "control": None}
        file, part = _as_model(model, folder, "model")
        report, text, notes, course, core = _core.adapt(file, part, request, wishes, _name(page))
    return Adaptation(json.loads(report), text, notes, course, Model(core))
