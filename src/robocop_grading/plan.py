"""Reads the grading plan (config/grading.yaml): limits, scenarios, and the checks with their points."""

import math
import random
import re
from dataclasses import MISSING, dataclass, fields, replace
from pathlib import Path
from typing import Any, List, Mapping, Optional, Sequence, Tuple, Type, TypeVar

import yaml

from aro_robocop_goto_as.errors import HostingError, PlanError
from aro_robocop_goto_as.geometry import Pose2D, Pose3D, compose, compose3, lifted
from aro_robocop_goto_as.param_loading import declared, from_dict, parameter, several
from aro_robocop_goto_as.shapes import Box, Cylinder, Geometry, Plane
from aro_robocop_goto_as.world.model import Obstacle, World

from .checks import CHECKS
from .files.tree import read_bytes
from .handout import Limits
from .packages import Packages

HEIGHT = 0.5  # [m] of obstacles, well above the lidar
SPACING = 40.0  # [m] between the scenarios' sites; more than twice the lidar's range of 10 m
HEADING = 0.7  # [rad] yaw of each site's odom frame in the world, so that confusing the two frames has an effect
PARTS = ("server", "bridge")
MAX_OFFSET = SPACING / 2.0  # [m] largest coordinate within a scenario
START = "start"  # the recording of the node's start; every server has one
BRIDGE_SCENARIOS = ("no_server", "click", "replace", "frame", "pending")  # fixed, not in the plan's file
MIDDLE = 0  # the seed with which every range stands for its middle
MAX_SEED = 999_999
DIGITS = 3  # of a drawn number after the point: [mm], [mrad], [ms]
_NUMBER = r"-?\d+(?:\.\d+)?"
_RANGE = re.compile(rf"({_NUMBER})\.\.({_NUMBER})", re.ASCII)

T = TypeVar("T")


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
        """Return whether there is not exactly one thing to do, in words."""
        things = sum(map(bool, (self.goal, self.cancel, self.place)))
        return [] if things == 1 else ["expected one of goal, cancel and place in a step"]


@dataclass(frozen=True)
class Push:
    """Once the robot is farther than `after` [m] from odom's origin, somebody moves it, whatever it is commanded."""

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
        """It seen from above, in odom: x, y, x, y, ... [m]."""
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
        """What it tests."""
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
        return round(sum(check.points for check in self.checks if not check.extra), 6)

    @property
    def extra(self) -> float:
        """The points of all checks that are extra."""
        return round(sum(check.points for check in self.checks if check.extra), 6)

    def examines(self, part: str, scenario: str = "") -> bool:
        """Return whether some check examines this part, or this scenario of it."""
        return any(check.part == part and scenario in ("", *check.scenarios) for check in self.checks)

    def scenarios_of(self, part: str) -> List[str]:
        """The scenarios that are run for a part, in their order; no check of ours examines a bridge's last one."""
        if part == "server":
            return [START, *(it.name for it in self.scenarios if self.examines(part, it.name))]
        examined = [n for n, name in enumerate(BRIDGE_SCENARIOS, 1) if self.is_whole or self.examines(part, name)]
        return list(BRIDGE_SCENARIOS[: max(examined, default=0)])

    def restricted(self, names: Sequence[str]) -> "Plan":
        """The plan with these checks only, if there are any; PlanError for a name that it does not have."""
        for name in names:
            if name not in {check.name for check in self.checks}:
                known = ", ".join(check.name for check in self.checks)
                raise PlanError(f"--only {name}: {self.path} has no such check; known: {known}")
        chosen = tuple(check for check in self.checks if check.name in names)
        return replace(self, checks=chosen, is_whole=False) if names else self


@dataclass(frozen=True)
class _File:
    """The sections of the plan's file; those in which all is commented out may be left empty."""

    scenarios: list = parameter()
    checks: dict = parameter()
    limits: Optional[dict] = None
    packages: Optional[dict] = None


@dataclass(frozen=True)
class _ScenarioEntry:
    """A scenario in the file."""

    name: str = parameter()
    about: str = parameter()
    script: list = parameter()
    obstacles: Optional[list] = None
    pushes: Optional[list] = None
    odd_scan: bool = False

    def conflicts(self) -> List[str]:
        """What is wrong with its name or its script, in words."""
        named = re.fullmatch(r"\w+", self.name) is not None
        problems = [] if named else [f"name: expected letters, digits and _, got {self.name!r}"]
        return problems + ([] if self.script else ["script: expected steps, got none"])


