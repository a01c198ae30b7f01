"""The page's texts as HTML. Names and messages come from outside: markup in them is shown as text."""

import html
from typing import Iterable, Mapping, Tuple

MAX_LENGTH = 300  # characters of any one name or message
STYLE = "padding:0 0.8em 0.5em;font-size:0.85em;overflow-wrap:anywhere"
ALERT = "margin:0 0.8em 0.6em;padding:0.5em 0.7em;border-radius:4px;background:#b3261e;color:#fff;font-size:0.9em"


def plain(text: str) -> str:
    """Text of any origin for the page: escaped, on one line, of limited length."""
    text = " ".join(text.split())
    return html.escape(text if len(text) <= MAX_LENGTH else text[: MAX_LENGTH - 1] + "…")


def position(x: float, y: float) -> str:
    """A position on the floor [m]."""
    return f"({x:.2f}, {y:.2f})"


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


def report(message: str) -> str:
    """What a server says of a goal. Two lines at all times, so that what is below stays where it is."""
    return f'<div style="{STYLE};box-sizing:content-box;min-height:2lh">{plain(message)}</div>'


def answer(message: str) -> str:
    """Why the last request failed; nothing for an empty message."""
    return f'<div style="{STYLE}" role="status">{plain(message)}</div>' if message else ""


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
