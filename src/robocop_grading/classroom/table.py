"""The results of a class as a table in CSV, which spreadsheets read."""

import csv
import io
from types import MappingProxyType
from typing import Any, List, Mapping, Sequence

from ..files.exports import Person
from ..grades import CheckOutcome, Grade
from ..plan import PARTS, Plan
from ..texts import printable, shortened

# Moodle's grading worksheet, whose last column is "-" where there is no grade yet; Gradescope's people.
IMPORTED = ("Identifier", "Full name", "Email", "SID", "Grade", "Last modified (grade)")
# A spreadsheet treats text that starts with one of these as a formula; the last four are full-width characters.
FORMULA = ("=", "+", "-", "@", "\uff1d", "\uff0b", "\uff0d", "\uff20")
MAX_CELL = 2_000  # characters of a cell
BYTE_ORDER_MARK = "\ufeff"  # without it spreadsheets read the file in another encoding than UTF-8


def table(
    results: Sequence[Grade],
    plan: Plan,
    problems: Mapping[str, str] = MappingProxyType({}),
    people: Mapping[str, Person] = MappingProxyType({}),
) -> str:
    """All results as CSV, one row each; `of` counts both parts, whether or not they were handed in.

    `problems` maps the names that have no result to the reason. Where nothing was judged, there are no points. With
    `people`, there are the columns that Moodle and Gradescope import.
    """
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    text.write(BYTE_ORDER_MARK)
    columns = IMPORTED if people else ()
    checks = [check.name for check in plan.checks]
    rows.writerow(["name", *columns, "points", "of", "extra", *PARTS, "problem", *checks, "notes"])
    for result in [*results, *(Grade(name, (), (problem,)) for name, problem in sorted(problems.items()))]:
        points: List[Any] = ["", plan.points, *[""] * (1 + len(PARTS))]
        if result.is_judged:
            of_parts = [result.points_of(part) for part in PARTS]
            shown = [CheckOutcome.NOT_HANDED_IN.value if number is None else number for number in of_parts]
            points = [result.points, plan.points, result.extra, *shown]
        who = [*map(_plain, people.get(result.name, Person())), points[0], "-"] if people else []
        said = [_plain(" | ".join(texts)) for texts in (result.problems, result.notes)]
        rows.writerow([_plain(result.name), *who, *points, said[0], *result.outcomes(plan), said[1]])
    return text.getvalue()


def one_line(text: str) -> str:
    """A file's name or a message on one line, without characters that are not UTF-8 or that control a terminal."""
    return printable(text.encode("utf-8", "replace").decode())


def _plain(text: str) -> str:
    """The text as one cell: no character in it controls a terminal, separates cells, or begins a formula."""
    text = shortened(one_line(text), MAX_CELL).replace(";", ",")
    return f"'{text}" if text.lstrip(" '\"").startswith(FORMULA) else text
