"""Runs every .test file of test/ros/nodes by rostest, each with its own master and logs."""

import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest
from systems import System

DEADLINE = 800.0  # [s, wall] for one .test file; each <test> in it has a shorter time-limit.
FILES = {path.stem: path for path in Path(__file__).resolve().parent.glob("nodes/*.test")}
LONG = ("faults", "lab", "time_and_pose")
ROSTEST = "import rostest; rostest.rostestmain()"  # the same as the program of this name
SLOW = ("commands", "faults", "figures", "navigation", "time_and_pose", "two_robots")


def run_rostest(test_file, directory):
    """Run one file: the exit status and the output."""
    with System(directory) as system:
        for name in ("ROS_MASTER_URI", "DISPLAY"):  # it starts a master of its own
            system.environment.pop(name, None)
        command = [sys.executable, "-c", ROSTEST, f"--results-base-dir={directory / 'results'}", test_file]
        rostest = system.start("output", *command)
        return rostest.wait_for_exit(DEADLINE), rostest.output


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
    if status != 0:
        problems.insert(0, f"rostest ended with status {status}")
    elif not results:
        problems.insert(0, "no results")
    if problems:
        pytest.fail("\n".join([*problems, "--- output", output, *logs(tmp_path / "ros" / "log")]), pytrace=False)
