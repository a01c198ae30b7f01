"""The order that a session gets from the runner, as a file."""

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
