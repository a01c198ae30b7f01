"""The page's texts as HTML. Names and messages come from outside: what looks like markup in them is shown as text."""

import html
from typing import Iterable, List, Optional, Tuple

from .state import Ended, ReplayState, SimState

LONGEST = 300  # characters of any one name or message
STYLE = "padding:0 0.8em 0.5em;font-size:0.85em;overflow-wrap:anywhere"
ALERT = "margin:0 0.8em 0.6em;padding:0.5em 0.7em;border-radius:4px;background:#b3261e;color:#fff;font-size:0.9em"


def plain(text: str) -> str:
    """Text of any origin for the page: escaped, on one line, of limited length."""
    text = " ".join(text.split())
    return html.escape(text if len(text) <= LONGEST else text[: LONGEST - 1] + "…")


def _table(rows: Iterable[Tuple[str, str]]) -> str:
    cells = "".join(
        f'<tr><td style="padding-right:0.8em;opacity:0.7;vertical-align:top;white-space:nowrap">{plain(name)}</td>'
        f"<td>{plain(value)}</td></tr>"
        for name, value in rows
    )
    return f'<div style="{STYLE}"><table style="border-spacing:0">{cells}</table></div>'


def alert(message: str) -> str:
    """A problem of the whole system; nothing for an empty message."""
    return f'<div style="{ALERT}" role="alert">{plain(message)}</div>' if message else ""


def overview(sim: Optional[SimState], robots: int, bridge: str) -> str:
    """World, seed and speed, if there is a simulator, and what the bridge says."""
    rows: List[Tuple[str, str]] = []
    if sim is not None:
        state = "paused" if sim.paused else f"factor {sim.factor_reached:.2f}, requested {factor(sim.factor_asked)}"
        rows += [
            ("world", sim.world),
            ("seed", str(sim.seed)),
            ("engine", f"{sim.drive}, {sim.sync}"),
            ("time", f"{sim.time:.0f} s, {state}"),
        ]
    if robots != 1:
        rows.append(("robots", str(robots)))
    rows.append(("server", bridge or "no report from the bridge yet"))
    return _table(rows)


def progress(state: ReplayState) -> str:
    """How far a recording has been played."""
    how = f"factor {state.speed:g}" if state.playing else "paused"
    return _table([("recording", f"{state.position:.0f} of {state.duration:.0f} s, {how}")])


def factor(asked: float) -> str:
    """A requested real-time factor in words."""
    return f"{asked:g}" if asked > 0.0 else "as fast as possible"


def feedback(position_error: float, angle_error: float, message: str) -> str:
    """The newest feedback of the goal that is being executed."""
    return _table(
        [("position error", f"{position_error:.2f} m"), ("angle error", f"{angle_error:.2f} rad"), ("", message)]
    )


def history(ended: Iterable[Ended], several: bool) -> str:
    """The last goals; with the robot's name if there are several."""
    lines = []
    for item in ended:
        goal = "goal" if item.goal is None else f"({item.goal[0]:.2f}, {item.goal[1]:.2f})"
        mark, color = ("✓", "#37b24d") if item.state == "SUCCEEDED" else ("✗", "#f76707")
        robot = f"{item.robot} " if several else ""
        lines.append(
            f'<div><span style="color:{color}">{mark}</span> {plain(robot)}{plain(goal)}: '
            f"{plain(item.message or item.state)}</div>"
        )
    return f'<div style="{STYLE}">{"".join(lines) or "no goal has ended yet"}</div>'
