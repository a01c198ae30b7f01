"""The checkouts whose simulators are measured: this one, and that of --against."""

import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Dict, Mapping

from ..errors import BenchError

SETUP_TIMEOUT = 1800.0  # [s, wall] for `./robocop shell` of the other checkout, which may have to build it first


@dataclass(frozen=True)
class Checkout:
    """Where a checkout's programs are, and the environment of its workspace."""

    name: str  # in the report
    programs: Path
    variables: Mapping[str, str]

    def environment(self) -> Dict[str, str]:
        """Its workspace with the ROS master of this measurement."""
        ros = {name: value for name, value in os.environ.items() if name.startswith("ROS_") and "PACKAGE" not in name}
        workspace = {name: value for name, value in self.variables.items() if name not in ("ROS_IP", "ROS_NAMESPACE")}
        return {**workspace, **ros}


def this_checkout() -> Checkout:
    """The checkout of this program."""
    return Checkout("this", Path(sys.argv[0]).absolute().parent, dict(os.environ))


def other_checkout(root: Path) -> Checkout:
    """A checkout as its own `./robocop shell` sets it up; BenchError when it can't be."""
    command = [str(root.absolute() / "robocop"), "shell", "env", "-0"]
    try:
        output = subprocess.run(
            command,
            env=_without_own_workspace(os.environ),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            text=True,
            timeout=SETUP_TIMEOUT,
            check=True,
        ).stdout
    except (OSError, subprocess.SubprocessError) as error:
        raise BenchError(f"--against {root}: expected a checkout of this project: {error}") from error
    variables = dict(entry.split("=", 1) for entry in output.split("\0") if "=" in entry)
    if "ROBOCOP_WS" not in variables:
        raise BenchError(f"--against {root}: its ./robocop shell does not set ROBOCOP_WS")
    return Checkout("other", Path(variables["ROBOCOP_WS"], "lib", "aro_robocop_goto_as"), variables)


def _without_own_workspace(environment: Mapping[str, str]) -> Dict[str, str]:
    """The environment as it was before this checkout's workspace was sourced."""
    state = environment.get("ROBOCOP_STATE", "")
    cleaned = {}
    for name, value in environment.items():
        kept = [entry for entry in value.split(os.pathsep) if not state or not entry.startswith(state + os.sep)]
        if kept and not name.startswith("ROBOCOP_"):
            cleaned[name] = os.pathsep.join(kept)
    return cleaned
