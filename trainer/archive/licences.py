#!/usr/bin/env python3
"""Prints the licences of all crates that the command and the library of units are linked with: of `cargo metadata` on stdin.

    cargo metadata --format-version 1 --filter-platform TARGET | licences.py ROOT

Crates of ROOT are left out, whose licences stand beside this list, and so is what only tests, build scripts and macros need.
"""

import json
import sys
from collections import defaultdict
from pathlib import Path

RUST = "The Rust standard library, MIT OR Apache-2.0, and in static programs musl (MIT), libunwind (Apache-2.0 WITH LLVM-exception)."


def linked(metadata, names):
    """The packages that those of the names are linked with."""
    nodes = {node["id"]: node for node in metadata["resolve"]["nodes"]}
    packages = {package["id"]: package for package in metadata["packages"]}
    waiting = [key for key, package in packages.items() if package["name"] in names and package["source"] is None]
    found = set()
    while waiting:
        key = waiting.pop()
        if key in found or is_macro(packages[key]):
            continue
        found.add(key)
        waiting += [d["pkg"] for d in nodes[key]["deps"] if any(kind["kind"] is None for kind in d["dep_kinds"])]
    return sorted((packages[key] for key in found), key=lambda package: (package["name"], package["version"]))


def is_macro(package):
    """Whether a package runs in the compiler, and is not linked."""
    return any("proc-macro" in target["kind"] for target in package["targets"])


def texts(package):
    """The texts of a package's licences."""
    folder = Path(package["manifest_path"]).parent
    files = sorted(f for f in folder.iterdir() if f.name.upper().startswith(("LICEN", "COPYING", "UNLICEN", "NOTICE")) and f.is_file())
    return [file.read_text(errors="replace").strip() for file in files]


def main(root):
    metadata = json.load(sys.stdin)
    users = defaultdict(list)
    print("Programs of this archive contain the following parts.\n")
    print(RUST)
    for package in linked(metadata, {"leastaction", "leastaction-fmu"}):
        if Path(package["manifest_path"]).is_relative_to(root):
            continue
        name = f"{package['name']} {package['version']}"
        print(f"{name}: {package['license']}, {', '.join(package['authors']) or package['repository']}")
        for text in texts(package):
            users[text].append(name)
    for text, names in users.items():
        print(f"\n{'-' * 80}\n{', '.join(names)}\n{'-' * 80}\n\n{text}")


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve())
