"""Renders the HTML pages of reports and overviews from templates/."""

import os
from pathlib import Path
from typing import Any, Optional
from urllib.parse import quote

import jinja2

from ..judge import printable, printable_lines


def _points(points: Optional[float]) -> str:
    return "–" if points is None else f"{points:g}"


def _css(outcome: str) -> str:
    """The CSS class of an outcome."""
    return outcome.split()[0]


def _quoted(name: str) -> str:
    """A file's name as part of a URL, whatever bytes it consists of."""
    return quote(os.fsencode(name))


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
_PAGES.filters.update(css=_css, one_line=printable, points=_points, printable=printable_lines, quoted=_quoted)


def render(template: str, **values: Any) -> str:
    """The page made from a template; all values are escaped unless the template marks them safe."""
    return _PAGES.get_template(template).render(**values)
