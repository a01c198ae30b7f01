"""The help text of each command, and the script for bash that `./robocop completion` makes of these texts."""

import re
import shlex
from pathlib import Path
from typing import Dict, List

from .launch_arguments import REPLAY, RUN, SIM, names
from .program import ROOT

HELP = Path(__file__).with_name("help.txt")
SCRIPT = Path(__file__).with_name("completion.bash")


def described() -> Dict[str, str]:
    """What the help text says about each command."""
    parts: Dict[str, str] = {}
    for part, command in re.findall(r"(?m)^(  ([a-z][a-z-]*).*\n(?:    .*\n)*)", HELP.read_text(encoding="utf-8")):
        parts[command] = parts.get(command, "") + part
    return parts


def completion() -> str:
    """The script for bash, with the values that it needs: the options are those that the help text names."""
    options = {command: list(dict.fromkeys(re.findall(r"--[a-z]+", text))) for command, text in described().items()}
    files = {"run": RUN, "sim": SIM, "replay": REPLAY}
    arguments = {command: [f"{name}:=" for name in names(file)] for command, file in files.items()}
    tables = _table("_robocop_options", options) + _table("_robocop_arguments", arguments)
    return f"_robocop_root={shlex.quote(str(ROOT))}\n{tables}{SCRIPT.read_text(encoding='utf-8')}"


def _table(name: str, words: Dict[str, List[str]]) -> str:
    rows = [f'  [{key}]="{" ".join(values)}"\n' for key, values in words.items()]
    return f"declare -gA {name}=(\n{''.join(rows)})\n"
