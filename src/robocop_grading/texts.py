"""Texts of checks and causes, which remember what they are made of: a file can tell them in another language."""

import string
from pathlib import Path
from typing import Any, List, Mapping, Optional, Sequence, Tuple

import yaml

from aro_robocop_goto_as.errors import HostingError, PlanError

from .hosting.files import read_bytes


class Text(str):
    """A text in English, with the template and the values, or the sentences, that it was made of."""

    template: str = ""
    values: Sequence[object] = ()
    parts: Tuple[str, ...] = ()


def text(template: str, *values: object) -> str:
    """The template, as of str.format(), with these values."""
    made = Text(template.format(*values))
    made.template, made.values = template, values
    return made


def sentences(*parts: str) -> str:
    """The parts that are not empty as sentences of one paragraph."""
    parts = tuple(filter(None, parts))
    made = Text(" ".join(part if part.endswith(("?", ".", '."')) else f"{part}." for part in parts))
    made.parts = parts
    return made


class Texts:
    """Translations: English text or template -> the same in another language; what is missing stays English."""

    def __init__(self, translations: Mapping[str, str]) -> None:
        self._translations = translations

    def told(self, what: str) -> str:
        """A text in that language, with all that it is made of."""
        if not isinstance(what, Text):
            return self._translations.get(what, what)
        if what.parts:
            return str(sentences(*map(self.told, what.parts)))
        values = [self.told(it) if isinstance(it, str) else it for it in what.values]
        return self._translations.get(what.template, what.template).format(*values)


ENGLISH = Texts({})


def load(path: Optional[Path], share: Path) -> Texts:
    """Translations from a copy of config/grading_texts.yaml; PlanError names the file and the mistake in it."""
    if path is None:
        return ENGLISH
    known, found = _read(share / "config" / "grading_texts.yaml"), _read(path)
    for english, translation in found.items():
        if english not in known:
            raise PlanError(f"{path}: unknown text: {english!r}; copy config/grading_texts.yaml of this version")
        try:
            (translation or "").format(*_examples(english))
        except (ValueError, LookupError, AttributeError) as error:
            raise PlanError(
                f"{path}: {translation!r}: expected the same values in brackets as in {english!r}"
            ) from error
    return Texts({english: translation for english, translation in found.items() if translation})


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
