"""What passes between a session and the runner: the order, as a file, and what the session tells, as lines.

The lines are on the session's standard output. Libraries print there, too, so their output goes to standard error.
"""

import os
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Mapping, Tuple

from ..plan import Plan


@dataclass(frozen=True)
class Job:
    """What a session is to do: the scenarios of one part of a hand-in that the plan's checks examine."""

    part: str
    command: Tuple[str, ...]  # of the node, in the sandbox
    environment: Mapping[str, str]
    folder: Path  # the node's
    out: Path  # for records and bags
    plan: Plan
    parameters: Mapping[str, Any]  # on the parameter server
    cpu_time: float  # [s] of the node and its children together


_descriptor = -1


def begin_to_tell() -> None:
    """From now on, print() writes to standard error, and send_to_grader() writes to the former standard output."""
    global _descriptor
    sys.stdout.flush()
    _descriptor = os.dup(1)
    os.dup2(2, 1)


def send_to_grader(line: str) -> None:
    """Send one line."""
    os.write(_descriptor, f"{' '.join(line.splitlines())}\n".encode())
