"""Import of networks that were trained by other authors' programs in PyTorch or JAX."""

from __future__ import annotations

import json
import os
import struct
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Union

import numpy as np

from . import _leastaction as _core
from ._errors import InputError
from ._model import Model

Weights = Union[str, "os.PathLike[str]", Mapping[str, Any]]

_TYPES = {"float32": "F32", "float64": "F64", "float16": "F16", "int64": "I64", "int32": "I32"}


def from_symo(
    weights: Weights, *, system: str | None = None, coordinates: str | None = None, h: float | None = None
) -> Model:
    """Imports a network of the SyMo authors' program (SyMo, E2E-SyMo or L-NODE; PyTorch).

    weights      .safetensors file, or a dictionary from the program's tensor names to arrays: PyTorch's `network.state_dict()` as it is
    system       mechanism of the paper that gives coordinates and step: pendulum, cartpole or acrobot
    coordinates  without `system`, one letter per coordinate in the order of q: t translation, a angle
    h            step that the network was trained with, s
    """
    return Model(_core.import_symo(*_packed(weights), system, coordinates, h))


def from_modlanet(
    weights: Weights, *, system: str = "pendulum", count: int | None = None, mass: float | None = None
) -> Model:
    """Imports a network of the ModLaNet authors' program (PyTorch) as a tree of `count` elements.

    weights  as for `from_symo`
    system   kind of the elements: "pendulum" (each hangs from the one before) or "body" (free points in the plane)
    mass     mass to take instead of the file's, kg
    """
    if system not in ("pendulum", "body"):
        raise InputError(f'system={system!r}: it must be "pendulum" or "body"')
    bodies = system == "body"
    return Model(_core.import_modlanet(*_packed(weights), bodies, count or (3 if bodies else 2), mass))


def from_lgnn(weights: Weights, *, count: int = 3, drag: bool = False) -> Model:
    """Imports a network that the LGNN authors' program (JAX) trained on pendulums, as a chain of `count` bobs on rods of 1 m.

    weights  as for `from_symo`
    drag     whether the drag in the file was trained (every file has a drag)
    """
    return Model(_core.import_lgnn(*_packed(weights), count, drag))


def _packed(weights: Weights) -> tuple[bytes, str]:
    """The bytes of a safetensors file, and its name for messages."""
    if isinstance(weights, (str, os.PathLike)):
        try:
            return Path(weights).read_bytes(), Path(weights).name
        except OSError as error:
            raise InputError(f"{os.fspath(weights)}: {error.strerror}") from None
    header: dict[str, Any] = {}
    data = b""
    for name, tensor in weights.items():
        array = np.ascontiguousarray(_as_array(tensor))
        kind = _TYPES.get(array.dtype.name)
        if kind is None:
            raise InputError(f"tensor {name} has numbers of type {array.dtype}; give float32 or float64")
        content = array.astype(array.dtype.newbyteorder("<")).tobytes()
        header[name] = {"dtype": kind, "shape": list(array.shape), "data_offsets": [len(data), len(data) + len(content)]}
        data += content
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 8)
    return struct.pack("<Q", len(text)) + text + data, "a dictionary of arrays"


def _as_array(tensor: Any) -> Any:
    """Turns a tensor of PyTorch, JAX or numpy into an array."""
    for step in ("detach", "cpu"):
        tensor = getattr(tensor, step)() if hasattr(tensor, step) else tensor
    return np.asarray(tensor)
