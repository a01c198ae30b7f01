"""The page's texts as HTML. Names and messages come from outside: markup in them is shown as text."""

import html
import re
from typing import Iterable, Mapping, Optional, Tuple

MAX_LENGTH = 300  # characters of any one name or message
STYLE = "padding:0 0.8em 0.5em;font-size:0.85em;overflow-wrap:anywhere"
GOAL = r"goal x \S+ y \S+(?: in \S+)?"
POSITION = re.compile(r"\bgoal x (-?\d+\.\d+) y (-?\d+\.\d+) in ")
OFF = re.compile(rf"([\d.]+) m from the {GOAL} after ([\d.]+ s)")
STOPPED = re.compile(rf"{GOAL} stopped after ([\d.]+ s): (.*)")
OBSTACLE = re.compile(r"(OBSTACLE: )obstacle ([\d.]+ m ahead)(?: \(limit [\d.]+ m\))?")
ALERT = "margin:0 0.8em 0.6em;padding:0.5em 0.7em;border-radius:4px;background:#b3261e;color:#fff;font-size:0.9em"


def plain(text: str) -> str:
    """Text of any origin for the page: escaped, on one line, of limited length."""
    text = " ".join(text.split())
    return html.escape(text if len(text) <= MAX_LENGTH else text[: MAX_LENGTH - 1] + "…")


def position(x: float, y: float) -> str:
    """A position on the floor [m]."""
    return f"({x:.2f}, {y:.2f})"


def short(message: str) -> str:
    """A message of this package's server, without the goal's position and the limit; other messages unchanged.

    REACHED: 0.098 m from the goal x 0.42 y -0.38 in odom after 8.1 s -> REACHED: 0.10 m off, 8.1 s
    """
    message = " ".join(message.split())
    message = OFF.sub(lambda found: f"{float(found[1]):.2f} m off, {found[2]}", message)
    message = STOPPED.sub(r"\2, \1", message)
    return OBSTACLE.sub(r"\1\2", message).replace("; ", ", ")


def goal_in(message: str) -> Optional[Tuple[float, float]]:
    """The goal's position [m] that a message of this package's server names; None if it names none."""
    found = POSITION.search(message)
    return None if found is None else (float(found[1]), float(found[2]))


def table(rows: Iterable[Tuple[str, str]]) -> str:
    """Names with their values, one below the other."""
    cells = "".join(
        f'<tr><td style="padding-right:0.8em;opacity:0.7;vertical-align:top;white-space:nowrap">{plain(name)}</td>'
        f"<td>{plain(value)}</td></tr>"
        for name, value in rows
    )
    return f'<div style="{STYLE}"><table style="border-spacing:0">{cells}</table></div>'


def alert(message: str) -> str:
    """A problem of the whole system; nothing for an empty message."""
    return f'<div style="{ALERT}" role="alert">{plain(message)}</div>' if message else ""


def answer(message: str) -> str:
    """Why the last request failed; nothing for an empty message."""
    return f'<div style="{STYLE}" role="status">{plain(message)}</div>' if message else ""


def history(ended: Iterable[Tuple[bool, str]]) -> str:
    """The last goals: whether each was reached, and what became of it."""
    marks = {True: '<span style="color:#2b8a3e">✓</span>', False: '<span style="color:#e8590c">✗</span>'}
    lines = "".join(f"<div>{marks[reached]} {plain(line)}</div>" for reached, line in ended)
    return f'<div style="{STYLE}">{lines or "no goal has ended yet"}</div>'


def legend(what: str, colors: Mapping[str, Tuple[int, int, int]]) -> str:
    """What colours mean: each as a small square, with its words."""
    squares = "".join(
        f'<span style="color:rgb{color}"> ■</span> <span style="white-space:nowrap">{plain(name)}</span>'
        for name, color in colors.items()
    )
    return f'<div style="{STYLE}">{plain(what)}:{squares}</div>'


def link(address: str, words: str) -> str:
    """A link that is opened in a tab of its own."""
    return f'<div style="{STYLE}"><a href="{html.escape(address)}" target="_blank">{plain(words)}</a></div>'
