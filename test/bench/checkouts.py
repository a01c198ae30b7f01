"""The checkouts whose programs are measured."""

import os
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Dict, Mapping

from . import BenchError

SETUP_TIMEOUT = 1800.0  # [s, wall] for `./robocop shell` of the other checkout, which may have to build it first


@dataclass(frozen=True)
class Checkout:
    """A checkout's name in the report, and the environment of its workspace."""

    name: str
    variables: Mapping[str, str]

    @property
    def programs(self) -> Path:
        """The folder of its nodes."""
        return Path(self.variables["ROBOCOP_WS"], "lib", "aro_robocop_goto_as")

    def environment(self, measuring: Mapping[str, str]) -> Dict[str, str]:
        """Its workspace with the ROS master of a measurement, which is in that one's environment."""
        ros = {name: value for name, value in measuring.items() if name.startswith("ROS_") and "PACKAGE" not in name}
        workspace = {name: value for name, value in self.variables.items() if name not in ("ROS_IP", "ROS_NAMESPACE")}
        return {**workspace, **ros}


def this_checkout() -> Checkout:
    """The checkout of this program."""
    return Checkout("this", dict(os.environ))


def other_checkout(root: Path) -> Checkout:
    """A checkout as its own `./robocop shell` sets it up; BenchError when it can't be."""
    command = [str(root.absolute() / "robocop"), "shell", "env", "-0"]
    own = os.environ["ROBOCOP_STATE"] + os.sep  # what this checkout's workspace has added to paths is left out
    clean = {}
    for name, value in os.environ.items():
        parts = [part for part in value.split(":") if not part.startswith(own)]
        if parts and not name.startswith("ROBOCOP_"):
            clean[name] = ":".join(parts)
    try:
        pipe = subprocess.PIPE
        done = subprocess.run(
            command, env=clean, stdin=subprocess.DEVNULL, stdout=pipe, text=True, timeout=SETUP_TIMEOUT, check=True
        )
    except (OSError, subprocess.SubprocessError) as error:
        raise BenchError(f"--against {root}: expected a checkout of this project: {error}") from error
    variables = dict(entry.split("=", 1) for entry in done.stdout.split("\0") if "=" in entry)
    if "ROBOCOP_WS" not in variables:
        raise BenchError(f"--against {root}: its ./robocop shell does not set ROBOCOP_WS")
    return Checkout("other", variables)
