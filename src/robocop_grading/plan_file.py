"""Reads a grading plan from its file (config/grading.yaml), and draws the numbers of its scenarios."""

import random
import re
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, List, Mapping, Optional, Sequence, Type, TypeVar

import yaml

from aro_robocop_goto_as.param_loading import declared, from_dict, parameter
from robocop_hosting.errors import HostingError
from robocop_hosting.tree import read_bytes

from .checks import CHECKS
from .errors import PlanError
from .handout import Limits
from .packages import Packages
from .plan import AGAIN, BRIDGE_SCENARIOS, MIDDLE, START, Block, CheckPlan, Plan, Push, Scenario, Step

MAX_SEED = 999_999
DIGITS = 3  # of a drawn number after the point: [mm], [mrad], [ms]
_NUMBER = r"-?\d+(?:\.\d+)?"
_RANGE = re.compile(rf"({_NUMBER})\.\.({_NUMBER})", re.ASCII)

T = TypeVar("T")


@dataclass(frozen=True)
class _File:
    """The sections of the plan's file; a section in which everything is commented out may be left empty."""

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

    Seed 0 takes the middle of each range, and the file's order; another seed draws the order, too.
    """
    if not MIDDLE <= seed <= MAX_SEED:
        raise PlanError(f"--seed {seed}: expected a number from {MIDDLE} to {MAX_SEED}")
    try:
        raw = yaml.safe_load(read_bytes(path).decode("utf-8"))
    except HostingError as error:  # names the path
        raise PlanError(str(error)) from error
    except (ValueError, RecursionError, yaml.YAMLError) as error:
        raise PlanError(f"{path}: {error}") from error
    file = _loaded(_File, raw, f"{path}")
    scenarios = [_scenario(entry, f"{path}: scenarios", seed) for entry in file.scenarios]
    if seed != MIDDLE:  # the node was started elsewhere only before the first scenario
        scenarios[1:] = random.Random(seed).sample(scenarios[1:], len(scenarios[1:]))
    names = [scenario.name for scenario in scenarios]
    for name in names:
        if names.count(name) > 1 or name in (START, *BRIDGE_SCENARIOS) or name.endswith(AGAIN):
            raise PlanError(f"{path}: scenarios: {name}: expected a unique name that is not reserved")
    known = {"server": (START, *names), "bridge": BRIDGE_SCENARIOS}
    checks = tuple(_check_plan(name, entry, known, f"{path}: checks") for name, entry in file.checks.items())
    limits = _loaded(Limits, file.limits or {}, f"{path}: limits")
    packages = _loaded(Packages, file.packages or {}, f"{path}: packages")
    return Plan(path, limits, tuple(scenarios), checks, seed, packages=packages)


def _loaded(cls: Type[T], raw: Any, where: str) -> T:
    """A dataclass from a part of the file; a known key without a value counts as absent."""
    if not isinstance(raw, dict):
        raise PlanError(f"{where}: expected keys with values, got {raw!r}")
    known = declared(cls)
    return from_dict(cls, {str(it): value for it, value in raw.items() if value is not None or it not in known}, where)


def drawn(value: Any, numbers: Optional[random.Random], where: str) -> Any:
    """A value of the plan, with a number for each range LOW..HIGH in it: drawn, or the middle without `numbers`.

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
