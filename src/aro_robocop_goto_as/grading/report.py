"""A grade with its records -> report.json, junit.xml, report.html."""

import dataclasses
import json
from html import escape
from pathlib import Path
from typing import Dict, List
from xml.etree import ElementTree

from .checks import PLOTS as PLOT_OF
from .judge import Grade, Line, Outcome, Records, printable
from .plan import BRIDGE_SCENARIOS, START, Plan
from .plots import PLOTS

SHOWN = {"server": ("track", "distances", "errors", "speeds", "states"), "bridge": ("track",)}
MOST_LINES = 60  # of a node's output in the report
STYLE = """body{font:15px/1.45 sans-serif;margin:2em auto;max-width:75em;padding:0 1em;color:#222}
table{border-collapse:collapse;width:100%}td,th{padding:.3em .6em;
border-bottom:1px solid #ddd;text-align:left;vertical-align:top}
.passed{color:#2c8a3d}.failed{color:#c62828}.not{color:#777}h1 small{font-weight:normal;color:#555}
svg{width:100%;max-width:600px;height:auto;display:inline-block;margin:.4em .8em .4em 0}svg *{font-family:sans-serif}
details svg{max-width:48%;vertical-align:top}
.beside{display:flex;gap:1em;flex-wrap:wrap;border-bottom:1px solid #ddd;padding:.6em 0}.beside p{flex:1 1 20em}
pre{background:#f5f5f5;padding:.6em;overflow:auto;max-height:20em}"""


def write(grade: Grade, plan: Plan, records: Records, folder: Path) -> None:
    """All three, into a folder that exists."""
    (folder / "report.json").write_text(json.dumps(as_json(grade), indent=1))
    ElementTree.ElementTree(_junit(grade)).write(folder / "junit.xml", encoding="utf-8", xml_declaration=True)
    (folder / "report.html").write_text(_html(grade, plan, records), encoding="utf-8", errors="replace")


def as_json(grade: Grade) -> Dict[str, object]:
    """The grade as plain values."""
    checks = []
    for line in grade.lines:
        entry = dataclasses.asdict(line)
        entry["outcome"] = line.outcome.value
        checks.append(entry)
    return {
        "name": grade.name,
        "points": grade.points,
        "of": grade.of,
        "problems": list(grade.problems),
        "checks": checks,
    }


def _junit(grade: Grade) -> ElementTree.Element:
    suite = ElementTree.Element(
        "testsuite",
        {
            "name": _clean(grade.name),
            "tests": str(len(grade.lines)),
            "failures": str(len(grade.failed())),
            "skipped": str(sum(line.outcome is Outcome.NOT_REACHED for line in grade.lines)),
            "errors": "0",
        },
    )
    for line in grade.lines:
        case = ElementTree.SubElement(suite, "testcase", {"classname": f"grade.{line.part}", "name": line.name})
        if line.failure is not None:
            ElementTree.SubElement(case, "failure", {"message": _clean(line.words())}).text = _clean(line.sentence)
        elif line.outcome is Outcome.NOT_REACHED:
            ElementTree.SubElement(case, "skipped", {"message": _clean(line.why)})
    return suite


def _clean(text: str) -> str:
    """Without the characters that XML does not allow."""
    return "\n".join(printable(line) for line in text.split("\n"))


def _html(grade: Grade, plan: Plan, records: Records) -> str:
    parts = [
        "<!DOCTYPE html><html lang='en'><meta charset='utf-8'>",
        f"<title>{escape(grade.name)}</title><style>{STYLE}</style>",
        f"<h1>{escape(grade.name)} <small>{grade.points:g} of {grade.of:g} points</small></h1>",
    ]
    parts += [f"<p class='failed'>{escape(_clean(problem))}</p>" for problem in grade.problems]
    parts.append("<table><tr><th>check<th>points<th>outcome</tr>")
    parts += [_row(line) for line in grade.lines]
    parts.append("</table>")
    for part, by_name in records.items():
        order = [START, *(scenario.name for scenario in plan.scenarios), *BRIDGE_SCENARIOS]
        for name in sorted(by_name, key=order.index):
            parts += _scenario(grade, plan, records, part, name)
    return "\n".join(parts)


def _row(line: Line) -> str:
    kind = line.outcome.value.split()[0]
    return (
        f"<tr><td>{escape(line.sentence)}<br><small>{line.name}{', extra' if line.extra else ''}</small>"
        f"<td>{line.points:g} / {line.of:g}<td class='{kind}'>{escape(_clean(line.words()))}</tr>"
    )


def _scenario(grade: Grade, plan: Plan, records: Records, part: str, name: str) -> List[str]:
    """A scenario's plots; each check that failed in it beside the plot that shows it."""
    record = records[part][name]
    about = {scenario.name: scenario.about for scenario in plan.scenarios}.get(name, "")
    mine = [line for line in grade.lines if line.part == part and line.scenario == name]
    if part == "server" and not record.goals and not mine:
        return []
    parts = [f"<h2>{part}: {escape(name)} <small>{escape(about)}</small></h2>"]
    if record.problem:
        parts.append(f"<p class='failed'>{escape(_clean(record.problem))}</p>")
    shown = set()
    for line in mine:
        plot, at = PLOT_OF[line.name], [line.failure.time] if line.failure is not None else []
        if line.outcome is Outcome.PASSED and plot in shown:
            continue
        shown.add(plot)
        others = [it.sentence for it in mine if it.outcome is Outcome.PASSED and PLOT_OF[it.name] == plot]
        words = "passed: " + " ".join(others) if line.outcome is Outcome.PASSED else line.words()
        title = f"{escape(line.sentence)}<br>" if line.outcome is not Outcome.PASSED else ""
        parts.append(
            f"<div class='beside'>{PLOTS[plot](record, plan.limits, at)}<p class='{line.outcome.value.split()[0]}'>"
            f"{title}{escape(_clean(words))}</p></div>"
        )
    rest = [plot for plot in SHOWN[part] if plot not in shown]
    parts.append(
        "<details><summary>more of this scenario</summary>"
        + "".join(PLOTS[plot](record, plan.limits, []) for plot in rest)
        + "<pre>"
        + escape(_clean("\n".join(f"{it.time:7.1f} {it.text}" for it in record.lines[:MOST_LINES])))
        + "</pre></details>"
    )
    return parts
