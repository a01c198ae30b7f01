"""The commands and programs that README and docs/ print, as a user copies them."""

import re
from pathlib import Path
from typing import List, NamedTuple

ROOT = Path(__file__).resolve().parents[1]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]


class Block(NamedTuple):
    """A fenced block: where it begins, the heading above it, its language ('' for a shell or its output), its lines."""

    place: str
    heading: str
    language: str
    lines: List[str]


def blocks():
    """All fenced blocks."""
    for page in PAGES:
        heading, block = "", None
        for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
            fence = re.match(r"\s*```(\w*)", line)
            if fence and block is None:
                block = Block(f"{page.name}:{number}", heading, fence[1], [])
            elif fence:
                yield block
                block = None
            elif block is not None:
                block.lines.append(line)
            elif line.startswith("#"):
                heading = line.lstrip("# ")


def links(page):
    """The relative links of a page, images included."""
    return re.findall(r"\]\((?!\w+:)([^)\s]+)\)", page.read_text(encoding="utf-8"))


def anchors(page):
    """The anchors of a page's headings, as GitHub and GitLab name them."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.M)
    return {re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings}


def commands(*programs):
    """The fenced command lines that begin with one of these programs, without their comments."""
    found = []
    for block in blocks():
        if not block.language:
            for line in block.lines:
                command = re.sub(r"\s+#.*", "", line).strip()
                if re.sub(r"^(\w+=\S* )*", "", command).split(" ")[0] in programs:
                    found.append(command)
    return found


def inline_commands(program):
    """Commands of a program within sentences and tables, except those with placeholders in capitals."""
    found = []
    for page in PAGES:
        for code in re.findall(r"`([^`\n]+)`", page.read_text(encoding="utf-8")):
            if code.split(" ")[0] == program and not re.search(r"\b[A-Z]+\b|\.\.\.", code):
                found.append(code)
    return sorted(set(found))
