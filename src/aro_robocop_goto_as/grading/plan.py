"""config/grading.yaml -> scenarios, limits and points; nothing in it is repaired silently."""

import dataclasses
import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import AbstractSet, Any, Dict, List, Mapping, Sequence, Tuple

import yaml

from ..errors import GradingError
from ..geometry import Pose2D, Pose3D, compose3, lifted
from ..params import from_dict
from ..world import Box, Cylinder, Geometry, Obstacle, Plane, World

HEIGHT = 0.5  # [m] of obstacles, well above the lidar
SPACING = 40.0  # [m] between scenarios' sites: nothing of one is seen from another by a 10 m lidar
HEADING = 0.7  # [rad] of every site's odom frame in the world, so that the two can't be mistaken for one another
PARTS = ("server", "bridge")
FARTHEST = SPACING / 2.0  # [m] of anything from a scenario's start
START = "start"  # the node's start, whose record is there for every server
BRIDGE_SCENARIOS = ("no_server", "click", "replace", "frame")  # what a bridge is taken through is not in the file
STEPS = {"goal", "of", "ends", "for", "cancel", "place"}


@dataclass(frozen=True)
class Limits:
    """The figures that checks go by; config/grading.yaml says what each one means."""

    feedback_low: float = 7.0
    feedback_high: float = 35.0
    position_tolerance: float = 0.06
    angle_tolerance: float = 0.12
    turn_beyond: float = 0.16
    straight_within: float = 0.07
    driving: float = 0.02
    straight_turn: float = 0.35
    reached: float = 0.12
    abort_nearest: float = 0.2
    abort_farthest: float = 0.36
    preempt_within: float = 1.5
    stop_within: float = 1.0
    standing_v: float = 0.01
    standing_w: float = 0.05
    status_reports: int = 2
    status_span: float = 20.0
    stall: float = 8.0
    goal_time: float = 120.0
    wall_time: float = 60.0


@dataclass(frozen=True)
class Step:
    """One line of a server scenario's script."""

    goal: Tuple[float, ...] = ()  # [m] in odom, or ahead and left of the robot
    of: str = "odom"  # or robot
    ends: str = ""  # the ending to wait for
    run: float = 0.0  # [s] instead of waiting for an ending
    cancel: bool = False
    place: Tuple[float, ...] = ()  # x, y [m], yaw [rad] in odom's place at the start


@dataclass(frozen=True)
class Scenario:
    """One run from a fresh start."""

    name: str
    about: str
    steps: Tuple[Step, ...]
    obstacles: Tuple[Tuple[str, Tuple[float, ...]], ...] = ()
    odd_scan: bool = False


@dataclass(frozen=True)
class CheckPlan:
    """Which scenarios a check looks at, for how many points."""

    name: str
    part: str
    points: float
    extra: bool
    scenarios: Tuple[str, ...]


@dataclass(frozen=True)
class Plan:
    """All that is in the file."""

    limits: Limits
    scenarios: Tuple[Scenario, ...]
    checks: Tuple[CheckPlan, ...]

    def of_part(self, part: str) -> List[CheckPlan]:
        """Checks of the server or of the bridge."""
        return [check for check in self.checks if check.part == part]


def load(path: Path) -> Plan:
    """GradingError names the file and what is wrong in it; ParameterError likewise for the limits."""
    try:
        raw = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, yaml.YAMLError) as error:
        raise GradingError(f"{path}: {error}") from error
    keys = {"limits", "scenarios", "checks"}
    _expect(raw, keys, str(path), keys)
    for name, kind, words in (("limits", dict, "a mapping"), ("scenarios", list, "a list"),
                              ("checks", dict, "a mapping")):
        if not isinstance(raw[name], kind):
            raise GradingError(f"{path}: {name}: expected {words}, got {raw[name]!r}")
    limits = from_dict(Limits, raw["limits"], f"{path}: limits")
    for name, value in dataclasses.asdict(limits).items():
        if not 0.0 <= value < math.inf:
            raise GradingError(f"{path}: limits: {name}: expected a finite number of 0 or more, got {value!r}")
    scenarios = tuple(_scenario(entry, f"{path}: scenarios") for entry in raw["scenarios"])
    names = [scenario.name for scenario in scenarios]
    for name in names:
        if names.count(name) > 1 or name in (START, *BRIDGE_SCENARIOS):
            raise GradingError(f"{path}: scenarios: {name}: expected a name of its own")
    known = {"server": (START, *names), "bridge": BRIDGE_SCENARIOS}
    checks = tuple(_check(name, entry, known, f"{path}: checks") for name, entry in raw["checks"].items())
    return Plan(limits, scenarios, checks)


def _expect(raw: Any, known: AbstractSet[str], where: str, needed: AbstractSet[str] = frozenset()) -> None:
    if not isinstance(raw, Mapping):
        raise GradingError(f"{where}: expected keys {', '.join(sorted(known))}, got {raw!r}")
    for wrong, word in ((set(raw) - set(known), "unknown"), (set(needed) - set(raw), "missing")):
        if wrong:
            raise GradingError(
                f"{where}: {word}: {', '.join(sorted(map(str, wrong)))}; known: {', '.join(sorted(known))}"
            )


def _number(value: Any, where: str, least: float = 0.0, most: float = 1e6) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not least <= value <= most:
        raise GradingError(f"{where}: expected a number from {least:g} to {most:g}, got {value!r}")
    return float(value)


