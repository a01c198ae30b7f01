"""The sandbox."""

import subprocess
import textwrap
from pathlib import Path

import pytest

from robocop_grading.sandbox.bubblewrap import open_sandbox

TIMEOUT = 600.0  # [s, wall]


@pytest.fixture(scope="session")
def sandbox():
    """The sandbox; GradingError says why this machine can't have one."""
    return open_sandbox(False)


@pytest.fixture
def printed(sandbox):
    """Runs a Python program in the sandbox; the lines that it prints, its errors among them."""

    def run(code):
        environment, home = {"HOME": "/tmp/home", "PATH": "/usr/bin:/bin"}, Path("/tmp/home")
        command = ["/usr/bin/python3", "-c", textwrap.dedent(code)]
        inside = sandbox.command_inside(command, environment, (), home)
        done = subprocess.run(inside, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=TIMEOUT)
        return done.stdout.splitlines()

    return run
