"""What a run is to do."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable, Mapping, Tuple

from ..plan import Plan


@dataclass(frozen=True)
class Job:
    """The scenarios of one part of a hand-in that the plan's checks examine."""

    part: str
    command: Tuple[str, ...]  # of the node, in the sandbox
    environment: Mapping[str, str]
    folder: Path  # the node's
    out: Path  # for bags
    plan: Plan
    parameters: Mapping[str, Any]  # on the parameter server
    cpu_time: float  # [s] of the node and its children together
    budget: float  # [s, wall] for all scenarios
    on_scenario: Callable[[str], object]  # called with the name of each scenario that begins