def _numbers(value: Any, count: int, where: str) -> Tuple[float, ...]:
    if not isinstance(value, list) or len(value) != count:
        raise GradingError(f"{where}: expected {count} numbers, got {value!r}")
    return tuple(_number(it, where, -FARTHEST, FARTHEST) for it in value)


def _list(value: Any, where: str, of: str) -> List[Any]:
    if not isinstance(value, list) or not value:
        raise GradingError(f"{where}: expected a list of {of}, got {value!r}")
    return value


def _scenario(raw: Any, where: str) -> Scenario:
    _expect(raw, {"name", "about", "script", "obstacles", "odd_scan"}, where, {"name", "about", "script"})
    if not isinstance(raw["name"], str) or not re.fullmatch(r"\w+", raw["name"]):
        raise GradingError(f"{where}: name: expected letters, digits and _, got {raw['name']!r}")
    where = f"{where}: {raw['name']}"
    obstacles = []
    for entry in _list(raw["obstacles"], f"{where}: obstacles", "boxes and cylinders") if "obstacles" in raw else []:
        _expect(entry, {"box", "cylinder"}, where)
        for kind, value in entry.items():
            numbers = _numbers(value, {"box": 5, "cylinder": 3}[kind], f"{where}: {kind}")
            if min(numbers[{"box": 3, "cylinder": 2}[kind]:]) <= 0.0:
                raise GradingError(f"{where}: {kind}: expected sizes above 0, got {value!r}")
            obstacles.append((kind, numbers))
    steps = tuple(_step(step, where) for step in _list(raw["script"], f"{where}: script", "steps"))
    for number, step in enumerate(steps):
        if step.cancel and not any(earlier.goal for earlier in steps[:number]):
            raise GradingError(f"{where}: cancel: expected a goal before it")
    return Scenario(raw["name"], str(raw["about"]), steps, tuple(obstacles), bool(raw.get("odd_scan", False)))


def _step(raw: Any, where: str) -> Step:
    _expect(raw, STEPS, where)
    if len({"goal", "cancel", "place"}.intersection(raw)) != 1:
        raise GradingError(f"{where}: expected one of goal, cancel and place in a step, got {raw!r}")
    if raw.get("of", "odom") not in ("odom", "robot"):
        raise GradingError(f"{where}: of: expected odom or robot, got {raw['of']!r}")
    if raw.get("ends", "SUCCEEDED") not in ("SUCCEEDED", "ABORTED", "PREEMPTED"):
        raise GradingError(f"{where}: ends: expected SUCCEEDED, ABORTED or PREEMPTED, got {raw['ends']!r}")
    return Step(
        goal=_numbers(raw["goal"], 2, f"{where}: goal") if "goal" in raw else (),
        of=raw.get("of", "odom"),
        ends=raw.get("ends", ""),
        run=_number(raw.get("for", 0.0), f"{where}: for"),
        cancel=bool(raw.get("cancel", False)),
        place=_numbers(raw["place"], 3, f"{where}: place") if "place" in raw else (),
    )


def _check(name: str, raw: Any, known: Mapping[str, Sequence[str]], where: str) -> CheckPlan:
    from .checks import CHECKS  # here, as checks go by this module's limits

    if name not in CHECKS:
        raise GradingError(f"{where}: unknown: {name}; known: {', '.join(sorted(CHECKS))}")
    where = f"{where}: {name}"
    _expect(raw, {"part", "points", "extra", "scenarios"}, where, {"part", "points", "scenarios"})
    if raw["part"] not in PARTS:
        raise GradingError(f"{where}: part: expected server or bridge, got {raw['part']!r}")
    scenarios = _list(raw["scenarios"], f"{where}: scenarios", "names")
    for scenario in scenarios:
        if scenario not in known[raw["part"]]:
            raise GradingError(f"{where}: scenarios: unknown for a {raw['part']}: {scenario!r}; known: "
                               f"{', '.join(known[raw['part']])}")
    points = _number(raw["points"], f"{where}: points")
    return CheckPlan(name, raw["part"], points, bool(raw.get("extra", False)), tuple(scenarios))


def site(index: int) -> Pose2D:
    """world_from_odom of a scenario at its start. Site 0 is the world's own origin, where no two frames differ."""
    return Pose2D() if index == 0 else Pose2D(SPACING * index, -15.0, HEADING)


def world_of(plan: Plan) -> World:
    """Every scenario's obstacles, each at its own site: scenario k at site k + 1, nothing at site 0."""
    obstacles = [Obstacle("ground/link/collision", Pose3D(), Plane((0.0, 0.0, 1.0)))]
    for index, scenario in enumerate(plan.scenarios, 1):
        for number, (kind, values) in enumerate(scenario.obstacles):
            yaw = values[2] if kind == "box" else 0.0
            pose = compose3(lifted(site(index)), lifted(Pose2D(values[0], values[1], yaw), HEIGHT / 2.0))
            obstacles.append(Obstacle(f"{scenario.name}/{number}/{kind}", pose, _geometry(kind, values)))
    return World("grading", tuple(obstacles), Pose2D(), (), "config/grading.yaml")


def _geometry(kind: str, values: Tuple[float, ...]) -> Geometry:
    return Box((values[3], values[4], HEIGHT)) if kind == "box" else Cylinder(values[2], HEIGHT)


def summary(plan: Plan) -> Dict[str, float]:
    """Points of each part, extra ones left out."""
    return {part: round(sum(it.points for it in plan.of_part(part) if not it.extra), 6) for part in PARTS}
