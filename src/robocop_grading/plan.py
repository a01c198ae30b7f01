"""Reads the grading plan (config/grading.yaml): limits, scenarios, and the checks with their points."""

import dataclasses
import math
import random
import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import AbstractSet, Any, List, Mapping, Optional, Sequence, Tuple

from aro_robocop_goto_as.errors import PlanError
from aro_robocop_goto_as.geometry import Pose2D, Pose3D, compose, compose3, lifted
from aro_robocop_goto_as.param_loading import from_dict
from aro_robocop_goto_as.world.model import Box, Cylinder, Geometry, Obstacle, Plane, World

from .checks import CHECKS
from .handout import Limits
from .packages import NAME, Packages
from .texts import ENGLISH, Texts, read_yaml

HEIGHT = 0.5  # [m] of obstacles, well above the lidar
SPACING = 40.0  # [m] between the scenarios' sites; more than twice the lidar's range of 10 m
HEADING = 0.7  # [rad] yaw of each site's odom frame in the world, so that confusing the two frames has an effect
PARTS = ("server", "bridge")
FARTHEST = SPACING / 2.0  # [m] largest coordinate within a scenario
START = "start"  # the recording of the node's start; every server has one
BRIDGE_SCENARIOS = ("no_server", "click", "replace", "frame", "pending")  # fixed, not in the plan's file
SECTIONS = {"limits": dict, "scenarios": list, "checks": dict}
STEP_KEYS = {"goal", "of", "ends", "for", "cancel", "place"}
MIDDLE = 0  # the seed with which every range stands for its middle
LARGEST_SEED = 999_999
DRAWN = "number or a range LOW..HIGH"
DIGITS = 3  # of a drawn number after the point: [mm], [mrad], [ms]
_NUMBER = r"-?\d+(?:\.\d+)?"
_RANGE = re.compile(rf"({_NUMBER})\.\.({_NUMBER})", re.ASCII)


@dataclass(frozen=True)
class Step:
    """One line of a server scenario's script."""

    goal: Tuple[float, ...] = ()  # x, y [m] in the frame `of`
    of: str = "odom"  # odom, or robot (x ahead, y left)
    ends: str = ""  # the terminal state to wait for
    run: float = 0.0  # [s] time to let pass instead of waiting for a terminal state
    cancel: bool = False
    place: Tuple[float, ...] = ()  # x, y [m], yaw [rad] in the odom frame of the scenario's start


@dataclass(frozen=True)
class Push:
    """Once the robot is farther than `after` [m] from odom's origin, somebody moves it, whatever it is commanded."""

    after: float
    v: float  # [m/s]
    w: float  # [rad/s]
    seconds: float


