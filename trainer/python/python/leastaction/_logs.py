"""Logged motion: arrays and files, a first look at unknown logs, and the evaluation of models on them."""

from __future__ import annotations

import io
import json
import os
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Union

import numpy as np

from . import _leastaction as _core
from ._errors import InputError
from ._model import Model

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[Any]
    PathLike = Union[str, os.PathLike[str]]


class Log:
    """Logged motion: one trajectory, or several one after another.

    q           positions, [samples, n], m or rad (angles wrapped or not); [samples] of one coordinate
    t or h      time stamps, [samples], s; or the time between samples, s
    v, a, u     velocities, accelerations and generalised forces (N or N m), shaped like q; each may be left out
    trajectory  number of the trajectory that each sample belongs to, [samples], integers; by default all are one trajectory
    control     "held" if u_k acts from t_k to t_{k+1}, like a controller's output; "linear" if u was sampled by a sensor

    q, t, v, a and u may also be lists of arrays, one per trajectory. When the log is read, uneven stamps are resampled and gaps split
    trajectories; `notes` says so.
    """

    def __init__(
        self,
        q: ArrayLike | list[Array],
        t: ArrayLike | list[Array] | None = None,
        h: float | None = None,
        v: ArrayLike | list[Array] | None = None,
        a: ArrayLike | list[Array] | None = None,
        u: ArrayLike | list[Array] | None = None,
        trajectory: ArrayLike | None = None,
        control: str | None = None,
    ) -> None:
        if (t is None) == (h is None):
            raise InputError("a log has stamps t or a step h, s: give one of them")
        lengths = [len(part) for part in _parts(q)]
        if _is_list(q) and trajectory is None:
            trajectory = np.repeat(np.arange(len(lengths)), lengths)
        self.q = _joined("q", q, lengths)
        self.t = None if t is None else _joined("t", t, lengths, columns=False)
        self.h = None if h is None else float(h)
        self.v, self.a, self.u = (None if x is None else _joined(name, x, lengths) for name, x in zip("vau", (v, a, u)))
        self.trajectory = None if trajectory is None else np.asarray(trajectory, np.int64)
        self.control = control
        self.notes: list[str] = []
        """Decisions made on reading, such as resampling; one sentence each."""
        for name, x in (("t", self.t), ("v", self.v), ("a", self.a), ("u", self.u), ("trajectory", self.trajectory)):
            if x is not None and len(x) != len(self.q):
                raise InputError(f"{name} has {len(x)} samples, q {len(self.q)}")

    @classmethod
    def read(cls, files: PathLike | Sequence[PathLike] | None = None, config: PathLike | None = None) -> Log:
        """Reads .npz, .csv or .mcap files (patterns may have *, ? and **), by the [data] table of `config` if it is given."""
        h, control, motions, notes = _core.read_log(_name(config), _names(files))
        field = lambda name: [motion[name] for motion in motions] if name in motions[0] else None  # noqa: E731
        log = cls([motion["q"] for motion in motions], h=h, v=field("v"), a=field("a"), u=field("u"), control=control)
        log.trajectory = np.repeat([motion["id"] for motion in motions], [len(motion["q"]) for motion in motions])
        log.notes = notes
        return log

    @property
    def n(self) -> int:
        """Number of coordinates."""
        return self.q.shape[1]

    def __len__(self) -> int:
        return len(self.q)

    @property
    def trajectories(self) -> list[dict[str, Array]]:
        """One dictionary per trajectory, with q, t and the other quantities of the log; t begins at 0 if the log has no stamps."""
        numbers = np.zeros(len(self.q), np.int64) if self.trajectory is None else self.trajectory
        return [self._part(numbers == number) for number in dict.fromkeys(numbers.tolist())]

    def __iter__(self) -> Iterator[dict[str, Array]]:
        return iter(self.trajectories)

    def _part(self, rows: Array) -> dict[str, Array]:
        t = (self.h or 0.0) * np.arange(int(rows.sum())) if self.t is None else self.t[rows]
        fields = {"q": self.q, "v": self.v, "a": self.a, "u": self.u}
        return {"t": t} | {name: x[rows] for name, x in fields.items() if x is not None}

    def write(self, path: PathLike) -> None:
        """Writes an .npz file that every command reads. A file of another kind is never overwritten."""
        fields: dict[str, Any] = {"q": self.q, "t": self.t, "v": self.v, "a": self.a, "u": self.u}
        fields |= {"h": self.h, "trajectory": self.trajectory, "control": self.control}
        archive = io.BytesIO()
        np.savez(archive, **{name: x for name, x in fields.items() if x is not None})
        if Path(path).suffix != ".npz":
            raise InputError(f"{os.fspath(path)}: name a file that ends in .npz")
        _core.write_file(os.fspath(path), archive.getvalue(), "log")

    def __repr__(self) -> str:
        count = 1 if self.trajectory is None else len(np.unique(self.trajectory))
        has = "".join(name for name in "vau" if getattr(self, name) is not None)
        return f"<leastaction.Log: {count} trajectories, {len(self.q)} samples, {self.n} coordinates, q{has}>"


