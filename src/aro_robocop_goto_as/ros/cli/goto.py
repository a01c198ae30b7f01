"""robocop goto: send one goal from the command line, show its progress, report the result as exit status.

If no ROS system runs, it starts a system on a free port. That system ends with all its processes when the goal has
ended.
"""

import argparse
import contextlib
import os
import re
import sys
import time
from pathlib import Path
from typing import Any, Callable, Iterator, List

import rospkg

from ...errors import MasterError, RobocopError
from ...launch_arguments import LaunchArguments
from ...names import PACKAGE, robocop
from ...probes import master, settings
from ...process import child, orphans, signals
from ...process.ports import free_port
from ..share import share
from .goto_arguments import NOT_REACHED, SERVER_TIMEOUT, START_TIMEOUT, WRONG_ARGUMENTS, complain, parse, tell

LAUNCH_FILE = Path(share(), "launch", "robocop_goto_as.launch")
END_TIMEOUT = 30.0  # [s, wall] for the system to end; roslaunch itself kills nodes after 17 s
POLL = 0.05  # [s, wall]


def main() -> None:
    """Entry point; exit status 0 when the goal is reached, 1 when not, 2 for invalid arguments."""
    args = parse(sys.argv[1:])
    signals.interrupt_on_signal()
    try:
        sys.exit(_run(args))
    except KeyboardInterrupt:
        complain("interrupted")
        os._exit(NOT_REACHED)  # a half-constructed object, such as a tf2 listener, can't be destroyed properly


def _run(args: argparse.Namespace) -> int:
    uri = master.master_uri()
    try:
        given = LaunchArguments.parse(LAUNCH_FILE, args.launch)
    except RobocopError as error:
        complain(str(error))
        return WRONG_ARGUMENTS
    try:
        problem = settings.problem()
        system_runs = not problem and master.master_answers(uri)
    except MasterError as error:
        problem = str(error)
    if problem:
        complain(problem)
        return NOT_REACHED
    if system_runs:
        if given.words:
            complain(f"{given.words[0]} is for a simulator that goto would start, but a system is running on {uri}")
            return WRONG_ARGUMENTS
        return _import_go_to()(args, SERVER_TIMEOUT)
    return _go_in_own_system(args, given)


def _go_in_own_system(args: argparse.Namespace, given: LaunchArguments) -> int:
    if args.robot and not given.value("robots"):
        complain(f"--robot {args.robot}: no ROS master answers; a simulator with several robots needs robots:=...")
        return NOT_REACHED
    try:
        _check(given)
    except RobocopError as error:
        complain(str(error))
        return WRONG_ARGUMENTS
    arguments = ["rviz:=false", "bridge:=false", *given.words]
    tell("robocop goto: no ROS master answers; starting a headless simulator for this goal")
    log = Path(rospkg.get_ros_home(), "robocop_goto.log")
    status = NOT_REACHED
    with _own_system(arguments, log) as system:
        go_to = _import_go_to()  # while the system starts, on another processor
        started = _wait_for_master(system)
        if started:
            status = go_to(args, START_TIMEOUT, ended=lambda: system.poll() is not None)
    errors = [line for line in _lines(log) if "[FATAL]" in line]
    if started and not errors:
        tell(f"robocop goto: the simulator has ended; {robocop()} run starts one that stays, with RViz or a web page")
    if errors or not started:
        lines = ["the system started for this goal failed:", *errors, f"its complete output is in {log}"]
        complain("\n".join(lines))
    return status


def _check(given: LaunchArguments) -> None:
    """RobocopError for values that the simulator would refuse."""
    if given.words:
        from . import preflight  # only where it is needed, as it takes time

        preflight.check(dict(word.split(":=", 1) for word in given.words))


def _import_go_to() -> Callable[..., int]:
    """Import rospy, only where it is needed; a signal must not interrupt the import half-way."""
    with signals.Deferred():
        from .followed_goal import go_to
    return go_to


@contextlib.contextmanager
def _own_system(arguments: List[str], log: Path) -> "Iterator[child.Child[Any]]":
    """Launch a system with its own master, and yield the launcher's process at once. Output goes to `log`.

    Sets ROS_MASTER_URI of this process. The system ends with the block, also when a signal ends the block.
    """
    port = free_port()
    os.environ["ROS_MASTER_URI"] = f"http://localhost:{port}"
    log.parent.mkdir(parents=True, exist_ok=True)
    launcher = [sys.executable, f"{share()}/launch/robocop_launch.py"]
    command = [*launcher, "--no-summary", "-p", str(port), PACKAGE, LAUNCH_FILE.name, *arguments]
    orphans.adopt_orphans()
    system = None
    try:
        with signals.Deferred():
            system = child.start(command, log, preexec_fn=orphans.end_with_parent())  # this thread is the main one
        yield system
    finally:
        signals.begin_cleanup()  # a second Ctrl-C must not leave half of the system behind
        if system is not None:
            child.end(system, grace=END_TIMEOUT)
            orphans.kill_descendants()


def _wait_for_master(system: "child.Child[Any]") -> bool:
    """Return whether the system's master answers, before the system ends or its time is over."""
    deadline = time.monotonic() + START_TIMEOUT
    while time.monotonic() < deadline and system.poll() is None:
        with contextlib.suppress(MasterError):  # on a loaded machine it may open its port long before it answers
            if master.master_answers(master.master_uri()):
                return True
        time.sleep(POLL)
    return False


def _lines(log: Path) -> List[str]:
    """The log's lines without terminal colours."""
    return [re.sub(r"\x1b\[[0-9;]*m", "", line).rstrip() for line in log.read_text(errors="replace").splitlines()]
