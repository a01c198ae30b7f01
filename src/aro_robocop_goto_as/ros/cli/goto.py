"""robocop goto: send one goal from the command line, show its progress, report the result as exit status."""

import argparse
import os
import sys

import rosgraph

from ...errors import MasterError
from ...names import robocop
from ...process import signals
from .. import graph, settings
from .goto_arguments import NOT_REACHED, complain, parse


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
    uri = rosgraph.get_master_uri()
    try:
        problem = settings.problem()
        if not problem and not graph.master_answers():
            problem = f"no ROS master answers at {uri}: start a system with {robocop()} run in another terminal"
    except MasterError as error:
        problem = str(error)
    if problem:
        complain(problem)
        return NOT_REACHED
    with signals.Deferred():  # a signal must not interrupt the import of rospy half-way
        from .followed_goal import go_to
    return go_to(args)
