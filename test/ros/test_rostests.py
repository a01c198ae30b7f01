"""Runs every .test file of test/ros/nodes by rostest, each with its own master and logs."""

import os
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from xml.etree import ElementTree

import pytest
from processes import processes_with

DEADLINE = 800.0  # [s, wall] for one .test file; each <test> in it has a shorter time-limit.
SHUTDOWN = 20.0  # [s, wall] for rostest to end its nodes after the deadline
FILES = {path.stem: path for path in Path(__file__).resolve().parent.glob("nodes/*.test")}
LONG = ("faults", "lab", "loop", "messages", "time_and_pose")
ROSTEST = "import rostest; rostest.rostestmain()"  # the same as the program of this name
SLOW = (
    *("bridge", "commands", "faults", "figures", "many_robots", "models", "navigation"),
    *("parameters", "teleop", "time_and_pose", "two_robots"),
)


def run_rostest(test_file, directory):
    """Run one file: the exit status, or None after the deadline, and the output."""
    environment = {**os.environ, "ROS_HOSTNAME": "localhost", "ROS_HOME": str(directory / "home")}
    environment["ROS_LOG_DIR"] = str(directory / "log")
    for name in ("ROS_MASTER_URI", "ROS_IP", "DISPLAY"):
        environment.pop(name, None)
    command = [sys.executable, "-c", ROSTEST, f"--results-base-dir={directory / 'results'}", str(test_file)]
    with open(directory / "output", "w+b") as output:
        rostest = subprocess.Popen(command, env=environment, stdout=output, stderr=subprocess.STDOUT)
        try:
            status = rostest.wait(DEADLINE)
        except subprocess.TimeoutExpired:
            status = None
            rostest.send_signal(signal.SIGINT)
            try:
                rostest.wait(SHUTDOWN)
            except subprocess.TimeoutExpired:
                rostest.kill()
                rostest.wait()
        finally:
            # roslaunch starts every node in its own session, so nodes are recognised by their environment.
            for process in processes_with(b"ROS_LOG_DIR=" + os.fsencode(environment["ROS_LOG_DIR"])):
                with suppress(ProcessLookupError):
                    os.kill(process, signal.SIGKILL)
        output.seek(0)
        return status, output.read().decode(errors="replace")


def cases_in(result):
    """The <testcase>s of a result file; none if the node died before it wrote any."""
    try:
        return list(ElementTree.parse(result).iter("testcase"))
    except ElementTree.ParseError:
        return []


def problems_of(case):
    """The failures, errors and skips of an xunit <testcase>, one string each."""
    name = f"{case.get('classname')}.{case.get('name')}"
    return [
        f"{name}: {entry.tag} {entry.get('message') or ''}\n{entry.text or ''}"
        for entry in case
        if entry.tag in ("failure", "error", "skipped")
    ]


def logs(directory):
    """The end of every node's log file. rostest's own is left out, as it repeats the output."""
    for log in sorted(directory.rglob("*.log")):
        if log.is_file() and not log.name.startswith(("rostest-", "roslaunch-")):
            yield f"--- {log.name}\n" + "\n".join(log.read_text(errors="replace").splitlines()[-30:])


def rostests():
    """The longest first, so that the workers finish at about the same time."""
    names = sorted(FILES, key=lambda name: (name not in LONG, name))
    return [pytest.param(name, marks=pytest.mark.slow if name in SLOW else ()) for name in names]


@pytest.mark.timeout(900)
@pytest.mark.parametrize("name", rostests())
def test_rostest(name, tmp_path):
    status, output = run_rostest(FILES[name], tmp_path)
    # rostest-*.xml holds the <test> tags, each other file the test cases of one test node.
    results = {path: cases_in(path) for path in tmp_path.glob("results/*/*.xml")}
    problems = [problem for cases in results.values() for case in cases for problem in problems_of(case)]
    problems += [f"{path.name}: not one test case ran" for path, cases in results.items() if not cases]
    if status is None:
        problems.insert(0, f"not done after {DEADLINE:.0f} s")
    elif status != 0:
        problems.insert(0, f"rostest ended with status {status}")
    elif not results:
        problems.insert(0, "no results")
    if problems:
        pytest.fail("\n".join([*problems, "--- output", output, *logs(tmp_path / "log")]), pytrace=False)
