"""What a grading plan consists of: limits, scenarios, and the checks with their points."""

import math
from dataclasses import MISSING, dataclass, replace
from pathlib import Path
from typing import Any, Iterable, List, Sequence, Tuple

from aro_robocop_goto_as.geometry import Pose2D, compose
from aro_robocop_goto_as.param_loading import parameter, several
from aro_robocop_goto_as.shapes import Box, Cylinder, Geometry

from .checks import CHECKS
from .errors import PlanError
from .handout import Limits
from .packages import Packages

HEIGHT = 0.5  # [m] of obstacles, well above the lidar
PARTS = ("server", "bridge")
MAX_OFFSET = 20.0  # [m] largest coordinate within a scenario
AGAIN = "_again"  # ends the name of a scenario's repetition with a new node
START = "start"  # the recording of the node's start; every server has one
BRIDGE_SCENARIOS = ("no_server", "click", "replace", "frame", "pending")  # fixed, not in the plan's file
TICK = 0.1  # [s] of a run
MIDDLE = 0  # the seed with which every range stands for its middle


def total(points: Iterable[float]) -> float:
    """The sum of points without rounding errors."""
    return round(sum(points, 0.0), 6)


def _numbers(count: int) -> Any:
    """A field for coordinates and sizes."""
    return several(count, -MAX_OFFSET, MAX_OFFSET)


@dataclass(frozen=True)
class Step:
    """One line of a server scenario's script."""

    goal: Tuple[float, ...] = _numbers(2)  # x, y [m] in the frame `of`
    of: str = parameter("odom", choices=("odom", "robot"))  # robot: x ahead, y left
    ends: str = parameter("", choices=("SUCCEEDED", "ABORTED", "PREEMPTED"))  # the terminal state to wait for
    run: float = parameter(0.0, 0.0, 1e6, key="for")  # [s] time to let pass instead of waiting for a terminal state
    cancel: bool = False
    place: Tuple[float, ...] = _numbers(3)  # x, y [m], yaw [rad] in the odom frame of the scenario's start

    def conflicts(self) -> List[str]:
        """What is wrong, in words, unless there is exactly one thing to do, and to wait for after a goal."""
        things = sum(map(bool, (self.goal, self.cancel, self.place)))
        if things != 1:
            return ["expected one of goal, cancel and place in a step"]
        if self.goal and (bool(self.ends) == bool(self.run) or 0.0 < self.run < TICK):
            return [f"expected `ends`, or `for` of {TICK:g} s or more, after a goal"]
        return []


@dataclass(frozen=True)
class Push:
    """A push: once the robot is farther than `after` [m] from odom's origin, it is moved, whatever is commanded."""

    after: float
    v: float  # [m/s]
    w: float  # [rad/s]
    seconds: float


@dataclass(frozen=True)
class Block:
    """An obstacle that stands on the floor, in odom at the scenario's start."""

    box: Tuple[float, ...] = _numbers(5)  # x, y [m], yaw [rad], length and width [m]
    cylinder: Tuple[float, ...] = _numbers(3)  # x, y and radius [m]

    def conflicts(self) -> List[str]:
        """What is wrong with its shape, in words."""
        if bool(self.box) == bool(self.cylinder):
            return ["expected one of box and cylinder"]
        sizes = self.box[3:] or self.cylinder[2:]
        return [] if min(sizes) > 0.0 else [f"expected sizes above 0, got {sizes}"]

    @property
    def pose(self) -> Pose2D:
        """odom_from_block."""
        return Pose2D(*self.box[:3]) if self.box else Pose2D(*self.cylinder[:2])

    @property
    def geometry(self) -> Geometry:
        """Its shape."""
        return Box((self.box[3], self.box[4], HEIGHT)) if self.box else Cylinder(self.cylinder[2], HEIGHT)

    @property
    def outline(self) -> Tuple[float, ...]:
        """The block's outline from above, in odom: x, y, x, y, ... [m]."""
        if self.box:
            length, width = self.box[3:]
            corners = [(sx * length / 2, sy * width / 2) for sx, sy in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
        else:
            radius = self.cylinder[2]
            corners = [(radius * math.cos(n * math.pi / 8), radius * math.sin(n * math.pi / 8)) for n in range(17)]
        return tuple(round(it, 4) for corner in corners for it in compose(self.pose, Pose2D(*corner))[:2])


@dataclass(frozen=True)
class Scenario:
    """A script that starts with the robot at odom's origin."""

    name: str
    about: str
    steps: Tuple[Step, ...]
    obstacles: Tuple[Block, ...] = ()
    odd_scan: bool = False
    pushes: Tuple[Push, ...] = ()


@dataclass(frozen=True)
class CheckPlan:
    """The points of a check and the scenarios that it examines."""

    name: str
    part: str = parameter(choices=PARTS)
    points: float = parameter(low=0.0, high=1e6)
    scenarios: Tuple[str, ...] = several(default=MISSING)
    extra: bool = False

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
    seed: int = MIDDLE  # with which the scenarios' numbers were drawn
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

    def examines(self, part: str, scenario: str = "") -> bool:
        """Return whether some check examines this part, or this scenario of it."""
        return any(check.part == part and scenario in ("", *check.scenarios) for check in self.checks)

    def scenarios_of(self, part: str) -> List[str]:
        """The scenarios that are run for a part, in their order; no check examines the last scenario of a bridge."""
        if part == "server":
            return [START, *(it.name for it in self.scenarios if self.examines(part, it.name))]
        examined = [n for n, name in enumerate(BRIDGE_SCENARIOS, 1) if self.is_whole or self.examines(part, name)]
        return list(BRIDGE_SCENARIOS[: max(examined, default=0)])

    def restricted(self, names: Sequence[str]) -> "Plan":
        """The plan with only these checks, or the whole plan without names; PlanError for an unknown check."""
        for name in names:
            if name not in {check.name for check in self.checks}:
                known = ", ".join(check.name for check in self.checks)
                raise PlanError(f"--only {name}: {self.path} has no such check; known: {known}")
        chosen = tuple(check for check in self.checks if check.name in names)
        return replace(self, checks=chosen, is_whole=False) if names else self
