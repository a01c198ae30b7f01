"""Results of a class -> index.html: one row for each hand-in, and for each check how many passed and why not."""

import collections
import os
import re
from html import escape
from typing import Dict, List, Mapping, Optional, Sequence, Tuple
from urllib.parse import quote

from ..checks import sentence
from ..plan import PARTS, Plan
from .results import NOT_HANDED_IN, Result

REFRESH = 5  # [s] while it is still going on
MOST_CAUSES = 3
MOST_WORDS = 200  # letters of a cause
NUMBER = re.compile(r"-?\d+(\.\d+)?")
SIGNS = {"passed": "●", "failed": "✕", "not reached": "○", NOT_HANDED_IN: "–"}
STYLE = """body{font:15px/1.45 sans-serif;margin:2em auto;max-width:90em;padding:0 1em;color:#222}
h1 small{font-weight:normal;color:#555}table{border-collapse:collapse;margin:1em 0}
td,th{padding:.25em .5em;border-bottom:1px solid #ddd;text-align:left;vertical-align:top}
td.n{text-align:right;white-space:nowrap}
th.turned{height:11em;vertical-align:bottom;padding:0 .1em;font-weight:normal;font-size:12px}
th.turned span{writing-mode:vertical-rl;transform:rotate(180deg)}td.sign{text-align:center;padding:.25em .1em}
.passed{color:#2c8a3d}.failed{color:#c62828}.not{color:#999}
.bar{display:flex;width:16em;height:1em;background:#eee}.bar i{display:block;height:100%}
.bar .passed{background:#2c8a3d}.bar .failed{background:#c62828}.bar .not{background:#ccc}
progress{width:24em}li{margin:0}ul{margin:0;padding-left:1.2em}"""


def page(title: str, results: Sequence[Result], plan: Plan, waiting: Mapping[str, str], running: bool) -> str:
    """The overview; `waiting` are the names that have no result yet, with the words why."""
    count = len(results) + len(waiting)
    state = "" if not waiting else ", still at it" if running else ", interrupted: the same command goes on from there"
    parts = [
        "<!DOCTYPE html><html lang='en'><meta charset='utf-8'>",
        f"<meta http-equiv='refresh' content='{REFRESH}'>" if running else "",
        f"<title>{escape(title)}</title><style>{STYLE}</style>",
        f"<h1>{escape(title)} <small>{len(results)} of {count} graded{state}</small></h1>",
        f"<progress value='{len(results)}' max='{max(1, count)}'></progress>",
        *_hand_ins(results, plan, waiting),
        *_checks(results, plan),
    ]
    return "\n".join(part for part in parts if part)


def _hand_ins(results: Sequence[Result], plan: Plan, waiting: Mapping[str, str]) -> List[str]:
    most = round(sum(check.points for check in plan.checks if not check.extra), 6)
    turned = "".join(f"<th class='turned' title='{escape(sentence(check.name), quote=True)}'><span>{check.name}</span>"
                     for check in plan.checks)
    rows = [f"<table><tr><th>handed in<th>points of {most:g}{''.join(f'<th>{part}' for part in PARTS)}{turned}"
            "<th>problem</tr>"]
    for it in results:
        points = "".join(f"<td class='n'>{_number(it.points_of(part))}" for part in PARTS)
        signs = "".join(_sign(it.outcome(check.name), check.name) for check in plan.checks)
        name = f"<a href='{quote(os.fsencode(it.name))}/report.html'>{escape(it.name)}</a>"
        rows.append(f"<tr><td>{name}<td class='n'>{it.points:g}{points}{signs}"
                    f"<td class='failed'>{escape(' | '.join(it.problems)[:300])}</tr>")
    rows += [f"<tr><td class='not'>{escape(name)}<td class='not' colspan='99'>{escape(why)}</tr>"
             for name, why in waiting.items()]
    return [*rows, "</table>", "<p>" + ", ".join(f"<span class='{word.split()[0]}'>{sign}</span> {word}"
                                                for word, sign in SIGNS.items()) + "</p>"]


def _number(points: Optional[float]) -> str:
    return "–" if points is None else f"{points:g}"


def _sign(outcome: str, check: str) -> str:
    return f"<td class='sign {outcome.split()[0]}' title='{check}: {outcome}'>{SIGNS[outcome]}"


def _checks(results: Sequence[Result], plan: Plan) -> List[str]:
    """How each check went over all hand-ins that it was tried on, and what its failures had in common."""
    rows = ["<h2>Checks</h2><table><tr><th>check<th>passed<th><th>failed, not reached<th>most frequent causes</tr>"]
    for check in plan.checks:
        outcomes = collections.Counter(it.outcome(check.name) for it in results)
        tried = sum(outcomes.values()) - outcomes[NOT_HANDED_IN]
        bar = "".join(f"<i class='{word.split()[0]}' style='width:{100.0 * outcomes[word] / max(1, tried):.1f}%'></i>"
                      for word in ("passed", "failed", "not reached"))
        listed = "".join(f"<li>{number} × {escape(cause[:MOST_WORDS])}"
                         for cause, number in _most_frequent([line.cause for it in results for line in it.checks
                                                              if line.name == check.name and line.cause]))
        rows.append(f"<tr><td>{escape(sentence(check.name))}<br><small>{check.name}</small>"
                    f"<td class='n'>{outcomes['passed']} of {tried}<td><span class='bar'>{bar}</span>"
                    f"<td class='n'>{outcomes['failed']}, {outcomes['not reached']}<td><ul>{listed}</ul></tr>")
    return [*rows, "</table>"]


def _most_frequent(causes: Sequence[str]) -> List[Tuple[str, int]]:
    """Causes with how often each one is there; those that differ in numbers only are one, told by its first."""
    alike: Dict[str, List[str]] = {}
    for cause in causes:
        alike.setdefault(NUMBER.sub("#", cause), []).append(cause)
    return [(them[0], len(them)) for them in sorted(alike.values(), key=len, reverse=True)[:MOST_CAUSES]]
