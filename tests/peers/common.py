"""Shared parts of the comparisons: failures, other programs, our executables, the run from the command line."""

import argparse
import json
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent


class Failure(Exception):
    """An error that the user can act on; `code` is the exit code."""

    def __init__(self, message, code=1):
        super().__init__(message)
        self.code = code


def need(tool, remedy):
    if shutil.which(tool) is None:
        raise Failure(f"`{tool}` not found on PATH: {remedy}", code=2)


def run(command, **options):
    """Runs a command and returns its output."""
    shown = " ".join(map(str, command))
    try:
        result = subprocess.run([str(part) for part in command], capture_output=True, text=True, **options)
    except OSError as error:
        raise Failure(f"`{shown}` cannot be run: {error}", code=2) from error
    if result.returncode != 0:
        raise Failure(f"`{shown}` failed ({result.returncode}):\n{result.stderr.strip()[-2000:]}")
    return result.stdout


def build_ours(package, target, otherwise, profile="release", flags=()):
    """Builds one of our executables, itself with further flags of the compiler, and returns its path; `otherwise` names the options that make
    the build unnecessary."""
    need("cargo", f"install Rust from https://rustup.rs, or pass {otherwise}")
    command = ["cargo", "rustc" if flags else "build", "--profile", profile, "-p", package, *target, "--message-format=json"]
    command += ["--", *flags] if flags else []
    messages = run(command, cwd=HERE.parent)
    artifacts = [json.loads(line) for line in messages.splitlines() if line.startswith("{")]
    executables = [a["executable"] for a in artifacts if a.get("executable")]
    if not executables:
        raise Failure(f"`{' '.join(map(str, command))}` built no executable")
    return Path(executables[-1])


def positive(text):
    """Type of an option: a positive integer."""
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"{text} is not a positive number")
    return value


def exit_code(compare):
    """Runs the comparison, prints why it failed if it did, and returns the exit code."""
    try:
        compare()
    except Failure as failure:
        print(f"error: {failure}", file=sys.stderr)
        return failure.code
    return 0
