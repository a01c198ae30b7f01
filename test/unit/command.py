"""Calls of ./robocop, as far as they need nothing to be installed."""

import contextlib
import os
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SETUP_TIMEOUT = 600.0  # [s, wall] for a set-up on a busy machine


def environment(**settings):
    """This test's environment without the variables that the command depends on, plus `settings`."""
    left_out = ("ROS_MASTER_URI", "ROS_IP", "ROS_HOSTNAME", "DISPLAY", "ROBOCOP_DRY_RUN", "ROBOCOP_WEB_HOST")
    chosen = {name: value for name, value in os.environ.items() if name not in left_out}
    chosen.update(settings)
    return chosen


def robocop(*arguments, root=ROOT, timeout=SETUP_TIMEOUT, **settings):
    command = [str(root / "robocop"), *arguments]
    return subprocess.run(command, env=environment(**settings), capture_output=True, text=True, timeout=timeout)


def make_program(path, script):
    path.write_text(script)
    path.chmod(0o755)


def dry_run(*arguments, **settings):
    """The command that would be started, its ROS settings, and the messages."""
    done = robocop(*arguments, ROBOCOP_DRY_RUN="1", **settings)
    assert done.returncode == 0, done.stderr
    *settings, command = done.stdout.splitlines()
    return command.strip(), settings, done.stderr


@contextlib.contextmanager
def x_server():
    """A working X server; yields its DISPLAY."""
    read, write = os.pipe()
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(write), "-screen", "0", "320x240x24"], pass_fds=[write], stderr=subprocess.DEVNULL
    )
    try:
        os.close(write)
        with open(read) as display:
            yield f":{display.readline().strip()}"
    finally:
        server.terminate()
        server.wait()
