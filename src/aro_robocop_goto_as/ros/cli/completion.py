"""What `./robocop completion` prints for bash: the options and launch arguments of each command."""

import re
import shlex
from pathlib import Path
from typing import Dict, List

from . import launch_arguments

HELP = Path(__file__).with_name("help.txt")
SCRIPT = Path(__file__).with_name("completion.bash")
LAUNCH_FILES = {"run": "robocop_goto_as.launch", "sim": "robocop_sim.launch", "replay": "replay.launch"}


def options() -> Dict[str, List[str]]:
    """The options that the help text gives each command, in the lines that describe it."""
    found: Dict[str, List[str]] = {}
    for command, text in re.findall(r"(?m)^  ([a-z][a-z-]*)(.*(?:\n   .*)*)", HELP.read_text(encoding="utf-8")):
        found[command] = list(dict.fromkeys([*found.get(command, []), *re.findall(r"--[a-z]+", text)]))
    return found


def completion(root: Path) -> str:
    """The script for bash, with the values that it needs."""
    arguments = {
        command: [f"{name}:=" for name in launch_arguments.names(root / "launch" / file)]
        for command, file in LAUNCH_FILES.items()
    }
    tables = _table("_robocop_options", options()) + _table("_robocop_arguments", arguments)
    return f"_robocop_root={shlex.quote(str(root))}\n{tables}{SCRIPT.read_text(encoding='utf-8')}"


def _table(name: str, words: Dict[str, List[str]]) -> str:
    rows = [f'  [{key}]="{" ".join(values)}"\n' for key, values in words.items()]
    return f"declare -gA {name}=(\n{''.join(rows)})\n"
