"""The lab's steps, read from docs/lab.md."""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import List, Tuple

LAB = Path(__file__).resolve().parents[3] / "docs" / "lab.md"
SECTION = re.compile(r"^## (?=\d+\. )", re.MULTILINE)
EXPECTED = re.compile(r"\*\*You will see\*\*(.*?)\n\n", re.DOTALL)
BLOCK = re.compile(r"^```(python)?\n(.*?)^```$", re.DOTALL | re.MULTILINE)
COMMANDS = ("./robocop", "ros", "python3", "sudo")  # how a block of commands begins; another one is what they print


@dataclass(frozen=True)
class Section:
    """One section: its heading, what one will see, and its commands, each with what it prints, or nothing."""

    title: str
    expected: str
    steps: Tuple[Tuple[str, str], ...]


def read_lab(path: Path = LAB) -> List[Section]:
    """The numbered sections; none where the documents are not installed."""
    text = path.read_text(encoding="utf-8") if path.is_file() else ""
    return [_section(part) for part in SECTION.split(text)[1:]]


def _section(text: str) -> Section:
    expected = EXPECTED.search(text)
    steps: List[Tuple[str, str]] = []
    for language, block in BLOCK.findall(text):
        if language or block.startswith(COMMANDS):
            steps.append((block, ""))
        elif steps:
            steps[-1] = (steps[-1][0], block)
    return Section(text.partition("\n")[0], " ".join(expected[1].split()) if expected else "", tuple(steps))