class Look:
    """Findings in logs: `report`, `doubts`, and a first `configuration`."""

    def __init__(self, report: dict[str, Any], text: str, doubts: list[str], configuration: str | None) -> None:
        self.report = report
        """Files, columns and coordinates, as `leastaction look --json` prints them."""
        self.doubts = doubts
        """Oddities, one sentence each."""
        self.configuration = configuration
        """TOML, ready for training, with columns guessed by their names; None if they cannot be guessed."""
        self._text = text

    def __str__(self) -> str:
        return self._text + "".join(f"note: {doubt}\n" for doubt in self.doubts)

    __repr__ = __str__


class Evaluation(dict):  # type: ignore[type-arg]
    """The measures of `leastaction evaluate --json` by name, with `notes`; converted to text, the measures in words."""

    def __init__(self, measures: dict[str, Any], text: str, notes: list[str]) -> None:
        super().__init__(measures)
        self.notes = notes
        """Remarks on the log and the model, one sentence each."""
        self._text = text

    def __str__(self) -> str:
        return self._text

    __repr__ = __str__


def look(files: PathLike | Sequence[PathLike], output: PathLike | None = None) -> Look:
    """Examines unknown logs of one machine: clocks, ranges, encoder grids, noise, and a guess of what the columns are.

    `output` names a file for a first configuration: check it, then train with it.
    """
    name = os.fspath(output) if output is not None else "robot.toml"
    report, text, doubts, configuration = _core.look_at(_names(files), name)
    if output is not None:
        if configuration is None:
            raise InputError("no configuration is written: the columns cannot be guessed by their names")
        _core.write_file(name, configuration.encode(), "configuration")
    return Look(json.loads(report), text, doubts, configuration)


def evaluate(
    model: Any,
    data: Log | PathLike | Sequence[PathLike] | None = None,
    *,
    config: PathLike | None = None,
    order: int | None = None,
    control: str | None = None,
    page: PathLike | None = None,
    beside: Any = None,
) -> Evaluation:
    """Measures a model on logged motion: mean squared errors of accelerations, steps and whole trajectories, in double precision and
    (under "chip") with the bits of the chip; for arms, torque errors.

    model    Model, Run, or the name of a model file or of a run's folder
    data     Log or files; by default the files of the configuration
    config   configuration whose [data] gives names and units of the columns, step and control of the log; without it, files for a
             run are read as the run's own logs were
    order    order of the steps, 2 or 4; by default that of the model, else 4
    control  course of u between samples, "held" or "linear"; by default that of the log, else of the model, else held
    page     .html file to write: horizons, residuals, friction
    beside   another model to show beside this one on the page
    """
    with tempfile.TemporaryDirectory(prefix="leastaction-") as folder:
        files = _names(_as_file(data, folder)) if data is not None else None
        native = isinstance(data, Log)
        request = {"config": _name(config), "files": files, "native": native, "order": order, "control": control}
        file, part = _as_model(model, folder, "model")
        other = None if beside is None else _as_model(beside, folder, "beside")[0]
        report, text, notes = _core.evaluate(file, part, request, _name(page), other)
    return Evaluation(json.loads(report), text, notes)


def report(model: Any, data: Any = None, page: PathLike = "report.html", **options: Any) -> Evaluation:
    """Writes the report page of a model on logged motion and returns the measures; takes the arguments of `evaluate`."""
    return evaluate(model, data, page=page, **options)


def _as_model(model: Any, folder: str, name: str) -> tuple[str, str | None]:
    if isinstance(model, Model):
        file = os.path.join(folder, name + ".postcard")
        model.save(file)
        return file, model.part
    return os.fspath(getattr(model, "folder", model)), None


def _as_file(data: Any, folder: str) -> Any:
    if not isinstance(data, Log):
        return data
    file = os.path.join(folder, "log.npz")
    data.write(file)
    return file


def _name(path: PathLike | None) -> str | None:
    return None if path is None else os.fspath(path)


def _names(files: Any) -> Any:
    if files is None:
        return None
    return [os.fspath(files)] if isinstance(files, (str, os.PathLike)) else [os.fspath(file) for file in files]


def _is_list(x: Any) -> bool:
    """Whether x is a list of arrays, one per trajectory."""
    return isinstance(x, (list, tuple)) and len(x) > 0 and np.ndim(x[0]) > 0 and isinstance(x[0], np.ndarray)


def _parts(x: Any) -> list[Array]:
    """Returns one array per trajectory."""
    parts = [np.asarray(part, float) for part in (x if _is_list(x) else [x])]
    if any(part.ndim == 0 for part in parts):
        raise InputError("a log has arrays of samples, not single numbers")
    return parts


def _joined(name: str, x: Any, lengths: list[int], columns: bool = True) -> Array:
    parts = _parts(x)
    if len(parts) != len(lengths):
        raise InputError(f"{name} has {len(parts)} trajectories, q {len(lengths)}")
    if columns:
        parts = [part.reshape(-1, 1) if part.ndim == 1 else part for part in parts]
    if any(part.ndim != (2 if columns else 1) for part in parts):
        raise InputError(f"{name} must be [samples{', n' if columns else ''}], or a list of such arrays")
    return np.concatenate(parts)
