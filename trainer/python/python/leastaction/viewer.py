"""A motion drawn in a notebook or a file: the mechanism as it moves, and its coordinates over time. No server, no network.

    import leastaction as la

    la.viewer.show(model, model.rollout(q, v, u))                  # the last line of a cell of a notebook
    la.viewer.show(model, log["q"], log["t"], beside=predicted).save("motion.html")
"""

from __future__ import annotations

import html
import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, Union

import numpy as np

from . import _leastaction as _core
from ._errors import InputError
from ._model import Model

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

__all__ = ["View", "show"]

MOST_FRAMES = 2000
"""Largest number of samples of a motion that are drawn; of a longer motion every second, third, … sample is."""

_SCRIPT = Path(__file__).with_name("viewer.js")
_CHART = 92
"""Height of a chart, pixels."""
_STYLE = (
    "body{font:14px/1.4 system-ui,sans-serif;margin:8px;color:#1b1b1b;background:#fff}svg{display:block;max-width:100%}"
    "#controls{display:flex;flex-wrap:wrap;gap:.5rem;align-items:center;margin:.4rem 0;max-width:720px}#time{flex:1;min-width:8rem}"
    "#clock{min-width:5.5rem;text-align:right;font-variant-numeric:tabular-nums}button,select{font:inherit}"
    "#scene{touch-action:none;background:#fafafa}small{color:#555}#legend span{margin-right:1.2em}"
)


