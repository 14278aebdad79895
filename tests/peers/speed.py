"""Runs the comparisons of speed one after the other on one core, and writes their ratios as the tables of a page of the book."""

import argparse
import json
import platform
import re
import sys
from pathlib import Path

from arm_pinocchio import fastest
from common import HERE, Failure, exit_code, run

PAGE = HERE.parent.parent / "docs" / "book" / "src" / "speed.md"
# The tables stand between these lines of the page.
MARKS = "<!-- speed.py -->", "<!-- end of speed.py -->"
COMPARISONS = {"casadi": "casadi_cartpole.py", "modlanet": "modlanet_jax.py", "lgnn": "lgnn_jax.py", "arms": "arm_pinocchio.py"}
FUNCTIONS = {"inverse_dynamics": "inverse dynamics", "mass_matrix": "mass matrix", "derivatives": "derivatives of inverse dynamics",
             "acceleration": "forward dynamics"}
RIVALS = {"pinocchio": "Pinocchio", "mujoco": "MuJoCo", "phyz-rigid": "phyz-rigid"}


def machine():
    """The processor and the vector registers that the programs were compiled for."""
    text = Path("/proc/cpuinfo").read_text() if Path("/proc/cpuinfo").exists() else ""
    found = {key: value for key, value in re.findall(r"^(model name|cpu family|flags)\s*: (.*)$", text, re.MULTILINE)}
    flags = found.get("flags", "").split()
    vectors = next((name for flag, name in [("avx512f", "AVX-512"), ("avx2", "AVX2")] if flag in flags), "no AVX2")
    family = f", family {found['cpu family']}" if "cpu family" in found else ""
    return f"{found.get('model name', platform.processor() or platform.machine())}{family}, {vectors}"


def measured(name, options):
    """The report of a comparison; `options.reports` keeps it."""
    kept = options.reports / f"{name}.json" if options.reports else None
    if kept and kept.exists():
        return json.loads(kept.read_text())
    print(f"{COMPARISONS[name]} …", file=sys.stderr)
    folder = ["--folder", options.folder] if options.folder and name == "arms" else []
    report = json.loads(run([sys.executable, HERE / COMPARISONS[name], "--json", *folder]))
    if kept:
        kept.parent.mkdir(parents=True, exist_ok=True)
        kept.write_text(json.dumps(report))
    return report


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def times(ratio):
    return f"{ratio:.1f}" if ratio >= 10 else f"{ratio:.2f}"


def of_casadi(report):
    names = {"acceleration_ns": "acceleration", "residual_jacobian_ns": "residual and Jacobian of a step"}
    rows = [[names.get(key, key), times(row["ratio_o2"]), times(row["ratio_any"]), f"{row['ours_code_bytes'] / 1e3:.1f}",
             f"{min(build['code_bytes'] for build in report['builds']) / 1e3:.1f}"] for key, row in report["comparison"].items()]
    head = ["", "CasADi's best with `-O2`", "… with any flags", "our code, both functions, kB", "CasADi's smallest, kB"]
    return f"A network of a cart-pole in f32, call by call, beside C that CasADi {report['casadi']} generates (gcc {report['gcc']}):\n\n" + table(head, rows)


def of_modlanet(report):
    rows = [[title, times(row["automatic_ratio_cpu"]), times(row["structured_ratio_cpu"])] for title, row in report["comparison"].items()]
    head = ["", "JAX, derivatives its own", "JAX, derivatives written out"]
    return (f"The loss of ModLaNet's double pendulum over {report['rows']:,} rows, {report['parameters']} numbers, in f64, beside JAX {report['jax']}:\n\n"
            + table(head, rows))


def of_lgnn(report):
    rows = [[title, times(row["ratio_cpu"])] for title, row in report["comparison"].items()]
    return f"A ring of {report['springs']} springs in f64, beside JAX {report['jax']}:\n\n" + table(["", "JAX's fastest"], rows)


def of_arms(report):
    head = ["", *(name for name in report)]
    rows = []
    for key, name in FUNCTIONS.items():
        for rival, shown in RIVALS.items():
            ratios = []
            for arm in report.values():
                best = fastest(arm["rivals"].get(rival, {"ns": {}})["ns"], key)
                ratios.append(times(best[0] / arm["ours_ns"][key]) if best else "")
            if any(ratios):
                rows.append([f"{name}, {shown}", *ratios])
    for key, name in FUNCTIONS.items():
        rows.append([f"{name}, eight states side by side beside one a call",
                     *(times(arm["ours_ns"][key] / arm["ours_ns"][f"{key}_lanes"]) for arm in report.values())])
    return "Trees of rigid bodies in space, in f64, one state a call:\n\n" + table(head, rows)


def compare(options):
    writers = {"casadi": of_casadi, "modlanet": of_modlanet, "lgnn": of_lgnn, "arms": of_arms}
    parts = [f"Measured on one core of a shared machine: {machine()}. A number above 1 means that leastaction is that many times as fast."]
    parts += [writers[name](measured(name, options)) for name in COMPARISONS]
    text = "\n\n".join(parts)
    if not options.write:
        print(text)
        return
    page = PAGE.read_text()
    if any(page.count(mark) != 1 for mark in MARKS):
        raise Failure(f"{PAGE}: the lines {MARKS[0]} and {MARKS[1]} must occur once each")
    before, after = page.split(MARKS[0])[0], page.split(MARKS[1])[1]
    PAGE.write_text(f"{before}{MARKS[0]}\n{text}\n{MARKS[1]}{after}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true", help=f"replace the tables of {PAGE.relative_to(HERE.parent.parent)} instead of printing them")
    parser.add_argument("--reports", type=Path, metavar="DIR", help="keep the reports of the comparisons in DIR, and take those that are there")
    parser.add_argument("--folder", type=Path, help="to build Pinocchio's and MuJoCo's programs in; existing ones are not built again")
    options = parser.parse_args()
    sys.exit(exit_code(lambda: compare(options)))


if __name__ == "__main__":
    main()
