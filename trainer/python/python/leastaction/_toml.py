"""Dictionaries as TOML: the subset that a configuration needs."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from ._errors import InputError


def to_toml(config: Mapping[str, Any]) -> str:
    """Returns the text of a configuration: a table for every dictionary at the top level, everything else inline."""
    tables = [(key, value) for key, value in config.items() if isinstance(value, Mapping)]
    lines = [f"{_key(key)} = {_value(value)}" for key, value in config.items() if not isinstance(value, Mapping)]
    for name, table in tables:
        lines.append(f"\n[{_key(name)}]")
        lines += [f"{_key(key)} = {_value(value)}" for key, value in table.items() if value is not None]
    return "\n".join(lines) + "\n"


def _key(key: Any) -> str:
    name = str(key)
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else json.dumps(name, ensure_ascii=False)


def _value(value: Any) -> str:
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (str, os.PathLike)):
        return json.dumps(os.fspath(value), ensure_ascii=False)
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(k)} = {_value(v)}" for k, v in value.items() if v is not None) + " }"
    if isinstance(value, np.ndarray):
        return _value(value.tolist())
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_value(entry) for entry in value) + "]"
    raise InputError(f"a configuration cannot have {value!r}: give text, numbers, lists or dictionaries")