class View:
    """A drawn motion: shows itself in a notebook, and `save` writes it as a page that opens without any other file."""

    def __init__(self, page: str, height: int, about: str | None) -> None:
        self.html = page
        """The page, as text."""
        self.about = about
        """What is drawn, in words; None if the model does not know its geometry, so that only charts are drawn."""
        self._height = height

    def _repr_html_(self) -> str:
        """The page in a frame of its own, so that several views in one notebook do not disturb each other."""
        return (
            f'<iframe srcdoc="{html.escape(self.html)}" sandbox="allow-scripts" title="motion" '
            f'style="width:100%;height:{self._height}px;border:0"></iframe>'
        )

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the page, for example motion.html. A file of another kind is never overwritten."""
        if Path(path).suffix.lower() not in (".html", ".htm"):
            raise InputError(f"{os.fspath(path)}: name a page, as motion.html")
        _core.write_file(os.fspath(path), self.html.encode("utf-8"), "page")

    def __repr__(self) -> str:
        return f"<leastaction.viewer.View: {self.about or 'charts alone'} save('motion.html') writes it>"


class _Motion(NamedTuple):
    """Positions [samples, n] at times [samples], s."""

    q: Array
    t: Array


def show(
    model: Model,
    q: Any,
    t: ArrayLike | None = None,
    *,
    beside: Any = None,
    beside_t: ArrayLike | None = None,
    labels: Sequence[str] = ("measured", "predicted"),
    names: Sequence[str] | None = None,
    title: str = "motion",
    charts: bool | None = None,
    speed: float = 1.0,
) -> View:
    """Draws a motion of a model, and moves it in real time.

    q         positions, [samples, n] (m or rad), or whatever has q and t: what `rollout` and `plan` return, or a trajectory of a `Log`.
    t         times, [samples], s, increasing; by default those of q, or else steps of `model.h` from 0.
    beside    a second motion that is laid over the first, like q; both have the clock of t.
    beside_t  times of the second motion; by default its own, or those of the first if it is as long.
    labels    what the two motions are called.
    names     what the coordinates are called, by default q1, q2, …
    title     title of the page.
    charts    whether coordinates are drawn over time, too; by default if the mechanism cannot be drawn, or if there are two motions.
    speed     1 is real time; the page offers others.

    Bodies, arms and graphs are drawn by their geometry, and can be turned by dragging if they move in space. A network of a pendulum, of
    a pole on a cart or of two rods is drawn by a schematic; for other models there are charts alone. The page has a button that plays and
    pauses, a slider, the speed and the time.
    """
    first = _motion(model, q, t, "q", None)
    motions = [first]
    if beside is not None:
        motions.append(_motion(model, beside, beside_t, "beside", first))
    elif beside_t is not None:
        raise InputError("beside_t without beside: give the second motion, too")
    if isinstance(labels, str) or len(labels) != 2:
        raise InputError(f"labels={labels!r}: it must be two names, one a motion")
    named = [f"q{i + 1}" for i in range(model.n)] if names is None else list(names)
    if len(named) != model.n:
        raise InputError(f"names has {len(named)} entries; the model has {model.n} coordinates")
    if not (np.isfinite(speed) and speed > 0):
        raise InputError(f"speed is {speed}; it must be a finite number above 0")
    motions = [_thinned(motion) for motion in motions]
    scene = _core.scene(model._core, np.concatenate([motion.q for motion in motions]))
    drawn = charts if charts is not None else scene is None or len(motions) == 2
    if scene is None and not drawn:
        raise InputError("the model does not know its geometry, so that nothing is left to draw: leave charts away")
    data = _data(motions, scene, [str(label) for label in labels], speed)
    data["charts"] = [f"{name}, {unit}" for name, unit in zip(named, model.units)] if drawn else []
    about = scene["about"] if scene else None
    height = 110 + (400 if scene else 0) + _CHART * len(data["charts"])
    return View(_page(title, about, data), height, about)


def _motion(model: Model, q: Any, t: ArrayLike | None, name: str, first: _Motion | None) -> _Motion:
    """The positions and times of an argument; those that are wrong are refused in words."""
    if isinstance(q, dict) and "q" in q:
        q, t = q["q"], q.get("t") if t is None else t
    elif hasattr(q, "q") and hasattr(q, "t"):
        q, t = q.q, q.t if t is None else t
    try:
        positions = np.asarray(q, float)
    except (TypeError, ValueError):
        raise InputError(f"{name} is not an array of numbers [samples, {model.n}]") from None
    if positions.ndim == 1 and model.n == 1:
        positions = positions[:, None]
    if positions.ndim != 2 or positions.shape[1] != model.n:
        more = "; choose one of the motions side by side, as q[0]" if positions.ndim > 2 else ""
        raise InputError(f"{name} has the shape {positions.shape}; it must be [samples, {model.n}], one number a coordinate{more}")
    if len(positions) < 2:
        raise InputError(f"{name} has {len(positions)} samples; a motion has at least 2")
    bad = np.argwhere(~np.isfinite(positions))
    if len(bad):
        k, i = bad[0]
        raise InputError(f"{name} is {positions[k, i]} at sample {k}, coordinate {i}: draw the samples before it, {name}[:{k}]")
    if t is None and first is not None and len(positions) == len(first.t):
        return _Motion(positions, first.t)
    return _Motion(positions, _times(model, t, len(positions), "t" if name == "q" else f"{name}_t"))


def _times(model: Model, t: ArrayLike | None, count: int, name: str) -> Array:
    if t is None:
        if model.h is None or name != "t":
            raise InputError(f"no times: give {name}, [{count}], s")
        return np.arange(count, dtype=np.float64) * model.h
    try:
        times = np.asarray(t, float)
    except (TypeError, ValueError):
        raise InputError(f"{name} is not an array of times, s") from None
    if times.shape != (count,):
        raise InputError(f"{name} has the shape {times.shape}; the motion has {count} samples")
    if not np.isfinite(times).all():
        k = int(np.argmin(np.isfinite(times)))
        raise InputError(f"{name} is {times[k]} at sample {k}; times are finite")
    steps = np.diff(times)
    if not (steps > 0).all():
        k = int(np.argmin(steps > 0))
        raise InputError(f"{name} goes from {times[k]} to {times[k + 1]} s at sample {k + 1}; times increase")
    return times


def _thinned(motion: _Motion) -> _Motion:
    """Every k-th sample and the last one, so that there are at most MOST_FRAMES."""
    last = len(motion.t) - 1
    stride = -(-last // (MOST_FRAMES - 1))
    kept = np.append(np.arange(0, last, stride), last)
    return _Motion(motion.q[kept], motion.t[kept])


def _data(motions: list[_Motion], scene: dict[str, Any] | None, labels: list[str], speed: float) -> dict[str, Any]:
    """The numbers of the page; times begin at 0 with the first sample of the first motion."""
    begin, drawn = motions[0].t[0], []
    ends = np.cumsum([len(motion.t) for motion in motions])
    points = np.split(scene["points"], ends[:-1]) if scene else None
    for number, motion in enumerate(motions):
        row = {"label": labels[number], "t": _rounded(motion.t - begin, 7), "q": _rounded(motion.q, 5)}
        if points is not None:
            row["points"] = _rounded(points[number].reshape(len(motion.t), -1), 5)
        drawn.append(row)
    data: dict[str, Any] = {"motions": drawn, "speed": speed, "both": len(motions) == 2, "scene": None}
    if scene is not None:
        data["scene"] = {key: scene[key] for key in ("parts", "tips", "right", "up")}
        data["scene"]["spatial"] = _is_spatial(scene)
    return data


def _rounded(numbers: Array, digits: int) -> list[Any]:
    """Numbers with so few digits that the page is small; the error is below a hundredth of a pixel."""
    if numbers.ndim > 1:
        return [_rounded(row, digits) for row in numbers]
    return [float(f"{x:.{digits}g}") for x in numbers]


def _is_spatial(scene: dict[str, Any]) -> bool:
    """Whether points move out of the plane in which they are drawn."""
    depth = scene["points"] @ np.cross(scene["right"], scene["up"])
    return bool(np.ptp(depth) > 1e-3 * max(np.ptp(scene["points"].reshape(-1, 3), axis=0).max(), 1e-9))


def _page(title: str, about: str | None, data: dict[str, Any]) -> str:
    script = _SCRIPT.read_text(encoding="utf-8")
    # A label may hold "</script>".
    numbers = json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
    words = about or "The model does not know its geometry, so that only its coordinates are drawn."
    if data["scene"] and data["scene"]["spatial"]:
        words += " Drag the picture to turn it; a double click turns it back."
    return (
        f'<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n<title>{html.escape(title)}</title>\n'
        f'<style>{_STYLE}</style>\n</head>\n<body>\n<div id="motion"></div>\n<div id="controls"><button id="play">Play</button>'
        '<input id="time" type="range" min="0" step="any" value="0" aria-label="time"><span id="clock"></span>'
        '<select id="speed" aria-label="speed"></select></div>\n<div id="legend"></div>\n<div id="charts"></div>\n'
        f"<small>{html.escape(words)}</small>\n<noscript>The motion is drawn by a script, and scripts are off.</noscript>\n"
        f'<script type="application/json" id="data">{numbers}</script>\n<script>\n{script}</script>\n</body>\n</html>\n'
    )
