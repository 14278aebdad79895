"""Training: `leastaction train` as a function."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, Union

import numpy as np

from . import _leastaction as _core
from ._errors import InputError
from ._logs import Evaluation, Log, evaluate
from ._model import Model
from ._toml import to_toml

if TYPE_CHECKING:
    from numpy.typing import NDArray

    PathLike = Union[str, os.PathLike[str]]


class Progress(NamedTuple):
    """The state of training after an iteration."""

    iteration: int
    """Number of iterations done, over all stages."""
    stage: str
    """Name of the stage: warm-up, training, …"""
    seconds: float
    """Duration of training so far, s."""
    train: float
    """Loss on the training data."""
    validation: float | None
    """Loss on the held-back data; None if nothing is held back."""


class Run:
    """A training run in its folder: `checkpoint.postcard`, `history.csv`, `config.toml`, pictures and, for losses over windows, a report
    page."""

    def __init__(self, folder: PathLike, report: Mapping[str, Any] | None = None, notes: list[str] | None = None) -> None:
        self.folder = Path(folder)
        self.report = dict(report or {})
        """The command's report: ending, iterations, losses, samples, seconds."""
        self.notes = list(notes or [])
        """Remarks on the data, and on what was not learned; one sentence each."""
        self._model: Model | None = None

    @property
    def model(self) -> Model:
        """The best model so far, as `leastaction export` writes it."""
        if self._model is None:
            self._model = Model(_core.model_of_run(os.fspath(self.folder)))
        return self._model

    @property
    def ending(self) -> str | None:
        """Why training ended: iterations, converged, target, patience or time."""
        return self.report.get("ending")

    @property
    def train_loss(self) -> float | None:
        """Training loss of the best weights."""
        return self.report.get("train_loss")

    @property
    def validation_loss(self) -> float | None:
        """Validation loss of the best weights; None if nothing was held back."""
        return self.report.get("validation_loss")

    @property
    def history(self) -> NDArray[Any]:
        """One row per iteration, with the fields iteration, stage, seconds, train and validation (NaN if nothing was held back)."""
        rows = (self.folder / "history.csv").read_text(encoding="utf-8").splitlines()[1:]
        fields = [line.split(",") for line in rows if line]
        types = [("iteration", np.int64), ("stage", "U32"), ("seconds", float), ("train", float), ("validation", float)]
        number = lambda text: float(text) if text else np.nan  # noqa: E731
        return np.array([(int(i), stage, float(s), number(t), number(v)) for i, stage, s, t, v in fields], types)

    @property
    def config(self) -> str:
        """The configuration as TOML, every key written out."""
        return (self.folder / "config.toml").read_text(encoding="utf-8")

    @property
    def page(self) -> Path | None:
        """The report page of the fit; None if the loss was not over windows."""
        file = self.folder / "report.html"
        return file if file.exists() else None

    def evaluate(self, data: Any = None, **options: Any) -> Evaluation:
        """Evaluates this run like `leastaction.evaluate`; by default on the log that it was trained on. Files are read as that one was."""
        if data is None:
            options.setdefault("config", self.folder / "config.toml")
        return evaluate(self, data, **options)

    def __repr__(self) -> str:
        loss = self.train_loss
        return f"<leastaction.Run in {str(self.folder)!r}" + ("" if loss is None else f", training loss {loss:.3e}") + ">"


