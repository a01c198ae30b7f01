"""What ./robocop help says about each command."""

import re
import textwrap
from pathlib import Path
from typing import Dict

from ..launch_arguments import described as arguments_of
from .program import REPLAY, RUN, SIM

HELP = Path(__file__).with_name("help.txt")
LAUNCH_FILES = {"run": (RUN, SIM), "sim": (SIM,), "replay": (REPLAY,)}
WIDTH, INDENT = 118, 29


def described() -> Dict[str, str]:
    """What the help text says about each command."""
    parts: Dict[str, str] = {}
    for part, command in re.findall(r"(?m)^(  ([a-z][a-z-]*).*\n(?:    .*\n)*)", HELP.read_text(encoding="utf-8")):
        parts[command] = parts.get(command, "") + part
    return parts


def shown(command: str) -> str:
    """The help text of a command, with the arguments of its launch file; empty for an unknown command."""
    text = described().get(command, "")
    if command not in LAUNCH_FILES:
        return text
    rows = [_row(f"{name}:=", meaning) for name, meaning in arguments_of(*LAUNCH_FILES[command]).items()]
    return "\n".join(
        [f"{text}\n  Each ARG:=VALUE is one of these; docs/interfaces.md has defaults and ranges:\n", *rows, ""]
    )


def _row(name: str, meaning: str) -> str:
    lines = textwrap.wrap(" ".join(meaning.split()), WIDTH - INDENT) or [""]
    return "\n".join([f"    {name:{INDENT - 5}} {lines[0]}", *(" " * INDENT + line for line in lines[1:])])
