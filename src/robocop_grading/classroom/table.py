"""The results of a class as a table in CSV, which spreadsheets read."""

import csv
import io
from types import MappingProxyType
from typing import Any, List, Mapping, Sequence

from ..plan import PARTS, Plan
from ..texts import printable
from .results import NOT_HANDED_IN, Result

# A spreadsheet treats text that starts with one of these as a formula; the last four are full-width characters.
FORMULA = ("=", "+", "-", "@", "\uff1d", "\uff0b", "\uff0d", "\uff20")
MAX_CELL = 2_000  # characters of a cell
BYTE_ORDER_MARK = "\ufeff"  # without it spreadsheets read the file in another encoding than UTF-8


def table(results: Sequence[Result], plan: Plan, problems: Mapping[str, str] = MappingProxyType({})) -> str:
    """All results as CSV, one row each; `of` counts both parts, whether or not they were handed in.

    `problems` maps the names that have no result to the reason. Where nothing was judged, there are no points.
    """
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    text.write(BYTE_ORDER_MARK)
    rows.writerow(["name", "points", "of", "extra", *PARTS, "problem", *(check.name for check in plan.checks)])
    for result in [*results, *(Result(name, (), (problem,)) for name, problem in sorted(problems.items()))]:
        points: List[Any] = ["", plan.points, *[""] * (1 + len(PARTS))]
        if result.is_judged:
            of_parts = [result.points_of(part) for part in PARTS]
            shown = [NOT_HANDED_IN if number is None else number for number in of_parts]
            points = [result.points, plan.points, result.extra, *shown]
        rows.writerow([_plain(result.name), *points, _plain(" | ".join(result.problems)), *result.outcomes(plan)])
    return text.getvalue()


def one_line(text: str) -> str:
    """A file's name or a message on one line, without characters that are not UTF-8 or that control a terminal."""
    return printable(text.encode("utf-8", "replace").decode())


def _plain(text: str) -> str:
    """The text as one cell: no character in it controls a terminal, separates cells, or begins a formula."""
    text = one_line(text)[:MAX_CELL].replace(";", ",")
    return f"'{text}" if text.lstrip(" '\"").startswith(FORMULA) else text
