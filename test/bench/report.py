"""All repeats of a case -> a table or JSON, with a description of the machine."""

import json
import os
import platform
from dataclasses import asdict, dataclass, field
from importlib import metadata
from pathlib import Path
from statistics import median
from typing import Dict, List, Optional, Sequence

from .cases import ODOM_RATE, PHYSICS_RATES, SCAN_RATE, SCAN_SAMPLES, Case

KEPT_UP = 0.95  # a lower share of the requested real-time factor is noted
COLUMNS = {  # titles -> figures
    "factor": "factor",
    "CPU at 1 [ms/s]": "cpu_ms",
    "memory [MB]": "memory_mb",
    "first scan [s]": "first_scan_s",
    "client busy": "client_busy",
    "messages": "messages",
    "lost": "lost",
}
COMPARED = ("factor", "cpu_ms", "memory_mb", "first_scan_s")
Figures = Dict[str, List[float]]  # with a value for each repeat


@dataclass
class Measured:
    """A case in one checkout, and the error that stopped its repeats."""

    case: Case
    checkout: str = ""  # which, if there are two
    figures: Figures = field(default_factory=dict)
    error: Optional[str] = None

    def notes(self) -> List[str]:
        """Remarks on the figures."""
        notes = [] if self.error is None else [f"failed: {self.error}"]
        slowest = min(self.figures.get("paced_factor", [1.0]))
        if slowest < KEPT_UP:
            notes.append(f"only {slowest:.2f} of the requested factor 1 reached")
        return [f"{self.case.name}{self.checkout and ', ' + self.checkout}: {note}" for note in notes]


Row = Sequence[Measured]  # a case in this checkout, or in the other and in this one


def conditions(seconds: float, repeats: int) -> List[str]:
    """The machine, its present load over 1, 5 and 15 minutes, and the settings of a measurement."""
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    models = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    installed = {package.metadata["Name"]: package.version for package in metadata.distributions()}
    packages = ("numpy", "pybullet", "pybullet-arm64")
    versions = ", ".join(f"{name} {installed[name]}" for name in packages if name in installed)
    load = " ".join(f"{value:.2f}" for value in os.getloadavg())
    cpu = f"{next(models, platform.machine())}, {len(os.sched_getaffinity(0))} cores"
    return [
        f"{cpu}; Python {platform.python_version()}, {versions}; load before: {load}",
        f"A client on every robot's /scan ({SCAN_SAMPLES} beams, {SCAN_RATE} Hz) and /odom ({ODOM_RATE} Hz); "
        f"{seconds:g} s per measurement; medians of {repeats}, with lowest and highest in brackets.",
    ]


def ratios(row: Row) -> Figures:
    """This / other: repeats are compared in pairs, as they were measured one after the other; {} for one checkout."""
    if len(row) == 1 or any(measured.error or not measured.figures for measured in row):
        return {}
    other, this = (measured.figures for measured in row)
    return {name: [new / old for new, old in zip(this[name], other[name])] for name in COMPARED}


def cell(values: Sequence[float]) -> str:
    """The median, followed by the lowest and the highest if there are several values; the sum of counts."""
    if not values or isinstance(values[0], int):
        return str(sum(values)) if values else "-"
    middle = median(values)
    digits = 0 if middle >= 100.0 else 1 if middle >= 10.0 else 2
    low, text, high = (f"{value:.{digits}f}" for value in (min(values), middle, max(values)))
    return text if len(values) == 1 else f"{text} ({low}-{high})"


def table(rows: Sequence[Row], where: Sequence[str]) -> str:
    """The results as text: an aligned Markdown table without empty columns, and notes."""
    lines = [["drive", "robots", "", *COLUMNS]]
    for row in rows:
        named = [(measured.checkout, {} if measured.error else measured.figures) for measured in row]
        for name, figures in [*named, *[("ratio", ratios(row))] * (len(row) - 1)]:
            label = [f"{row[0].case.drive} {PHYSICS_RATES[row[0].case.drive]} Hz", row[0].case.kind, name]
            lines.append([*label, *(cell(figures.get(column, ())) for column in COLUMNS.values())])
    columns = [column for column in zip(*lines) if set(column[1:]) - {"", "-"}]
    padded = [[text.ljust(max(map(len, column))) for text in column] for column in columns]
    head, *body = ("| " + " | ".join(cells) + " |" for cells in zip(*padded))
    rule = "|" + "|".join("-" * (len(column[0]) + 2) for column in padded) + "|"
    notes = [note for row in rows for measured in row for note in measured.notes()]
    return "\n".join([*where, "", head, rule, *body, *[""] * bool(notes), *notes])


def as_json(rows: Sequence[Row], where: Sequence[str]) -> str:
    """The results as JSON, with the figures of every repeat and units in their names."""
    cases = [
        {
            "case": row[0].case.name,
            "ratios": ratios(row),
            **{name: asdict(measured) for name, measured in zip(("this", "other"), reversed(row))},
        }
        for row in rows
    ]
    return json.dumps({"conditions": where, "cases": cases}, indent=1)
