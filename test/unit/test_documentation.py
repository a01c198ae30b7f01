"""The documentation's links lead somewhere, and every ./robocop command in it exists, with its launch arguments."""

import os
import subprocess

import pytest
from documentation import PAGES, ROOT, anchors, commands, inline_commands, links

PROGRAM = "./robocop"
# `doctor` reports by its exit status what this machine lacks.
COMMANDS = sorted(
    command for command in {*commands(PROGRAM), *inline_commands(PROGRAM)} if "robocop doctor" not in command
)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_relative_links_and_their_anchors_lead_somewhere(page):
    assert [link for link in links(page) if not leads_somewhere(page, link)] == []


def leads_somewhere(page, link):
    """Return whether a link of a page names a file or folder and, after a #, a heading of a page."""
    name, _, anchor = link.partition("#")
    target = page.parent / name if name else page
    return target.exists() and (not anchor or anchor in anchors(target))


@pytest.mark.slow
@pytest.mark.parametrize("command", COMMANDS)
def test_printed_command_is_accepted(command):
    done = subprocess.run(
        ["bash", "-c", command],
        cwd=ROOT,
        env={**os.environ, "ROBOCOP_DRY_RUN": "1", "DISPLAY": ""},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.returncode == 0, done.stderr
