"""Writes a grade as report.html, summary.md and report.json, and as the files that the hosts of courses read."""

import dataclasses
import json
import os
import shlex
import tempfile
from pathlib import Path
from typing import Any, Dict, Iterator, Sequence
from urllib.parse import quote

import jinja2

from .. import faults
from ..checks import CHECKS
from ..errors import GradingSetupError
from ..judge import CheckResult, Grade, Outcome, Records, total
from ..plan import BRIDGE_SCENARIOS, START, Plan
from ..record import Record
from ..texts import printable, printable_lines
from .plots import svg

SCENARIO_PLOTS = {"server": ("track", "distances", "errors", "speeds", "states"), "bridge": ("track",)}
MARKS = {"passed": "✅", "failed": "❌", "not reached": "➖"}  # of outcomes in the summary
LEAD = 1.0  # [s] before a failure, from where on a replay shows it
MAX_LINES = 60  # of a node's output in the report


def make_report_folder(folder: Path) -> Path:
    """Create the folder unless it exists; GradingSetupError if it can't be created or written to."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise GradingSetupError(f"the report can't be written to {folder}: {error.strerror}") from error
    return folder


def write(grade: Grade, plan: Plan, records: Records, folder: Path, kept: bool = True) -> None:
    """Write all files to an existing folder that already has the bags; `kept`: the folder will not be moved."""
    (folder / "report.json").write_text(json.dumps(as_json(grade, plan), indent=1, default=lambda kind: kind.value))
    (folder / "results.json").write_text(json.dumps(as_gradescope(grade, plan), indent=1))
    (folder / "classroom.json").write_text(json.dumps(as_classroom(grade), indent=1))
    if grade.tracebacks:
        faults.keep(grade.tracebacks, folder)
    # An HTML block without empty lines, so that GitHub does not read texts of the submission as Markdown.
    summary = render("summary.html", grade=grade, marks=MARKS)
    (folder / "summary.md").write_text(summary, encoding="utf-8", errors="replace")
    scenarios = list(_scenarios(grade, plan, records, folder, kept))
    page = render(
        "report.html",
        grade=grade,
        seed=plan.seed,
        kept=kept,
        reached=[check for check in grade.failures_first if check.outcome is not Outcome.NOT_REACHED],
        not_reached=[check for check in grade.checks if check.outcome is Outcome.NOT_REACHED],
        not_reached_points=total(
            it.points_available for it in grade.checks if it.outcome is Outcome.NOT_REACHED and not it.extra
        ),
        scenarios=sorted(scenarios, key=lambda scenario: not scenario["failed"]),
        anchors={name: panel["anchor"] for it in scenarios for panel in it["panels"] for name in panel["names"]},
    )
    (folder / "report.html").write_text(page, encoding="utf-8", errors="replace")


def as_json(grade: Grade, plan: Plan) -> Dict[str, object]:
    """The grade as plain values."""
    return {
        "name": grade.name,
        "seed": plan.seed,
        "points": grade.points,
        "of": grade.points_available,
        "extra": grade.extra,
        "extra_of": grade.extra_available,
        "files": list(grade.files),
        "problems": list(grade.problems),
        "checks": [_check_as_json(check) for check in grade.checks],
    }


def _check_as_json(check: CheckResult) -> Dict[str, object]:
    values = {"of" if key == "points_available" else key: value for key, value in dataclasses.asdict(check).items()}
    return {**values, "outcome": check.outcome.value, "words": check.words}


# -- for the hosts of courses: GitHub Classroom (classroom.json) and Gradescope (results.json) --


def as_classroom(grade: Grade) -> Dict[str, object]:
    """The result of one runner as GitHub's action classroom-resources/autograding-grading-reporter reads it."""
    return {
        "version": 1,
        "status": "pass" if grade.all_right else "fail",
        "max_score": grade.points_available,
        "tests": [_github_test(check) for check in grade.checks if check.points or not check.extra],
    }


def _github_test(check: CheckResult) -> Dict[str, object]:
    passed = check.outcome is Outcome.PASSED
    return {
        "name": check.marked(check.sentence),
        "status": "pass" if passed else "fail",
        "score": check.points,
        "message": "" if passed else printable(check.words),
        "test_code": check.name,
        "filename": "",
        "line_no": 0,
        "duration": 0,
    }


