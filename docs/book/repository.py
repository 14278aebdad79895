#!/usr/bin/env python3
"""A preprocessor of mdBook that lets files of the repository be pages, and pages refer to files of the repository.

A page whose only text is a link to a Markdown file outside the book becomes that file. A link to any file outside the book leads to the
page that shows it; if there is none, the link's text and the file's path take its place, because the built book travels alone.
"""

import json
import os
import re
import sys
from pathlib import Path

BOOK = Path(__file__).resolve().parent
SOURCE = BOOK / "src"
ROOT = BOOK.parent.parent
LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)")
# A link, or code, which holds no links.
LINK_OR_CODE = re.compile(rf"{LINK.pattern}|^```.*?^```|`[^`\n]*`", re.MULTILINE | re.DOTALL)


def shown_file(text, page):
    """The file of the repository that a page shows, if the page does nothing else."""
    link = LINK.fullmatch(text.strip())
    if not link or not link[3].endswith(".md"):
        return None
    file = (page.parent / link[3]).resolve()
    return None if file.is_relative_to(SOURCE) else file


def chapters(items):
    for item in items:
        chapter = item.get("Chapter") if isinstance(item, dict) else None
        if chapter:
            yield chapter
            yield from chapters(chapter["sub_items"])


def rewritten(text, origin, page, pages):
    """The text of the file `origin` as shown on `page`: its links lead to pages."""

    def replace(link):
        image, words, target = link.groups()
        if target is None:
            return link[0]
        path, _, anchor = target.partition("#")
        if not path or re.match(r"[a-z]+:", target):
            return link[0]
        file = (origin.parent / path).resolve()
        inside = pages.get(file, file if file.is_relative_to(SOURCE) else None)
        if inside is None:
            name = str(file.relative_to(ROOT))
            return f"`{name}`" if words.strip("`") in (name, path, file.name) else f"{words} (`{name}`)"
        way = os.path.relpath(inside, page.parent) + (f"#{anchor}" if anchor else "")
        return f"{image}[{words}]({way})"

    return LINK_OR_CODE.sub(replace, text)


def main():
    if sys.argv[1:2] == ["supports"]:
        return
    _, book = json.load(sys.stdin)
    found = [(c, SOURCE / c["path"]) for c in chapters(book.get("items") or book.get("sections")) if c["path"]]
    origins = {page: shown_file(chapter["content"], page) for chapter, page in found}
    pages = {file: page for page, file in origins.items() if file}
    for chapter, page in found:
        origin = origins[page]
        text = origin.read_text() if origin else chapter["content"]
        chapter["content"] = rewritten(text, origin or page, page, pages)
    json.dump(book, sys.stdout)


main()
