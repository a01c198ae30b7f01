"""Every ./robocop command that the documentation prints exists, with its launch arguments."""

import os
import subprocess

import pytest
from documentation import ROOT, commands, inline_commands

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
