"""The longer texts of causes, by their names, and sentences made of parts."""

import functools
from typing import Mapping

import yaml

from .builds.workspace import places

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