def load(path: Path, seed: int = MIDDLE) -> Plan:
    """Read the plan and draw its scenarios; PlanError or ParameterError names the file and the mistake in it.

    Seed 0 takes the middle of each range.
    """
    if not MIDDLE <= seed <= MAX_SEED:
        raise PlanError(f"--seed {seed}: expected a number from {MIDDLE} to {MAX_SEED}")
    try:
        raw = yaml.safe_load(read_bytes(path).decode("utf-8"))
    except (HostingError, ValueError, RecursionError, yaml.YAMLError) as error:
        raise PlanError(f"{path}: {error}") from error
    file = _loaded(_File, raw, f"{path}")
    scenarios = tuple(_scenario(entry, f"{path}: scenarios", seed) for entry in file.scenarios)
    names = [scenario.name for scenario in scenarios]
    for name in names:
        if names.count(name) > 1 or name in (START, *BRIDGE_SCENARIOS):
            raise PlanError(f"{path}: scenarios: {name}: expected a unique name that is not reserved")
    known = {"server": (START, *names), "bridge": BRIDGE_SCENARIOS}
    checks = tuple(_check_plan(name, entry, known, f"{path}: checks") for name, entry in file.checks.items())
    limits = _loaded(Limits, file.limits or {}, f"{path}: limits")
    packages = _loaded(Packages, file.packages or {}, f"{path}: packages")
    return Plan(path, limits, scenarios, checks, seed, packages=packages)


def _loaded(cls: Type[T], raw: Any, where: str) -> T:
    """A dataclass from a part of the file; a known key without a value counts as absent."""
    if not isinstance(raw, dict):
        raise PlanError(f"{where}: expected keys with values, got {raw!r}")
    known = declared(cls)
    return from_dict(cls, {str(it): value for it, value in raw.items() if value is not None or it not in known}, where)


def drawn(value: Any, numbers: Optional[random.Random], where: str) -> Any:
    """A value of the plan, with a number for each range LOW..HIGH in it: a drawn one, or the middle without `numbers`.

    PlanError if a range is empty.
    """
    if isinstance(value, dict):
        return {key: drawn(it, numbers, f"{where}: {key}") for key, it in value.items()}
    if isinstance(value, list):
        return [drawn(it, numbers, where) for it in value]
    match = _RANGE.fullmatch(value) if isinstance(value, str) else None
    if match is None:
        return value
    low, high = map(float, match.groups())
    if low > high:
        raise PlanError(f"{where}: {value}: expected LOW..HIGH, with LOW not above HIGH")
    return round((low + high) / 2.0 if numbers is None else numbers.uniform(low, high), DIGITS)


def _scenario(raw: Any, where: str, seed: int) -> Scenario:
    entry = _loaded(_ScenarioEntry, raw, where)
    where, numbers = f"{where}: {entry.name}", None if seed == MIDDLE else random.Random(f"{seed}/{entry.name}")
    # In this order, by which each seed has its numbers.
    obstacles = drawn(entry.obstacles or [], numbers, where)
    script = drawn(entry.script, numbers, where)
    pushes = drawn(entry.pushes or [], numbers, where)
    blocks = tuple(_loaded(Block, it, f"{where}: obstacles") for it in obstacles)
    steps = tuple(_loaded(Step, step, f"{where}: script") for step in script)
    for number, step in enumerate(steps):
        if step.cancel and not any(earlier.goal for earlier in steps[:number]):
            raise PlanError(f"{where}: cancel: expected an earlier goal in the script")
    moved = tuple(_push(push, f"{where}: pushes") for push in pushes)
    return Scenario(entry.name, entry.about, steps, blocks, entry.odd_scan, moved)


def _push(raw: Any, where: str) -> Push:
    names = [spec.name for spec in fields(Push)]
    if not isinstance(raw, list) or len(raw) != len(names):
        raise PlanError(f"{where}: expected {len(names)} numbers ({', '.join(names)}), got {raw!r}")
    return from_dict(Push, dict(zip(names, raw)), where)


def _check_plan(name: str, raw: Any, known: Mapping[str, Sequence[str]], where: str) -> CheckPlan:
    if name not in CHECKS:
        raise PlanError(f"{where}: unknown: {name}; known: {', '.join(sorted(CHECKS))}")
    check = _loaded(CheckPlan, {**raw, "name": name} if isinstance(raw, dict) else raw, f"{where}: {name}")
    for scenario in check.scenarios:
        if scenario not in known[check.part]:
            names = ", ".join(known[check.part])
            raise PlanError(f"{where}: {name}: scenarios: unknown for a {check.part}: {scenario!r}; known: {names}")
    return check


def site(index: int) -> Pose2D:
    """world_from_odom at the start of a scenario. Site 0 is the world's origin, where all frames coincide."""
    return Pose2D() if index == 0 else Pose2D(SPACING * index, -15.0, HEADING)


def world_of(plan: Plan) -> World:
    """The obstacles of all scenarios: those of the first one at site 1, and so on; site 0 is empty."""
    obstacles = [Obstacle("ground/link/collision", Pose3D(), Plane((0.0, 0.0, 1.0)))]
    for index, scenario in enumerate(plan.scenarios, 1):
        for number, block in enumerate(scenario.obstacles):
            pose = compose3(lifted(site(index)), lifted(block.pose, HEIGHT / 2.0))
            obstacles.append(Obstacle(f"{scenario.name}/{number}/block", pose, block.geometry))
    return World("grading", tuple(obstacles), Pose2D(), (), "config/grading.yaml")
