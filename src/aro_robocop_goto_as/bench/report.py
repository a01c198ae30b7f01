"""Measurements -> a table or JSON, with a description of the machine."""

import json
import os
import platform
from dataclasses import asdict, dataclass
from importlib import metadata
from pathlib import Path
from statistics import median
from typing import Any, Callable, Dict, List, Sequence

from .cases import LEFT_OUT, ODOM_RATE, SCAN_RATE, SCAN_SAMPLES
from .results import Measured


@dataclass(frozen=True)
class Conditions:
    """The machine and the settings of a measurement."""

    cpu: str
    cores: int
    python: str
    numpy: str
    pybullet: str
    load_before: Sequence[float]  # over 1, 5, 15 minutes
    seconds: float  # [s, wall] of each measurement
    repeats: int

    def lines(self) -> List[str]:
        """As text."""
        load = " ".join(f"{value:.2f}" for value in self.load_before)
        return [
            f"{self.cpu}, {self.cores} cores; Python {self.python}, numpy {self.numpy}, pybullet {self.pybullet}; "
            f"load before: {load}",
            f"A client on every robot's /scan ({SCAN_SAMPLES} beams, {SCAN_RATE} Hz) and /odom ({ODOM_RATE} Hz); "
            f"{self.seconds:g} s per measurement; medians of {self.repeats}, with lowest and highest in brackets.",
        ]


def conditions(seconds: float, repeats: int) -> Conditions:
    """The present conditions."""
    model = next(
        (
            line.partition(":")[2].strip()
            for line in Path("/proc/cpuinfo").read_text().splitlines()
            if line.startswith("model name")
        ),
        platform.machine(),
    )
    return Conditions(
        model,
        len(os.sched_getaffinity(0)),
        platform.python_version(),
        metadata.version("numpy"),
        metadata.version("pybullet"),
        os.getloadavg(),
        seconds,
        repeats,
    )


def spread(values: Sequence[float], digits: int) -> str:
    """The median, followed by the lowest and the highest if there are several values."""
    middle = f"{median(values):.{digits}f}"
    return middle if len(values) == 1 else f"{middle} ({min(values):.{digits}f}-{max(values):.{digits}f})"


def _digits(values: Sequence[float]) -> int:
    """Decimals for three significant figures."""
    return 0 if median(values) >= 100.0 else 1 if median(values) >= 10.0 else 2


COLUMNS: Dict[str, Callable[[Dict[str, List[float]]], str]] = {
    "factor": lambda figures: spread(figures["factor"], _digits(figures["factor"])),
    "floor": lambda figures: spread(figures["floor"], _digits(figures["floor"])),
    "of floor": lambda figures: spread(figures["of_floor"], 2),
    "CPU at 1 [ms/s]": lambda figures: spread(figures["cpu_ms"], 1),
    "memory [MB]": lambda figures: spread(figures["memory_mb"], 0),
    "first scan [s]": lambda figures: spread(figures["first_scan_s"], 2),
}
HEAD = ["drive", "robots", *COLUMNS, "messages", "lost"]
PARTS_HEAD = ["the floor's parts", "robots", "step, all robots [us]", "scan, one robot [us]", "message [us]"]


def row(measured: Measured) -> List[str]:
    """A case's cells; the notes below the table say why it failed."""
    case = [f"{measured.case.drive} {measured.case.physics_rate} Hz", measured.case.name.partition(":")[2]]
    if measured.error is not None:
        return case + ["failed"] + ["-"] * (len(HEAD) - 3)
    figures = measured.figures()
    return case + [cell(figures) for cell in COLUMNS.values()] + [str(measured.delivered), str(measured.lost)]


def parts_row(measured: Measured) -> List[str]:
    """Durations of a step, a scan and a message in the floor [us]."""
    values = [[getattr(floor, part) * 1e6 for floor in measured.floors] for part in ("step", "scan", "message")]
    return [
        f"{measured.case.drive} {measured.case.physics_rate} Hz",
        str(measured.case.robots),
        *(spread(value, _digits(value)) for value in values),
    ]


def aligned(rows: Sequence[Sequence[str]]) -> List[str]:
    """An aligned Markdown table; the first row is the head."""
    widths = [max(len(cells[column]) for cells in rows) for column in range(len(rows[0]))]
    lines = ["| " + " | ".join(cell.ljust(width) for cell, width in zip(cells, widths)) + " |" for cells in rows]
    return [lines[0], "|" + "|".join("-" * (width + 2) for width in widths) + "|", *lines[1:]]


def table(results: Sequence[Measured], where: Conditions) -> str:
    """The results as text."""
    lines = [*where.lines(), "", *aligned([HEAD] + [row(measured) for measured in results])]
    with_floor = [measured for measured in results if measured.floors]
    if with_floor:
        lines += ["", *aligned([PARTS_HEAD] + [parts_row(measured) for measured in with_floor])]
    names = {measured.case.name for measured in results}
    notes = [note for measured in results for note in measured.notes()]
    notes += [f"{name} left out: {why}" for name, why in LEFT_OUT.items() if name not in names]
    return "\n".join(lines + [""] * bool(notes) + notes)


def as_json(results: Sequence[Measured], where: Conditions) -> str:
    """The results as JSON; `median` has the table's figures, with units in their names."""
    cases: List[Dict[str, Any]] = []
    for measured in results:
        figures = {name: median(values) for name, values in measured.figures().items() if values}
        runs: Dict[str, Sequence[Any]] = {
            "floors": measured.floors,
            "fastest": measured.fastest,
            "paced": measured.paced,
        }
        cases.append(
            {
                "drive": measured.case.drive,
                "robots": measured.case.robots,
                "physics_rate": measured.case.physics_rate,
                "error": measured.error,
                "median": figures,
                "delivered": measured.delivered,
                "lost": measured.lost,
                **{name: [asdict(run) for run in values] for name, values in runs.items()},
            }
        )
    return json.dumps({"conditions": asdict(where), "cases": cases}, indent=1)