def train(
    config: PathLike | Mapping[str, Any] | None = None,
    output: PathLike | None = None,
    *,
    data: Log | Mapping[str, Any] | PathLike | None = None,
    resume: bool = False,
    force: bool = False,
    progress: bool | Callable[[Progress], Any] = True,
) -> Run:
    """Learns a model, as `leastaction train config.toml -o output` does, with the same bits.

    config    file, or a dictionary with the same keys: {"model": {"coordinates": "ta"}, "training": {"iterations": 50}};
              `print(leastaction.defaults("inertia-network"))` explains all keys (inertia-network, modular, graph, bodies, arm).
    output    folder of the run; a temporary folder by default.
    data      data to learn from instead of the configuration's files: a `Log`, or a dictionary of its arguments, which is written to
              output.npz so that the run can be resumed like any other; or the name of a file, a pattern, or a list of them.
    resume    continues the run in the folder, bit for bit.
    force     replaces the run in the folder as soon as the new one has a finite loss.
    progress  True: a line on stderr; False: nothing; or a function that is called with a `Progress` after every iteration. If it raises
              an exception, training saves and stops.

    Ctrl-C finishes the iteration, saves, and raises KeyboardInterrupt: `train(..., resume=True)` continues, and `open_run(output).model`
    is the best model so far.
    """
    folder = Path(output) if output is not None else Path(tempfile.mkdtemp(prefix="leastaction-")) / "run"
    file, text = _configuration(config, data, folder, replace=resume or force)
    shown = _Line(progress) if progress is True else None
    notes: list[str] = []

    def tell(sentence: str) -> None:
        notes.append(sentence)
        if shown:
            shown.say(sentence)

    report = None
    callback = None
    if progress and shown is None:
        callback = lambda *row: progress(Progress(*row))  # type: ignore[operator] # noqa: E731
    elif shown:
        callback = lambda *row: shown.show(Progress(*row))  # noqa: E731
    try:
        report = _core.train_run(file, text, os.fspath(folder), resume, force, callback, tell)
    finally:
        if shown:
            shown.end()
    import json

    return Run(folder, json.loads(report), notes)


def open_run(folder: PathLike) -> Run:
    """Opens the run in a folder, finished or not."""
    if not (Path(folder) / "checkpoint.postcard").exists():
        raise InputError(f"{os.fspath(folder)}: there is no checkpoint.postcard; is this the folder of a training run?")
    return Run(folder)


def _configuration(
    config: PathLike | Mapping[str, Any] | None, data: Any, folder: Path, replace: bool
) -> tuple[str, str | None]:
    """Returns the name of a configuration, and its text unless it is a file."""
    if data is None and isinstance(config, (str, os.PathLike)):
        return os.fspath(config), None
    if isinstance(config, (str, os.PathLike)):
        raise InputError("data takes the place of a configuration's files: give the configuration as a dictionary")
    tables = {key: dict(value) if isinstance(value, Mapping) else value for key, value in (config or {}).items()}
    if data is not None:
        tables.setdefault("data", {})["file"] = _written(data, folder, replace)
    return "the configuration", to_toml(tables)


def _written(data: Any, folder: Path, replace: bool) -> Any:
    if isinstance(data, (str, os.PathLike)):
        return os.fspath(data)
    if isinstance(data, list) and all(isinstance(entry, (str, os.PathLike)) for entry in data):
        return [os.fspath(entry) for entry in data]
    log = data if isinstance(data, Log) else Log(**data)
    file = folder.with_name(folder.name + ".npz")
    if file.exists() and not replace:
        raise InputError(f"{file} already exists; go on with resume=True, start anew with force=True, or choose another output")
    log.write(file)
    return str(file)


class _Line:
    """Progress on stderr: one line that is rewritten on a terminal, otherwise a new line every two seconds."""

    def __init__(self, _shown: bool) -> None:
        self._terminal = sys.stderr.isatty()
        self._last = -np.inf
        self._width = 0

    def show(self, row: Progress) -> None:
        if row.seconds - self._last < (0.1 if self._terminal else 2.0):
            return
        self._last = row.seconds
        held_back = "" if row.validation is None else f", validation {row.validation:.2e}"
        text = f"{row.iteration} {row.stage}: train {row.train:.2e}{held_back}, {row.seconds:.1f} s"
        self._put(text)

    def _put(self, text: str) -> None:
        if self._terminal:
            sys.stderr.write("\r" + text.ljust(self._width))
            self._width = len(text)
        else:
            sys.stderr.write(text + "\n")
        sys.stderr.flush()

    def say(self, sentence: str) -> None:
        self.end()
        sys.stderr.write(sentence + "\n")

    def end(self) -> None:
        if self._terminal and self._width:
            sys.stderr.write("\n")
            self._width = 0
