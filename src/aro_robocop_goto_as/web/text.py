"""The page's texts as HTML. Names and messages come from outside: what looks like markup in them is shown as text."""

import html
import re
from typing import Iterable, Tuple

LONGEST = 300  # characters of any one name or message
STYLE = "padding:0 0.8em 0.5em;font-size:0.85em;overflow-wrap:anywhere"
BLOCK = "margin:0.4em 0;padding:0.3em 0.5em;white-space:pre-wrap;overflow-wrap:anywhere;font-size:0.9em"
LEVELS = {4: "color:#e8590c", 8: "color:#e03131", 16: "color:#e03131"}  # of rosgraph_msgs/Log: WARN, ERROR, FATAL
ALERT = "margin:0 0.8em 0.6em;padding:0.5em 0.7em;border-radius:4px;background:#b3261e;color:#fff;font-size:0.9em"


def plain(text: str) -> str:
    """Text of any origin for the page: escaped, on one line, of limited length."""
    text = " ".join(text.split())
    return html.escape(text if len(text) <= LONGEST else text[: LONGEST - 1] + "…")


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
    """What became of the last request; nothing for an empty message."""
    return f'<div style="{STYLE}" role="status">{plain(message)}</div>' if message else ""


def history(ended: Iterable[Tuple[bool, str]]) -> str:
    """The last goals: whether each was reached, and what became of it."""
    marks = {True: '<span style="color:#2b8a3e">✓</span>', False: '<span style="color:#e8590c">✗</span>'}
    lines = "".join(f"<div>{marks[reached]} {plain(line)}</div>" for reached, line in ended)
    return f'<div style="{STYLE}">{lines or "no goal has ended yet"}</div>'


def block(content: str) -> str:
    """Text with lines of its own, as a terminal shows it."""
    return f'<pre style="{BLOCK}">{html.escape(content)}</pre>'


def log(lines: Iterable[Tuple[int, str, str]]) -> str:
    """What nodes logged: level, name and message of each; warnings and errors stand out."""
    shown = "".join(
        f'<div style="{LEVELS.get(level, "")}"><b>{plain(name)}</b> {plain(message)}</div>'
        for level, name, message in lines
    )
    return f'<div style="{STYLE}">{shown or "nothing yet"}</div>'


def topics(rows: Iterable[Tuple[str, str, str, str]]) -> str:
    """Topics: name, type, rate and newest message of each; the last two may be empty."""
    shown = "".join(
        f'<div style="margin-bottom:0.4em"><b>{plain(name)}</b> {plain(rate)}'
        f'<div style="opacity:0.7">{plain(newest or kind)}</div></div>'
        for name, kind, rate, newest in rows
    )
    return f'<div style="{STYLE}">{shown or "no topics"}</div>'


def steps(expected: str, commands: Iterable[Tuple[str, str]]) -> str:
    """A section of the lab: what one will see, and commands, each with what it prints.

    A click on a command selects the whole of it, so that it can be copied.
    """
    shown = "".join(
        f'<pre style="{BLOCK};user-select:all;border-left:3px solid #1c7ed6">{html.escape(command.strip())}</pre>'
        + (f'<pre style="{BLOCK};opacity:0.75">{html.escape(printed.strip())}</pre>' if printed else "")
        for command, printed in commands
    )
    seen = re.sub(r"`([^`]+)`", r"<code>\1</code>", html.escape(f"You will see {expected}")) if expected else ""
    return f'<div style="{STYLE}">{seen}{shown}</div>'
