"""Texts of checks and causes, which remember what they are made of: a file can tell them in another language."""

import functools
import string
from pathlib import Path
from typing import Any, List, Mapping, Optional, Sequence, Tuple

import yaml

from aro_robocop_goto_as.errors import HostingError, PlanError

from .builds.workspace import places
from .files.tree import read_bytes

FILE = "config/grading_texts.yaml"  # of this package


class Text(str):
    """A text in English, with its name and the values, or the sentences, that it was made of."""

    name: str = ""
    values: Sequence[object] = ()
    parts: Tuple[str, ...] = ()


def text(name: str, *values: object) -> str:
    """A text of FILE, or one that is its own name, with these values, as of str.format()."""
    made = Text((_english().get(name) or name).format(*values))
    made.name, made.values = name, values
    return made


def sentences(*parts: str) -> str:
    """The parts that are not empty as sentences of one paragraph."""
    parts = tuple(filter(None, parts))
    made = Text(" ".join(part if part.endswith(("?", ".", '."')) else f"{part}." for part in parts))
    made.parts = parts
    return made


class Texts:
    """Translations: name of a text -> the text in another language; what is missing stays English."""

    def __init__(self, translations: Mapping[str, Optional[str]]) -> None:
        self._translations = translations

    def told(self, what: str) -> str:
        """A text in that language, with all that it is made of."""
        if not isinstance(what, Text):
            return self._translations.get(what) or _english().get(what) or what
        if what.parts:
            return str(sentences(*map(self.told, what.parts)))
        values = [self.told(it) if isinstance(it, str) else it for it in what.values]
        return (self._translations.get(what.name) or _english().get(what.name) or what.name).format(*values)


ENGLISH = Texts({})


@functools.lru_cache(maxsize=None)
def _english() -> Mapping[str, Optional[str]]:
    return _read(places()[1] / FILE)


def load(path: Optional[Path]) -> Texts:
    """Translations from a copy of FILE; PlanError names the file and the mistake in it."""
    if path is None:
        return ENGLISH
    known, found = _english(), _read(path)
    for name, translation in found.items():
        if name not in known:
            raise PlanError(f"{path}: unknown text: {name!r}; copy {FILE} of this version")
        english = known[name] or name
        try:
            (translation or "").format(*_examples(english))
        except (ValueError, LookupError, AttributeError) as error:
            raise PlanError(
                f"{path}: {translation!r}: expected the same values in brackets as in {english!r}"
            ) from error
    return Texts(found)


def _examples(template: str) -> List[object]:
    """Values for a template."""
    return [1.5 if spec else "x" for _, name, spec, _ in string.Formatter().parse(template) if name is not None]


def read_yaml(path: Path) -> Any:
    """A file's plain values; PlanError if it can't be read."""
    try:
        return yaml.safe_load(read_bytes(path).decode("utf-8"))
    except (HostingError, ValueError, RecursionError, yaml.YAMLError) as error:
        raise PlanError(f"{path}: {error}") from error


def _read(path: Path) -> Mapping[str, Optional[str]]:
    raw = read_yaml(path)
    if not isinstance(raw, dict) or not all(isinstance(it, str) or it is None for pair in raw.items() for it in pair):
        raise PlanError(f"{path}: expected texts by text, got {str(raw)[:100]}")
    return raw
