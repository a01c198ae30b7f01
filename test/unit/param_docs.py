"""Writes what users read about parameters from their declarations: config/*.yaml, and tables in docs/*.md.

    ./robocop shell python3 test/unit/param_docs.py

writes them all; test_params.py says which ones are out of date.
"""

import re
from dataclasses import Field, fields
from pathlib import Path
from typing import Any, Dict, List, NamedTuple, Type, cast

from aro_robocop_goto_as.goto.params import GotoParams
from aro_robocop_goto_as.param_loading import MAX_POSITIVE, MIN_POSITIVE, declared
from aro_robocop_goto_as.ros.client.params import BridgeParams
from aro_robocop_goto_as.simulation.params import SimParams
from aro_robocop_goto_as.web.params import WebParams

CHECKOUT = Path(__file__).resolve().parents[2]
COLUMN = 28  # of a comment in a YAML file, if the value is not longer
UNIT = re.compile(r"\[(.*?)\] ?(.*)")
HEADER = """\
# Parameters of {0}. The comments are generated: param_docs.py writes them from the declarations in src/.
# Every key shows its default. Uncomment a key to change it here, or write only the keys you change into a file of your
# own and pass it as {1}:=FILE.
"""
PRECEDENCE = """\
# A launch argument wins over a profile (config/profiles), a profile over this file, this file over the defaults.
# A default in <...> is not a value: omit the key to use it (ROS parameters can't hold null).
# An unknown key, a wrong type or an impossible value stops the node with an error.
"""


class NodeParams(NamedTuple):
    """A node's parameters, the page with their table, their YAML file and the launch argument that replaces it."""

    node: str
    params: Type[Any]
    page: str
    yaml: str = ""
    argument: str = ""


NODES = (
    NodeParams("robocop_sim", SimParams, "docs/interfaces.md", "config/sim.yaml", "config"),
    NodeParams("robocop_goto_as", GotoParams, "docs/interfaces.md", "config/goto_as.yaml", "goto_config"),
    NodeParams("robocop_rviz_goto_ac", BridgeParams, "docs/interfaces.md", "config/rviz_goto_ac.yaml", "bridge_config"),
    NodeParams("robocop_web", WebParams, "docs/web.md"),
)


def yaml_of(node: NodeParams) -> str:
    """The YAML file of a node: each parameter's default as a comment, with its meaning."""
    text = HEADER.format(node.node, node.argument) + PRECEDENCE
    for title, cls in _groups(node.params):
        text += f"\n# {title}\n" if title else "\n"
        for name, (spec, _) in declared(cls).items():
            text += f"{f'#{name}: {default_of(spec)}':{COLUMN}}  # {spec.metadata.get('about', '')}\n"
    return text


def table_of(node: NodeParams) -> str:
    """The Markdown table of a node's parameters: default, unit and range, or the meaning where no YAML file has it."""
    heads = ["parameter", "default", "unit", "range"] if node.yaml else ["argument", "default", "unit", "meaning"]
    rows = [heads, ["---"] * len(heads)]
    for name, (spec, _) in declared(node.params).items():
        unit, meaning = unit_of(spec)
        last = range_of(spec) if node.yaml else meaning
        default = spec.metadata.get("otherwise") or default_of(spec).replace('""', "empty")
        rows.append([f"`{name}`" + ("*" if spec.metadata.get("live") else ""), default, unit, last])
    return "\n".join(" | ".join(row).rstrip() for row in rows)


def default_of(spec: "Field[Any]") -> str:
    """A parameter's default as YAML has it; in <...> what is used instead of None."""
    value = spec.default
    if value is None:
        return f"<{spec.metadata['otherwise']}>"
    if isinstance(value, bool):
        return str(value).lower()
    return '""' if value == "" else str(value)


def unit_of(spec: "Field[Any]") -> List[str]:
    """A parameter's unit, and its meaning without the unit."""
    about = spec.metadata.get("about", "")
    found = UNIT.fullmatch(about)
    return [found[1], found[2]] if found else ["", about]


def range_of(spec: "Field[Any]") -> str:
    """A parameter's bounds or choices, as few words as will do."""
    low, high, choices = (spec.metadata.get(name) for name in ("low", "high", "choices"))
    if choices:
        return ", ".join(choices)
    if low is None:
        return ""
    least, most = ("" if bound is None else f"{bound:.10g}" for bound in (low, high))
    least, most = ("> 0" if low == MIN_POSITIVE else least), ("" if high == MAX_POSITIVE else most)
    return f"{least} to {most}" if most else least if low == MIN_POSITIVE else f"from {least}"


def documents() -> Dict[Path, str]:
    """What each file that documents parameters has to contain."""
    found: Dict[Path, str] = {}
    for node in NODES:
        if node.yaml:
            found[CHECKOUT / node.yaml] = yaml_of(node)
        page = CHECKOUT / node.page
        begin, end = f"<!-- parameters of {node.node}, by param_docs.py -->\n", "\n<!-- end -->"
        before, _, rest = found.get(page, page.read_text(encoding="utf-8")).partition(begin)
        found[page] = before + begin + table_of(node) + end + rest.partition(end)[2]
    return found


def _groups(cls: Type[Any]) -> List[Any]:
    """The innermost groups of parameters with the sentences that describe them; one without a sentence if none has."""
    inner = [spec.metadata["group"] for spec in fields(cast(Any, cls)) if "group" in spec.metadata]
    if not inner:
        return [("", cls)]
    return [(title or (one.__doc__ or "").strip(), part) for one in inner for title, part in _groups(one)]


if __name__ == "__main__":
    for path, text in documents().items():
        path.write_text(text, encoding="utf-8")
