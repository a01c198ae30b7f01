"""Reads a grading plan from its file, such as config/grading.yaml."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Optional, Type, TypeVar

import yaml

from aro_robocop_goto_as.param_loading import declared, from_dict, parameter
from robocop_hosting.errors import HostingError
from robocop_hosting.tree import read_bytes

from .checks import CHECKS
from .errors import PlanError
from .handout import Limits
from .packages import Packages
from .plan import CheckPlan, Plan
from .scenarios import MAX_SEED, MIDDLE, drawn

T = TypeVar("T")


@dataclass(frozen=True)
class _File:
    """The sections of the plan's file; a section in which everything is commented out may be left empty."""

    checks: dict = parameter()
    limits: Optional[dict] = None
    packages: Optional[dict] = None


def load(path: Path, seed: int = MIDDLE) -> Plan:
    """Read the plan and draw the scenarios; PlanError or ParameterError names the file and the mistake in it."""
    if not MIDDLE <= seed <= MAX_SEED:
        raise PlanError(f"--seed {seed}: expected a number from {MIDDLE} to {MAX_SEED}")
    try:
        raw = yaml.safe_load(read_bytes(path).decode("utf-8"))
    except HostingError as error:  # names the path
        raise PlanError(str(error)) from error
    except (ValueError, RecursionError, yaml.YAMLError) as error:
        raise PlanError(f"{path}: {error}") from error
    file = _loaded(_File, raw, f"{path}")
    checks = tuple(_check_plan(name, entry, f"{path}: checks") for name, entry in file.checks.items())
    limits = _loaded(Limits, file.limits or {}, f"{path}: limits")
    packages = _loaded(Packages, file.packages or {}, f"{path}: packages")
    return Plan(path, limits, drawn(seed), checks, seed, packages=packages)


def _loaded(cls: Type[T], raw: Any, where: str) -> T:
    """A dataclass from a part of the file; a known key without a value counts as absent."""
    if not isinstance(raw, dict):
        raise PlanError(f"{where}: expected keys with values, got {raw!r}")
    known = declared(cls)
    return from_dict(cls, {str(it): value for it, value in raw.items() if value is not None or it not in known}, where)


def _check_plan(name: str, raw: Any, where: str) -> CheckPlan:
    if name not in CHECKS:
        raise PlanError(f"{where}: unknown: {name}; known: {', '.join(sorted(CHECKS))}")
    return _loaded(CheckPlan, {**raw, "name": name} if isinstance(raw, dict) else raw, f"{where}: {name}")