def as_gradescope(grade: Grade, plan: Plan) -> Dict[str, object]:
    """The content of results.json: gradescope-autograders.readthedocs.io, section "Autograder output"."""
    tests = []
    for check in grade.checks:
        passed = check.outcome is Outcome.PASSED
        test: Dict[str, object] = {
            "name": printable_lines(check.marked(check.sentence)),
            "number": f"{check.part}.{check.name}",
            "output": printable_lines(check.words),
        }
        if passed or not check.extra:  # an extra check that did not pass is shown without points, neither green nor red
            test["score"], test["max_score"] = check.points, 0.0 if check.extra else check.points_available
            test["status"] = "passed" if passed else "failed"
        tests.append(test)
    output = [*map(printable_lines, (*grade.files, *grade.problems)), f"scenarios: seed {plan.seed}"]
    return {"score": grade.points + grade.extra, "output": "\n".join(output), "tests": tests}


# -- report.html --


def _scenarios(grade: Grade, plan: Plan, records: Records, folder: Path, kept: bool) -> Iterator[Dict[str, Any]]:
    """The values of each scenario's section in report.html."""
    about = {scenario.name: scenario.about for scenario in plan.scenarios}
    order = [START, *about, *BRIDGE_SCENARIOS]
    for part, by_name in records.items():
        for record in sorted(by_name.values(), key=lambda record: order.index(record.name)):
            checks = [
                check
                for check in grade.checks
                if (check.part, check.scenario) == (part, record.name) and check.outcome is not Outcome.NOT_REACHED
            ]
            if part == "server" and not record.goals and not checks:
                continue
            shown = {CHECKS[check.name].plot for check in checks}
            rest = [_plot(plot, record, []) for plot in SCENARIO_PLOTS[part] if plot not in shown]
            bag = folder / f"{part}-{record.name}.bag"
            yield {
                "part": part,
                "replay": shlex.quote(str(bag.resolve()) if kept else bag.name) if bag.is_file() else "",
                "record": record,
                "about": about.get(record.name, ""),
                "panels": list(_panels(record, checks)),
                "plots": list(filter(None, rest)),
                "lines": record.lines[:MAX_LINES],
                "failed": any(check.outcome is Outcome.FAILED for check in checks),
            }


def _plot(name: str, record: Record, moments: Sequence[float]) -> str:
    """A plot of a scenario with these moments marked [s]; nothing for a scenario without samples, such as the start."""
    return svg(name, record, moments) if record.goals or record.clicks or record.commands else ""


def _panels(record: Record, checks: Sequence[CheckResult]) -> Iterator[Dict[str, Any]]:
    """The panels: each failed check beside its plot; passed checks with the same plot share a panel."""
    shown = set()
    for check in checks:
        plot, passed = CHECKS[check.name].plot, check.outcome is Outcome.PASSED
        if passed and plot in shown:
            continue
        first = plot not in shown
        shown.add(plot)
        others = [other for other in checks if other.outcome is Outcome.PASSED and CHECKS[other.name].plot == plot]
        moments = [] if check.failure is None else [check.failure.time]
        yield {
            "check": check,
            "svg": _plot(plot, record, moments),
            "also_passed": [other.sentence for other in others] if passed else [],
            "names": [check.name, *(other.name for other in others if first)],  # of the checks that it illustrates
            "start": _start(check, record),
            "anchor": f"{check.part}-{check.name}",
        }


def _start(check: CheckResult, record: Record) -> str:
    """The time [s] in the scenario's bag a little before a check failed; nothing for a check that passed."""
    if check.failure is None or not record.samples:
        return ""
    return f"{max(0.0, check.failure.time - record.samples[0].time - LEAD):.1f}"


# -- pages made from templates/ --


def _shown(value: Any) -> Any:
    """A value as it goes into a page: text that is not markup of ours without control characters."""
    return printable_lines(value) if type(value) is str else value


_PAGES = jinja2.Environment(
    loader=jinja2.FileSystemLoader(Path(__file__).parent / "templates"),
    autoescape=True,
    finalize=_shown,
    undefined=jinja2.StrictUndefined,
    trim_blocks=True,
    lstrip_blocks=True,
)
_PAGES.filters.update(
    css=lambda outcome: outcome.split()[0],  # the class of an outcome
    one_line=printable,
    points=lambda points: "–" if points is None else f"{points:g}",
    printable=printable_lines,
    quoted=lambda name: quote(os.fsencode(name)),  # a file's name, whatever bytes it consists of, as part of a URL
)


def render(template: str, **values: Any) -> str:
    """The page made from a template; all values are escaped unless the template marks them safe."""
    return _PAGES.get_template(template).render(**values)
