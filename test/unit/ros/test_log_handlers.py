"""Logging by config/python_logging.conf: a full disk or a terminal that nobody reads costs lines, and nothing else."""

import os
import re
import subprocess
import sys

import pytest

from aro_robocop_goto_as.ros import log_handlers

LINES = 3 * log_handlers.KEPT
SCRIPT = """
import logging, os, resource, sys
from rosgraph.roslogging import configure_logging
from aro_robocop_goto_as.ros import log_handlers

def flush():
    for handler in [*logging.root.handlers, *logging.getLogger("rosout").handlers]:
        handler.flush()

log_handlers.PATIENCE = 60.0  # for a busy machine, also at the end of the program
log_handlers.use()
sys.stdout = log_handlers.Lossy(sys.stdout)
log = configure_logging("node", filename="node.log")
logger = logging.getLogger("rosout")
"""
FULL_DISK = """
for number in range(3):
    logger.info("before")
flush()
resource.setrlimit(resource.RLIMIT_FSIZE, (os.path.getsize(log), resource.RLIM_INFINITY))
for number in range(100):
    print("printed")
    logger.info("during")
flush()
resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
logger.info("after")
"""
FLOOD = f"""
for number in range({LINES}):
    logger.info("line %d %s", number, 100 * "x")
print("logged", file=sys.stderr)
sys.stdin.read()
flush()
"""


@pytest.fixture
def environment(tmp_path):
    return {**os.environ, "ROS_HOME": str(tmp_path), "ROS_LOG_DIR": str(tmp_path), "PYTHONUNBUFFERED": "1"}


def test_lines_that_find_no_room_on_the_disk_are_lost_and_counted_once_there_is_room(tmp_path, environment):
    with open(tmp_path / "output", "wb") as output:
        done = subprocess.run(
            [sys.executable, "-c", SCRIPT + FULL_DISK],
            env=environment,
            stdout=output,
            stderr=subprocess.PIPE,
            text=True,
            timeout=120.0,
        )
    assert (done.returncode, done.stderr) == (0, "")
    lines = (tmp_path / "node.log").read_text().splitlines()
    assert [line.split(": ")[-1] for line in lines[:3]] == 3 * ["before"]
    assert len([line for line in lines if "100 log lines were lost: [Errno 27] File too large" in line]) == 1
    assert len([line for line in lines if line.endswith(": after")]) == 1
    output = (tmp_path / "output").read_text()
    assert output.count("log lines were lost: [Errno 27] File too large") == output.count(": after") == 1


def test_node_goes_on_while_nobody_reads_its_output(environment):
    node = subprocess.Popen(
        [sys.executable, "-c", SCRIPT + FLOOD],
        env=environment,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        assert node.stderr.readline() == "logged\n"
        output, errors = node.communicate("", 120.0)
    finally:
        node.kill()
        node.wait()
    assert (node.returncode, errors) == (0, "")
    lost = sum(map(int, re.findall(r"(\d+) log lines were lost: nobody reads the output", output)))
    assert 0 < lost == LINES - len(re.findall(r"line \d", output))


def test_configuration_of_the_user_is_kept(tmp_path, monkeypatch):
    monkeypatch.setenv("ROS_HOME", str(tmp_path))
    monkeypatch.delenv("ROS_PYTHON_LOG_CONFIG_FILE", raising=False)
    (tmp_path / "config").mkdir()
    (tmp_path / "config" / "python_logging.conf").touch()
    log_handlers.use()
    assert "ROS_PYTHON_LOG_CONFIG_FILE" not in os.environ
    (tmp_path / "config" / "python_logging.conf").unlink()
    log_handlers.use()
    assert os.environ["ROS_PYTHON_LOG_CONFIG_FILE"] == str(log_handlers.CONFIG)
