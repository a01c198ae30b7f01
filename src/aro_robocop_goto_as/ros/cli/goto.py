"""robocop goto: send one goal from the command line, show its progress, report the result as exit status."""

import argparse
import os
import re
import sys
from pathlib import Path
from typing import Callable, List

import rosgraph
import rospkg

from ...bootstrap import master
from ...errors import MasterError
from ...process import signals
from ..names import COMMAND_VARIABLE
from .goto_arguments import NOT_REACHED, SERVER_PATIENCE, START_PATIENCE, complain, parse
from .own_system import own_system, wait_for_master


def main() -> None:
    """Entry point; exit status 0 when the goal is reached, 1 when not, 2 for invalid arguments."""
    args = parse(rosgraph.myargv()[1:])
    signals.interrupt_on_signal()
    try:
        sys.exit(_run(args))
    except KeyboardInterrupt:
        complain("interrupted")
        os._exit(NOT_REACHED)  # a half-constructed object, such as a tf2 listener, can't be destroyed properly


def _run(args: argparse.Namespace) -> int:
    try:
        system_runs = master.master_answers(master.master_uri())
    except MasterError as error:
        complain(str(error))
        return NOT_REACHED
    if system_runs:
        if args.world:
            complain("--world is ignored: a ROS system is already running")
        return _import_go_to()(args, SERVER_PATIENCE)
    if args.robot:
        complain(
            f"--robot {args.robot}: no ROS master answers, and a simulator started for one goal has one robot only"
        )
        return NOT_REACHED
    print("robocop goto: no ROS master answers; starting a headless simulator for this goal", flush=True)
    arguments = ["rviz:=false", "bridge:=false"]
    if args.world:
        world = os.path.abspath(args.world) if os.path.isfile(args.world) else args.world
        arguments.append(f"world:={world}")
    log = Path(rospkg.get_ros_home(), "robocop_goto.log")
    status = NOT_REACHED
    with own_system("robocop_goto_as.launch", arguments, log) as system:
        go_to = _import_go_to()  # while the system starts, on another processor
        started = wait_for_master(system)
        if started:
            status = go_to(args, START_PATIENCE, ended=lambda: system.poll() is not None)
    errors = [line for line in _lines(log) if "[FATAL]" in line]
    if started and not errors:
        command = os.environ.get(COMMAND_VARIABLE) or "./robocop"
        print(f"robocop goto: the simulator has ended; {command} run starts one that stays, with RViz or a web page")
    if errors or not started:
        lines = ["the system started for this goal failed:", *errors, f"its complete output is in {log}"]
        complain("\n".join(lines))
    return status


def _import_go_to() -> Callable[..., int]:
    """rospy is imported where it is needed, and at its time; an import must not be interrupted half-way."""
    with signals.Deferred():
        from .followed_goal import go_to
    return go_to


def _lines(log: Path) -> List[str]:
    """The log's lines without terminal colours."""
    return [re.sub(r"\x1b\[[0-9;]*m", "", line).rstrip() for line in log.read_text(errors="replace").splitlines()]
