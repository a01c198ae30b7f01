"""The lab's steps, read from docs/lab.md, as a list to tick off beside the robot."""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any, List, Tuple

from ...web import text
from .part import Context, Part

LAB = Path(__file__).resolve().parents[4] / "docs" / "lab.md"
SECTION = re.compile(r"^## (?=\d+\. )", re.MULTILINE)
EXPECTED = re.compile(r"\*\*You will see\*\*(.*?)\n\n", re.DOTALL)
BLOCK = re.compile(r"^```(python)?\n(.*?)^```$", re.DOTALL | re.MULTILINE)
COMMANDS = ("./robocop", "ros", "python3", "sudo")  # how a block of commands begins; another one is what they print
DONE = "✓ "


@dataclass(frozen=True)
class Section:
    """One section: its heading, what one will see, and its commands, each with what it prints, or nothing."""

    title: str
    expected: str
    steps: Tuple[Tuple[str, str], ...]


class Lab(Part):
    """One folder for each section of docs/lab.md; all browsers share the ticks."""

    def __init__(self, context: Context) -> None:
        super().__init__(context)
        for section in read_lab():
            self._add(section)

    def _add(self, section: Section) -> None:
        gui = self.context.server.gui
        with gui.add_folder(section.title, expand_by_default=False) as folder:
            gui.add_html(text.steps(section.expected, section.steps))
            done = gui.add_checkbox("Done", False)

        async def on_update(_: Any) -> None:
            folder.label = f"{DONE}{section.title}" if done.value else section.title

        done.on_update(on_update)


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
