"""The longer texts of causes, by their names; sentences made of parts; other people's texts, made safe to show."""

import functools
from typing import Mapping

import yaml

from robocop_hosting.workspace import places

FILE = "config/grading_texts.yaml"  # of this package


def text(name: str, *values: object) -> str:
    """A text of FILE with these values, as of str.format()."""
    return _texts()[name].format(*values)


@functools.lru_cache(maxsize=None)
def _texts() -> Mapping[str, str]:
    texts: Mapping[str, str] = yaml.safe_load((places()[1] / FILE).read_text(encoding="utf-8"))
    return texts


def sentences(*parts: str) -> str:
    """The parts that are not empty as sentences of one paragraph."""
    return " ".join(part if part.endswith(("?", ".", '."')) else f"{part}." for part in parts if part)


def printable(text: str) -> str:
    """One line without characters that control a terminal or are not allowed in XML."""
    return "".join(character if character.isprintable() else " " for character in text)


def printable_lines(text: str) -> str:
    """The same for a text that may have several lines."""
    return "\n".join(printable(line) for line in text.split("\n"))
