"""Runs the first Python block of a page, the ten lines of the README: python run_readme.py PAGE."""

import re
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
text = Path(sys.argv[1]).read_text(encoding="utf-8")
block = re.search(r"```python\n(.*?)```", text, re.DOTALL)
assert block, "the page has no Python"
exec(compile(block.group(1), sys.argv[1], "exec"), {"__name__": "__main__"})
assert Path("fit.png").stat().st_size > 1000 and Path("m.postcard").exists()
