"""Another checkout's simulator and this one, measured alternately: the ratios of their figures."""

import json
import os
import subprocess
import sys
from dataclasses import asdict, dataclass, field
from pathlib import Path
from statistics import median
from typing import Dict, List, Optional, Sequence

import rospy

from ..errors import BenchError
from .cases import Case
from .measure import simulate
from .processes import own_ros
from .report import Conditions, aligned, spread
from .results import Measured, Run

FAST, PACED = 0.0, 1.0  # real-time factors
SETUP_TIMEOUT = 1800.0  # [s, wall] for `./robocop shell` of the other checkout, which may have to build it first
FIGURES = {"factor": "factor", "cpu_ms": "CPU at 1", "memory_mb": "memory", "first_scan_s": "first scan"}


@dataclass(frozen=True)
class Checkout:
    """Where a checkout's programs are, and the environment of its workspace."""

    programs: Path
    variables: Dict[str, str]

    def environment(self) -> Dict[str, str]:
        """Its workspace with the ROS master of this measurement."""
        ros = {name: value for name, value in os.environ.items() if name.startswith("ROS_") and "PACKAGE" not in name}
        workspace = {name: value for name, value in self.variables.items() if name not in ("ROS_IP", "ROS_NAMESPACE")}
        return {**workspace, **ros}


@dataclass
class Comparison:
    """A case with the measurements of both checkouts, or the reason why it is left out."""

    case: Case
    other: Measured
    this: Measured
    left_out: Optional[str] = None
    ratios: Dict[str, List[float]] = field(default_factory=dict)  # this / other, figure by figure

    def add_ratios(self) -> None:
        """From the figures of both: repeats are compared in pairs, as they were measured one after the other."""
        others, these = self.other.figures(), self.this.figures()
        self.ratios = {name: [new / old for new, old in zip(these[name], others[name])] for name in FIGURES}

    def cells(self) -> List[str]:
        """Its row of the table."""
        others, these = self.other.figures(), self.this.figures()
        cells = [self.case.name]
        for name in FIGURES:
            cells += [f"{median(others[name]):.3g} -> {median(these[name]):.3g}", spread(self.ratios[name], 2)]
        return [*cells, f"{self.other.lost} -> {self.this.lost}"]


def other_checkout(root: Path) -> Checkout:
    """A checkout as its own `./robocop shell` sets it up; BenchError when it can't be."""
    robocop = root / "robocop"
    if not robocop.is_file():
        raise BenchError(f"--against {root}: expected a checkout of this project, but {robocop} is missing")
    try:
        done = subprocess.run(
            [str(robocop.absolute()), "shell", "env", "-0"],
            env=_without_own_workspace(os.environ),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            text=True,
            timeout=SETUP_TIMEOUT,
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise BenchError(f"--against {root}: {error}") from error
    variables = dict(entry.split("=", 1) for entry in done.stdout.split("\0") if "=" in entry)
    if done.returncode != 0 or "ROBOCOP_WS" not in variables:
        raise BenchError(f"--against {root}: its ./robocop shell failed with status {done.returncode}")
    return Checkout(Path(variables["ROBOCOP_WS"]) / "lib" / "aro_robocop_goto_as", variables)


def _without_own_workspace(environment: "os._Environ[str]") -> Dict[str, str]:
    """The environment as it was before this checkout's workspace was sourced."""
    state = environment.get("ROBOCOP_STATE")
    cleaned = {}
    for name, value in environment.items():
        if not name.startswith("ROBOCOP_"):
            entries = value.split(os.pathsep)
            kept = [entry for entry in entries if not state or not entry.startswith(state + os.sep)]
            if kept:
                cleaned[name] = os.pathsep.join(kept)
    return cleaned


def compare(cases: Sequence[Case], other: Checkout, seconds: float, repeats: int) -> List[Comparison]:
    """Measure every case on both checkouts in turn, `repeats` times; a case that fails is left out from then on."""
    this = Checkout(Path(sys.argv[0]).absolute().parent, dict(os.environ))
    comparisons = [Comparison(case, Measured(case), Measured(case)) for case in cases]
    with own_ros() as directory:
        rospy.init_node("robocop_bench", disable_signals=True)
        for repeat in range(repeats):
            for comparison in comparisons:
                pair = [("the other checkout", other, comparison.other), ("this checkout", this, comparison.this)]
                for name, checkout, measured in pair if repeat % 2 == 0 else reversed(pair):
                    if comparison.left_out is None:
                        print(
                            f"robocop bench: {comparison.case.name}, {repeat + 1} of {repeats}, {name}", file=sys.stderr
                        )
                        comparison.left_out = _measure(name, checkout, measured, seconds, directory)
        rospy.signal_shutdown("done")
    for comparison in comparisons:
        comparison.add_ratios()
    return comparisons


def _measure(name: str, checkout: Checkout, measured: Measured, seconds: float, directory: Path) -> Optional[str]:
    """Add a repeat, or return why there is none."""
    try:
        fastest, paced = (
            simulate(measured.case, factor, seconds, checkout.programs, directory, checkout.environment())
            for factor in (FAST, PACED)
        )
    except BenchError as error:
        return f"{name}: {error}"
    measured.fastest.append(fastest)
    measured.paced.append(paced)
    return None


def table(comparisons: Sequence[Comparison], other: Path, where: Conditions) -> str:
    """All of it as text."""
    head = ["case"]
    for title in FIGURES.values():
        head += [title, "ratio"]
    rows = [comparison.cells() for comparison in comparisons if comparison.left_out is None]
    lines = [
        *where.lines(),
        f"{other} -> this checkout, measured alternately; CPU [ms per simulated s], memory [MB], first scan [s].",
        "",
        *aligned([[*head, "lost"], *rows]),
    ]
    left_out = [f"{one.case.name} left out: {one.left_out}" for one in comparisons if one.left_out is not None]
    notes = [note for one in comparisons for note in (*one.other.notes(), *one.this.notes())]
    return "\n".join([*lines, *[""] * bool(left_out or notes), *left_out, *notes])


def as_json(comparisons: Sequence[Comparison], other: Path, where: Conditions) -> str:
    """All of it as JSON, with every single run."""

    def runs(measured: Measured) -> Dict[str, List[Dict[str, float]]]:
        kinds: Dict[str, List[Run]] = {"fastest": measured.fastest, "paced": measured.paced}
        return {kind: [asdict(run) for run in done] for kind, done in kinds.items()}

    entries = [
        {
            "case": one.case.name,
            "left_out": one.left_out,
            "ratios": one.ratios,
            "other": runs(one.other),
            "this": runs(one.this),
        }
        for one in comparisons
    ]
    return json.dumps({"conditions": asdict(where), "other": str(other), "cases": entries}, indent=1)


def run(cases: Sequence[Case], root: Path, seconds: float, repeats: int, json_wanted: bool, where: Conditions) -> int:
    """The whole comparison, printed; the exit status: 1 when a case was left out."""
    comparisons = compare(cases, other_checkout(root), seconds, repeats)
    print((as_json if json_wanted else table)(comparisons, root, where))
    return int(any(comparison.left_out is not None for comparison in comparisons))
