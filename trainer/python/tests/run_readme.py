"""Runs the ten lines of the README, its first Python block, that of the viewer, and then the blocks for other packages that are installed:
python run_readme.py PAGE."""

import importlib.util
import re
import sys
from pathlib import Path

import matplotlib

PACKAGES = {"leastaction.torch": "torch", "leastaction.jax": "jax", "leastaction.gymnasium": "gymnasium"}

matplotlib.use("Agg")
text = Path(sys.argv[1]).read_text(encoding="utf-8")
blocks = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
assert blocks, "the page has no Python"


def run(block):
    """Runs a block and returns its names."""
    names = {"__name__": "__main__"}
    exec(compile(block, sys.argv[1], "exec"), names)
    return names


run(blocks[0])
assert Path("fit.png").stat().st_size > 1000 and Path("m.postcard").exists()
run(next(block for block in blocks if "la.viewer" in block))
assert "predicted" in Path("motion.html").read_text(encoding="utf-8")
for module, package in PACKAGES.items():
    found = [block for block in blocks if module in block]
    assert len(found) == 1, f"{module} has {len(found)} blocks"
    if importlib.util.find_spec(package) is None:
        print(f"{package} is not installed, so its block is skipped")
        continue
    names = run(found[0])
    gradient = {"torch": lambda: names["u"].grad, "jax": lambda: names["gradient"], "gymnasium": lambda: names["env"].goal}
    assert abs(gradient[package]()).max() > 0, package
