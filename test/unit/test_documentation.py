"""Every ./robocop command that the documentation prints exists, with its launch arguments."""

import os
import re
import subprocess

import pytest
from documentation import ROOT, commands, inline_commands

PROGRAM = "./robocop"
# `doctor` reports by its exit status what this machine lacks; `image` needs docker, podman or buildah.
COMMANDS = sorted(
    command
    for command in {*commands(PROGRAM), *inline_commands(PROGRAM)}
    if not re.search("robocop (doctor|image)", command)
)


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
