"""Runs the cells of a notebook from top to bottom in one namespace, without Jupyter: python run_notebook.py NOTEBOOK."""

import json
import sys
from pathlib import Path


def main() -> None:
    import matplotlib

    matplotlib.use("Agg")
    notebook = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    names: dict = {"__name__": "__main__"}
    for number, cell in enumerate(notebook["cells"]):
        if cell["cell_type"] == "code":
            source = "".join(cell["source"])
            exec(compile(source, f"{sys.argv[1]} cell {number}", "exec"), names)


if __name__ == "__main__":
    main()
