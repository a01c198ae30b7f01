"""The arguments of a launch file as they are typed: NAME:=VALUE..., and --verbose."""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Dict, List, Sequence, Tuple
from xml.etree import ElementTree

from .errors import ParameterError
from .suggestions import did_you_mean

TRUE = ("true", "True", "1")
# What other simulators, and people, call an argument.
OTHER_NAMES = {
    "speed": "real_time_factor",
    "factor": "real_time_factor",
    "rtf": "real_time_factor",
    "map": "world",
    "world_file": "world",
    "robot": "model",
    "position": "spawn",
    "pose": "spawn",
    "headless": "rviz:=false",  # the opposite
}


def described(file: Path, *next_files: Path) -> Dict[str, str]:
    """The arguments that a launch file lets its user choose, those with a default, and what each means.

    An argument that is passed on to the next file is described there.
    """
    found = [entry for entry in ElementTree.parse(file).getroot().findall("arg") if "default" in entry.attrib]
    passed_on = described(*next_files) if next_files else {}
    texts = {str(entry.get("name")): str(entry.get("doc", "")) for entry in found}
    return {name: text or passed_on.get(name, "") for name, text in texts.items()}


@dataclass(frozen=True)
class LaunchArguments:
    """What was typed, with the paths of files made absolute: the nodes run in another folder."""

    file: Path
    words: Tuple[str, ...]
    verbose: bool

    @classmethod
    def parse(cls, file: Path, words: Sequence[str], *other_options: str) -> "LaunchArguments":
        """Check words; ParameterError for one that roslaunch would take for a file or would silently ignore.

        `other_options`: those of the command that it handles itself, to be named where an option is unknown.
        """
        known, options = list(described(file)), ["--verbose", *other_options]
        given = [with_absolute_path(word) for word in words if word != "--verbose"]
        for word in given:
            name, separator, _ = word.partition(":=")
            if word.startswith("-"):
                there_is = "there are" if other_options else "there is"
                raise ParameterError(
                    f"there is no option {word}; {there_is}: {' '.join(options)}{did_you_mean(word, options)}"
                )
            if not separator:
                raise ParameterError(f"expected NAME:=VALUE, such as world:=stage_1; got '{word}'")
            if not name.startswith("__") and name not in known:
                there_are = f"there is no argument {name}; there are: {' '.join(known)}"
                raise ParameterError(f"{there_are}{_meant(name, known)}")
        return cls(file, tuple(given), "--verbose" in words)

    def value(self, name: str) -> str:
        """The value that was given last; empty if there is none."""
        return next((word.partition(":=")[2] for word in reversed(self.words) if word.startswith(f"{name}:=")), "")

    def is_true(self, name: str) -> bool:
        """Return whether an argument was given as true."""
        return self.value(name) in TRUE


def _meant(name: str, known: List[str]) -> str:
    other = OTHER_NAMES.get(name, "")
    return f"; did you mean {other}?" if other.partition(":=")[0] in known else did_you_mean(name, known)


def with_absolute_path(word: str) -> str:
    """NAME:=VALUE with an absolute path if the value is that of a file; the shell leaves a ~ after := as it is."""
    name, separator, value = word.partition(":=")
    value = os.path.expanduser(value)
    # A plain word is the name of a world, also where there is a file of that name.
    is_file = separator and ("/" in value or "." in value) and os.path.isfile(value)
    return f"{name}:={os.path.realpath(value)}" if is_file else word