@dataclass(frozen=True)
class Block:
    """An obstacle that stands on the floor: a box or a cylinder."""

    kind: str  # box or cylinder
    pose: Pose2D  # odom_from_block at the scenario's start
    sizes: Tuple[float, ...]  # [m] length and width of a box, radius of a cylinder

    @property
    def geometry(self) -> Geometry:
        """Its shape."""
        return Box((self.sizes[0], self.sizes[1], HEIGHT)) if self.kind == "box" else Cylinder(self.sizes[0], HEIGHT)

    @property
    def outline(self) -> Tuple[float, ...]:
        """It seen from above, in odom: x, y, x, y, ... [m]."""
        if self.kind == "box":
            length, width = self.sizes
            corners = [(sx * length / 2, sy * width / 2) for sx, sy in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
        else:
            (radius,) = self.sizes
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
    part: str
    points: float
    extra: bool
    scenarios: Tuple[str, ...]


@dataclass(frozen=True)
class Plan:
    """The contents of the plan's file."""

    path: Path
    limits: Limits
    scenarios: Tuple[Scenario, ...]
    checks: Tuple[CheckPlan, ...]
    seed: int = MIDDLE  # with which the scenarios' numbers were drawn
    texts: Texts = ENGLISH
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

    def contract(self, check: str) -> str:
        """What a check tests, in the language of the texts."""
        return self.texts.told(CHECKS[check].contract)

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


def load(path: Path, seed: int = MIDDLE, texts: Texts = ENGLISH) -> Plan:
    """Read the plan and draw its scenarios; PlanError or ParameterError (limits) names the file and the mistake in it.

    Seed 0 takes the middle of each range.
    """
    if not MIDDLE <= seed <= LARGEST_SEED:
        raise PlanError(f"--seed {seed}: expected a number from {MIDDLE} to {LARGEST_SEED}")
    raw = read_yaml(path)
    _expect(raw, {*SECTIONS, "packages"}, str(path), set(SECTIONS))
    raw = {**raw, "limits": {} if raw["limits"] is None else raw["limits"]}  # null: all are commented out
    for name, kind in SECTIONS.items():
        if not isinstance(raw[name], kind):
            words = "a list" if kind is list else "a mapping"
            raise PlanError(f"{path}: {name}: expected {words}, got {raw[name]!r}")
    limits = from_dict(Limits, raw["limits"], f"{path}: limits")
    for name, value in dataclasses.asdict(limits).items():
        if not 0.0 <= value < math.inf:
            raise PlanError(f"{path}: limits: {name}: expected a finite number of 0 or more, got {value!r}")
    scenarios = tuple(_scenario(entry, f"{path}: scenarios", seed) for entry in raw["scenarios"])
    names = [scenario.name for scenario in scenarios]
    for name in names:
        if names.count(name) > 1 or name in (START, *BRIDGE_SCENARIOS):
            raise PlanError(f"{path}: scenarios: {name}: expected a unique name that is not reserved")
    known = {"server": (START, *names), "bridge": BRIDGE_SCENARIOS}
    checks = tuple(_check_plan(name, entry, known, f"{path}: checks") for name, entry in raw["checks"].items())
    packages = _packages(raw.get("packages"), f"{path}: packages")
    return Plan(path, limits, scenarios, checks, seed, texts, packages=packages)


def _expect(raw: Any, known: AbstractSet[str], where: str, needed: AbstractSet[str] = frozenset()) -> None:
    if not isinstance(raw, Mapping):
        raise PlanError(f"{where}: expected keys {', '.join(sorted(known))}, got {raw!r}")
    for wrong, word in ((set(raw) - set(known), "unknown"), (set(needed) - set(raw), "missing")):
        if wrong:
            raise PlanError(f"{where}: {word}: {', '.join(sorted(map(str, wrong)))}; known: {', '.join(sorted(known))}")


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


def _number(value: Any, where: str, least: float = 0.0, most: float = 1e6, kind: str = "number") -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not least <= value <= most:
        raise PlanError(f"{where}: expected a {kind} from {least:g} to {most:g}, got {value!r}")
    return float(value)


def _numbers(value: Any, count: int, where: str) -> Tuple[float, ...]:
    if not isinstance(value, list) or len(value) != count:
        raise PlanError(f"{where}: expected {count} numbers, got {value!r}")
    return tuple(_number(number, where, -FARTHEST, FARTHEST, DRAWN) for number in value)


def _list(value: Any, where: str, of: str) -> List[Any]:
    if not isinstance(value, list) or not value:
        raise PlanError(f"{where}: expected a list of {of}, got {value!r}")
    return value


def _one_of(words: Sequence[str], value: Any, where: str) -> str:
    if value not in words:
        raise PlanError(f"{where}: expected {', '.join(words[:-1])} or {words[-1]}, got {value!r}")
    return str(value)


def _scenario(raw: Any, where: str, seed: int) -> Scenario:
    _expect(raw, {"name", "about", "script", "obstacles", "odd_scan", "pushes"}, where, {"name", "about", "script"})
    if not isinstance(raw["name"], str) or not re.fullmatch(r"\w+", raw["name"]):
        raise PlanError(f"{where}: name: expected letters, digits and _, got {raw['name']!r}")
    where, numbers = f"{where}: {raw['name']}", None if seed == MIDDLE else random.Random(f"{seed}/{raw['name']}")
    raw = {**raw, **{key: drawn(raw[key], numbers, where) for key in ("obstacles", "script", "pushes") if key in raw}}
    obstacles = []
    for entry in _list(raw["obstacles"], f"{where}: obstacles", "boxes and cylinders") if "obstacles" in raw else []:
        _expect(entry, {"box", "cylinder"}, where)
        for kind, value in entry.items():
            sizes = _numbers(value, {"box": 5, "cylinder": 3}[kind], f"{where}: {kind}")
            place = sizes[: {"box": 3, "cylinder": 2}[kind]]
            obstacles.append(Block(kind, Pose2D(*place), sizes[len(place) :]))
            if min(obstacles[-1].sizes) <= 0.0:
                raise PlanError(f"{where}: {kind}: expected sizes above 0, got {value!r}")
    steps = tuple(_step(step, where) for step in _list(raw["script"], f"{where}: script", "steps"))
    for number, step in enumerate(steps):
        if step.cancel and not any(earlier.goal for earlier in steps[:number]):
            raise PlanError(f"{where}: cancel: expected an earlier goal in the script")
    pushes = _list(raw["pushes"], f"{where}: pushes", "pushes") if "pushes" in raw else []
    return Scenario(
        raw["name"],
        str(raw["about"]),
        steps,
        tuple(obstacles),
        bool(raw.get("odd_scan", False)),
        tuple(Push(*_numbers(push, 4, f"{where}: pushes")) for push in pushes),
    )


def _step(raw: Any, where: str) -> Step:
    _expect(raw, STEP_KEYS, where)
    if len({"goal", "cancel", "place"}.intersection(raw)) != 1:
        raise PlanError(f"{where}: expected one of goal, cancel and place in a step, got {raw!r}")
    return Step(
        goal=_numbers(raw["goal"], 2, f"{where}: goal") if "goal" in raw else (),
        of=_one_of(("odom", "robot"), raw.get("of", "odom"), f"{where}: of"),
        ends=_one_of(("SUCCEEDED", "ABORTED", "PREEMPTED"), raw["ends"], f"{where}: ends") if "ends" in raw else "",
        run=_number(raw.get("for", 0.0), f"{where}: for", kind=DRAWN),
        cancel=bool(raw.get("cancel", False)),
        place=_numbers(raw["place"], 3, f"{where}: place") if "place" in raw else (),
    )


def _packages(raw: Any, where: str) -> Packages:
    if raw is None:  # all are commented out
        return Packages()
    _expect(raw, {"debian", "pypi"}, where)
    lists = {kind: _list(names, f"{where}: {kind}", "names") for kind, names in raw.items()}
    for name in (it for names in lists.values() for it in names):
        if not isinstance(name, str) or not re.fullmatch(NAME, name, re.ASCII):
            raise PlanError(f"{where}: expected the name of a package, got {name!r}")
    return Packages(**{kind: tuple(names) for kind, names in lists.items()})


def _check_plan(name: str, raw: Any, known: Mapping[str, Sequence[str]], where: str) -> CheckPlan:
    if name not in CHECKS:
        raise PlanError(f"{where}: unknown: {name}; known: {', '.join(sorted(CHECKS))}")
    where = f"{where}: {name}"
    _expect(raw, {"part", "points", "extra", "scenarios"}, where, {"part", "points", "scenarios"})
    part = _one_of(PARTS, raw["part"], f"{where}: part")
    scenarios = _list(raw["scenarios"], f"{where}: scenarios", "names")
    for scenario in scenarios:
        if scenario not in known[part]:
            names = ", ".join(known[part])
            raise PlanError(f"{where}: scenarios: unknown for a {part}: {scenario!r}; known: {names}")
    points = _number(raw["points"], f"{where}: points")
    return CheckPlan(name, part, points, bool(raw.get("extra", False)), tuple(scenarios))


def site(index: int) -> Pose2D:
    """world_from_odom at the start of a scenario. Site 0 is the world's origin, where all frames coincide."""
    return Pose2D() if index == 0 else Pose2D(SPACING * index, -15.0, HEADING)


def world_of(plan: Plan) -> World:
    """The obstacles of all scenarios: those of the first one at site 1, and so on; site 0 is empty."""
    obstacles = [Obstacle("ground/link/collision", Pose3D(), Plane((0.0, 0.0, 1.0)))]
    for index, scenario in enumerate(plan.scenarios, 1):
        for number, block in enumerate(scenario.obstacles):
            pose = compose3(lifted(site(index)), lifted(block.pose, HEIGHT / 2.0))
            obstacles.append(Obstacle(f"{scenario.name}/{number}/{block.kind}", pose, block.geometry))
    return World("grading", tuple(obstacles), Pose2D(), (), "config/grading.yaml")
