"""Choice among several builds of the extension module, by the instructions of this machine.

A portable wheel has the module for every x86-64-v2 and, in folders beside it, builds for machines with AVX2 (x86_64_v3) and AVX-512
(x86_64_v4). Single precision has the same bits in all of them; training rounds as the machine's instructions do.
"""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path


def choose() -> None:
    """Replaces the portable module by the fastest build that runs here; a build from source has only one module, which stays."""
    here, name = Path(__file__).parent, f"{__package__}._leastaction"
    builds = {int(folder.name[-1]): folder for folder in here.glob("x86_64_v[34]") if folder.is_dir()}
    if not builds:
        return
    from . import _leastaction as baseline

    level = max((known for known in builds if known <= baseline.cpu_level()), default=None)
    file = level and next(builds[level].glob("_leastaction.*"), None)
    spec = file and importlib.util.spec_from_file_location(name, file)
    if not spec or not spec.loader:
        return
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    sys.modules[name] = module
    setattr(sys.modules[__package__], "_leastaction", module)
