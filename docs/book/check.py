#!/usr/bin/env python3
"""Checks the book.

    check.py files                every link between the repository's Markdown files, and to other files in it
    check.py html DIR             every link within the built book, with its anchor
    check.py blocks BIN [PAGE…]   runs what pages show: BIN is the folder of the command

The blocks of a page are run from top to bottom in a temporary folder of its own. A `toml` block must be valid TOML, and is written to a file if it
begins with `# NAME.toml`. A `sh` block is run and must succeed. The lines of an `output` block must occur, in this order, in the output of the last
`sh` block (… stands for omitted lines or an omitted part of a line). A `sh,no_run` block is skipped; the line before it gives the reason:
`<!-- not run: REASON -->`. Files that a reader already has, such as a log, are made by `<!-- run: COMMAND -->`, with the variable REPOSITORY.
"""

import html.parser
import os
import re
import subprocess
import sys
import tempfile
import time
import tomllib
import urllib.parse
from pathlib import Path

BOOK = Path(__file__).resolve().parent
ROOT = BOOK.parent.parent
# A link, or code, which holds no links.
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)|^```.*?^```|`[^`\n]*`", re.MULTILINE | re.DOTALL)
FENCE = re.compile(r"^```(\S*)[^\n]*\n(.*?)^```$", re.MULTILINE | re.DOTALL)
STEP = re.compile(r"^(?:<!-- run: (?P<run>.*?) -->|(?P<why><!-- not run: .+? -->\n+)?```(?P<kind>\S*)[^\n]*\n(?P<body>.*?)^```$)",
                  re.MULTILINE | re.DOTALL)


def anchors(text):
    """The anchors that GitHub and mdBook give to a page's headings."""
    for heading in re.findall(r"^#+ (.*)$", FENCE.sub("", text), re.MULTILINE):
        words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).replace("`", "")
        yield re.sub(r"[^\w\- ]", "", words.lower()).replace(" ", "-")


def check_files():
    listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "*.md"], cwd=ROOT, capture_output=True, text=True)
    broken = []
    for name in listed.stdout.split():
        for target in filter(None, LINK.findall((ROOT / name).read_text())):
            path, _, anchor = target.partition("#")
            if re.match(r"[a-z]+:", target):
                continue
            file = (ROOT / name).parent / path if path else ROOT / name
            if not file.exists() or (anchor and anchor not in anchors(file.read_text())):
                broken.append(f"{name}: {target}")
    return broken


class Page(html.parser.HTMLParser):
    """The links of a page, and the anchors in it that links may point to."""

    def __init__(self, file):
        super().__init__()
        self.links, self.ids = [], set()
        self.feed(file.read_text())

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name == "id":
                self.ids.add(value)
            elif name in ("href", "src") and value:
                self.links.append(value)


def check_html(folder):
    folder = Path(folder)
    pages = {file.resolve(): Page(file) for file in folder.rglob("*.html")}
    broken = []
    for file, page in pages.items():
        if file.name in ("404.html", "toc.html"):  # links of these are relative to the root of a server
            continue
        for link in page.links:
            parts = urllib.parse.urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            to = (file.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else file
            anchor = urllib.parse.unquote(parts.fragment)
            if not to.is_file() or (anchor and to in pages and anchor not in pages[to].ids):
                broken.append(f"{file.relative_to(folder.resolve())}: {link}")
    return broken


def missing(expected, printed):
    """The first expected line that was not printed after the preceding ones."""
    lines = iter(printed.splitlines())
    for line in expected.splitlines():
        pattern = re.escape(line.rstrip()).replace("…", ".*") + r"\s*"
        if line.strip() != "…" and not any(re.fullmatch(pattern, found) for found in lines):
            return line
    return None


def run_page(page, environment):
    """The errors in a page's blocks."""
    printed = ""
    text = page.read_text()
    with tempfile.TemporaryDirectory() as top:
        folder = top
        for step in STEP.finditer(text):
            where = f"{page.name}:{text.count(chr(10), 0, step.start()) + 1}"
            kind, body = step["kind"] or "", step["body"] or ""
            if step["run"] or kind == "sh":
                script = f"set -euo pipefail\n{step['run'] or body}\npwd > {top}/.folder"
                done = subprocess.run(["bash", "-c", script], cwd=folder, env=environment, text=True,
                                      stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
                printed = done.stdout
                if done.returncode:
                    return [f"{where}: exit code {done.returncode}\n{printed[-3000:]}"]
                folder = Path(top, ".folder").read_text().strip()
            elif kind == "sh,no_run" and not step["why"]:
                return [f"{where}: nothing says why this is not run"]
            elif kind == "output" and (line := missing(body, printed)):
                return [f"{where}: not printed: {line}\n{printed[-3000:]}"]
            elif kind == "toml":
                tomllib.loads(body)
                if name := re.match(r"# (\S+\.toml)\n", body):
                    Path(folder, name[1]).write_text(body)
            elif kind not in ("sh", "sh,no_run", "output", "text", "rust", "c", "yaml", "mermaid", "json", "python", "cpp") and not kind.startswith("rust,"):
                return [f"{where}: a block of no kind that is known: {kind!r}"]
    return []


def check_blocks(binaries, pages):
    environment = os.environ | {"REPOSITORY": str(ROOT), "PATH": f"{Path(binaries).resolve()}:{os.environ['PATH']}", "NO_COLOR": "1"}
    wrong = []
    for page in [Path(page) for page in pages] or [ROOT / "README.md", *sorted((BOOK / "src").glob("*.md"))]:
        start = time.monotonic()
        found = run_page(page, environment)
        print(f"{page.name}: {'wrong' if found else 'fine'}, {time.monotonic() - start:.1f} s", file=sys.stderr)
        wrong += found
    return wrong


def main():
    match sys.argv[1:]:
        case ["files"]:
            wrong = check_files()
        case ["html", folder]:
            wrong = check_html(folder)
        case ["blocks", binaries, *pages]:
            wrong = check_blocks(binaries, pages)
        case _:
            sys.exit(__doc__)
    sys.exit("\n".join(wrong) if wrong else 0)


main()
