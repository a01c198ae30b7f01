"""Every ./robocop command that the documentation prints exists, with its launch arguments."""

import os
import re
import subprocess

import pytest
from documentation import ROOT, blocks, commands, inline_commands

PROGRAM = "./robocop"
EXCEPTIONS = {
    "./robocop doctor": "its exit status reports what this machine lacks",
}
# `./robocop image` is refused without docker, podman or buildah: see test_robocop_command.py.
COMMANDS = sorted(
    command
    for command in {*commands(PROGRAM), *inline_commands(PROGRAM)} - set(EXCEPTIONS)
    if f"{PROGRAM} image" not in command
)


def test_the_documentation_has_commands_of_both_kinds():
    assert len(commands(PROGRAM)) > 10 and len(inline_commands(PROGRAM)) > 10
    assert all(line.strip() for block in blocks() for line in block.lines[:1])


def test_the_badge_names_only_what_tests_check():
    badge = (ROOT / "docs" / "images" / "ci.svg").read_text()
    _, *labels = re.findall(r"<text[^>]*>([^<]+)</text>", badge)
    sources = list((ROOT / "test").rglob("*.py"))
    tests = [name for path in sources for name in re.findall(r"def (test_.*|chromium)\(", path.read_text())]
    names = " ".join([*(str(path.relative_to(ROOT)) for path in sources), *tests])
    assert len(labels) > 5
    assert [label for label in labels if label.lower().replace(" tests", "") not in names] == []


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
