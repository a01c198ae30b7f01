"""What a grading plan consists of: limits, the checks with their points, and the scenarios that they examine."""

import hashlib
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Iterable, List, Sequence, Tuple

from aro_robocop_goto_as.param_loading import parameter

from .checks import CHECKS
from .errors import PlanError
from .handout import Limits
from .packages import Packages
from .scenarios import BRIDGE_SCENARIOS, MIDDLE, START, Scenario

PARTS = ("server", "bridge")
AGAIN = "_again"  # ends the name of a scenario's repetition with a new node
TICK = 0.1  # [s] of a run


def total(points: Iterable[float]) -> float:
    """The sum of points without rounding errors."""
    return round(sum(points, 0.0), 6)


@dataclass(frozen=True)
class CheckPlan:
    """The points of a check."""

    name: str
    points: float = parameter(low=0.0, high=1e6)
    extra: bool = False

    @property
    def part(self) -> str:
        """The part that the check examines."""
        return CHECKS[self.name].part

    @property
    def scenarios(self) -> Tuple[str, ...]:
        """The scenarios that the check examines."""
        return CHECKS[self.name].scenarios

    @property
    def contract(self) -> str:
        """The contract that the check tests."""
        return CHECKS[self.name].contract


@dataclass(frozen=True)
class Plan:
    """The contents of the plan's file."""

    path: Path
    limits: Limits
    scenarios: Tuple[Scenario, ...]
    checks: Tuple[CheckPlan, ...]
    seed: int = MIDDLE  # with which the scenarios were drawn
    is_whole: bool = True  # not only some of the file's checks
    packages: Packages = Packages()  # that the lab has in addition

    @property
    def points(self) -> float:
        """The points of all checks that are not extra."""
        return total(check.points for check in self.checks if not check.extra)

    @property
    def extra(self) -> float:
        """The points of all checks that are extra."""
        return total(check.points for check in self.checks if check.extra)

    @property
    def outcomes(self) -> str:
        """A text that changes with whatever outcomes depend on: with all but points."""
        checks = tuple(replace(check, points=0.0, extra=False) for check in self.checks)
        return hashlib.sha256(repr(replace(self, path=Path(), checks=checks)).encode()).hexdigest()

    def examines(self, part: str, scenario: str = "") -> bool:
        """Return whether some check examines this part, or this scenario of it."""
        return any(check.part == part and scenario in ("", *check.scenarios) for check in self.checks)

    def scenarios_of(self, part: str) -> List[str]:
        """The scenarios of a part, in their order: a bridge's up to the last one that a check examines."""
        if part == "server":
            return [START, *(it.name for it in self.scenarios if self.examines(part, it.name))]
        examined = [n for n, name in enumerate(BRIDGE_SCENARIOS, 1) if self.examines(part, name)]
        return list(BRIDGE_SCENARIOS[: max(examined, default=0)])

    def restricted(self, names: Sequence[str]) -> "Plan":
        """The plan with only these checks, or the whole plan without names; PlanError for an unknown check."""
        for name in names:
            if name not in {check.name for check in self.checks}:
                known = ", ".join(check.name for check in self.checks)
                raise PlanError(f"--only {name}: {self.path} has no such check; known: {known}")
        chosen = tuple(check for check in self.checks if check.name in names)
        return replace(self, checks=chosen, is_whole=False) if names else self
