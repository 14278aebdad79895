"""Writes compressed.mat and plain.mat by SciPy: arrays of several types and shapes, and a structure.

python3 arrays.py FOLDER
"""

import pathlib
import sys

import numpy as np
import scipy.io

count = 6
k = np.arange(count)
log = {
    "time": 0.01 * k,
    "enc": np.stack([0.5 * k, -1.0 * k], 1),
    "wide": np.stack([0.5 * k, -1.0 * k]).astype(np.float32),
    "counts": (100 * k).astype(np.int16),
    "flags": k % 2 == 0,
    "big": (k + 2**40).astype(np.int64),
    "note": "a text",
    "cells": np.array([1, "b"], dtype=object),
    "phasor": 1j * k,
    "volume": np.zeros((2, 3, 4)),
    "once": np.zeros((1, 1, count)),
    "drive": {"tau": np.sqrt(k), "motor": {"current": 2.0 * k}, "name": "m"},
}
folder = pathlib.Path(sys.argv[1])
for name, compressed in [("compressed", True), ("plain", False)]:
    scipy.io.savemat(folder / f"{name}.mat", log, do_compression=compressed, oned_as="row")
