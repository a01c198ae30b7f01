"""Writes a grade as report.html and report.json, and as the files that the hosts of courses read."""

import dataclasses
import json
import os
import shlex
from functools import partial
from pathlib import Path
from typing import Any, Callable, Dict, Iterator, Sequence
from urllib.parse import quote

import jinja2

from aro_robocop_goto_as.names import ROOT

from .. import faults
from ..checks import CHECKS
from ..errors import GradingSetupError
from ..grades import CheckOutcome, CheckResult, Grade, Mistake, scored
from ..judge import Records
from ..plan import Plan
from ..record import Record
from ..scenarios import BRIDGE_SCENARIOS, START
from ..texts import printable, printable_lines, shortened

SCENARIO_PLOTS = {"server": ("track", "distances", "errors", "speeds", "states"), "bridge": ("track",)}
LEAD = 1.0  # [s] before a failure, from where on a replay shows it
MAX_OUTPUT = 60  # of a node's output in the report


def make_report_folder(folder: Path, stamp: str) -> Path:
    """Create the folder unless it exists, with this file in it; GradingSetupError if that is not possible."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / stamp).touch()
    except OSError as error:
        raise GradingSetupError(f"the report can't be written to {folder}: {error.strerror}") from error
    return folder


def write(
    grade: Grade, plan: Plan, records: Records, folder: Path, moves: bool = False, all_plots: bool = False
) -> None:
    """Write all files to an existing folder that already has the bags; `moves`: to whoever handed in, elsewhere.

    `all_plots`: also of scenarios in which no check failed.
    """
    (folder / "report.json").write_text(json.dumps(as_json(grade, plan), indent=1, default=lambda kind: kind.value))
    (folder / "results.json").write_text(json.dumps(as_gradescope(grade), indent=1))
    (folder / "classroom.json").write_text(json.dumps(as_classroom(grade), indent=1))
    (folder / faults.FILE).unlink(missing_ok=True)  # an earlier report's
    if grade.tracebacks:
        faults.keep(grade.tracebacks, folder)
    replay = partial(_replay, folder, moves)
    page = render(
        "report.html",
        grade=grade,
        seed=plan.seed,
        mistakes=[_mistake(it, records, replay) for it in grade.mistakes],
        scenarios=list(_scenarios(grade, plan, records, replay, all_plots)),
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
        "notes": list(grade.notes),
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
    passed = check.outcome is CheckOutcome.PASSED
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


def as_gradescope(grade: Grade) -> Dict[str, object]:
    """The content of results.json: gradescope-autograders.readthedocs.io, section "Autograder output"."""
    tests = []
    for check in grade.checks:
        passed = check.outcome is CheckOutcome.PASSED
        test: Dict[str, object] = {
            "name": printable_lines(check.marked(check.sentence)),
            "number": f"{check.part}.{check.name}",
            "output": printable_lines(check.words),
        }
        if passed or not check.extra:  # an extra check that did not pass is shown without points, neither green nor red
            test["score"], test["max_score"] = check.points, 0.0 if check.extra else check.points_available
            test["status"] = "passed" if passed else "failed"
        tests.append(test)
    output = map(printable_lines, (*grade.files, *grade.problems, *grade.notes))  # no seed: students read this
    return {"score": grade.points + grade.extra, "output": "\n".join(output), "tests": tests}


# -- report.html --


def _replay(folder: Path, moves: bool, part: str, record: Record, start: float = 0.0) -> str:
    """The command that plays a scenario's bag from a time [s] on; nothing if there is no bag, or nothing happens."""
    bag = folder.resolve() / f"{part}-{record.name}.bag"
    if not bag.is_file() or not _has_something_to_see(record):
        return ""
    program, path = ("./robocop", bag.name) if moves else (str(ROOT / "robocop"), str(bag))
    command = f"{shlex.quote(program)} replay {shlex.quote(path)}"
    return f"{command} --start {start:.1f}" if start else command


def _mistake(mistake: Mistake, records: Records, replay: Callable[..., str]) -> Dict[str, Any]:
    """The values of a mistake's section: its picture, with the moment marked, and the command that shows it."""
    check, failure = mistake.check, mistake.check.failure
    record = records.get(check.part, {}).get(check.scenario)
    values = {"mistake": mistake, "check": check, "svg": "", "replay": "", "problem": ""}
    if record is None or failure is None:
        return values
    begin = max(0.0, failure.time - record.samples[0].time - LEAD) if record.samples else 0.0
    picture, command = _plot(CHECKS[check.name].plot, record, [failure.time]), replay(check.part, record, begin)
    problem = "" if record.problem.lower() in mistake.sentence.lower() else record.problem
    return {**values, "svg": picture, "replay": command, "problem": problem}


def _scenarios(
    grade: Grade, plan: Plan, records: Records, replay: Callable[..., str], all_plots: bool
) -> Iterator[Dict[str, Any]]:
    """The values of each scenario's section."""
    about = {scenario.name: scenario.about for scenario in plan.scenarios}
    order = [START, *about, *BRIDGE_SCENARIOS]
    for part, by_name in records.items():
        for record in sorted(by_name.values(), key=lambda record: order.index(record.name)):
            failed = grade.failed_in(part, record.name)
            plots = SCENARIO_PLOTS[part] if failed or all_plots else ()
            yield {
                "part": part,
                "record": record,
                "about": about.get(record.name, ""),
                "failed": failed,
                "replay": replay(part, record),
                "plots": [svg for svg in (_plot(plot, record, []) for plot in plots) if svg],
                "lines": record.lines[:MAX_OUTPUT],
            }


def _has_something_to_see(record: Record) -> bool:
    """Return whether something happens in a scenario; nothing does at the start, nor if the node never started."""
    return bool(record.goals or record.clicks or record.commands)


def _plot(name: str, record: Record, moments: Sequence[float]) -> str:
    """A plot of a scenario with these moments marked [s]; nothing for a scenario in which nothing happens."""
    if not _has_something_to_see(record):
        return ""
    from .plots import svg  # importing matplotlib takes a third of a second

    return svg(name, record, moments)


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
    css=lambda outcome: outcome.partition(":")[0].partition(" ")[0],  # the class of an outcome
    of=lambda checks: "{:g} / {:g}".format(*scored(checks)),
    points=lambda points: "–" if points is None else f"{points:g}",
    shortened=shortened,
    quoted=lambda name: quote(os.fsencode(name)),  # a file's name, whatever bytes it consists of, as part of a URL
)


def render(template: str, **values: Any) -> str:
    """The page made from a template; all values are escaped unless the template marks them safe."""
    return _PAGES.get_template(template).render(**values)
