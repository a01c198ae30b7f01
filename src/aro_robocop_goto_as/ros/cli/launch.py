"""roslaunch, but its exit status reports how the simulator ended, and it can be interrupted at any time.

roslaunch itself exits with 0 even when a required node failed. A signal that arrives while it starts a process makes it
wait for itself, give up after 20 s and leave master and nodes running.
"""

import argparse
import os
import sys
from typing import List, Optional

import roslaunch
import rospkg
from roslaunch import rlutil
from roslaunch.core import printerrlog
from roslaunch.parent import ROSLaunchParent
from roslaunch.pmon import ProcessListener

from ...hosting.main import prepare
from ...process import signals
from .. import private_api

PACKAGES = ("aro_robocop_goto_as", "aro_sim")  # the simulator's, and the one that starts it for other packages
FAILED = 1  # exit status


class RequiredNodes(ProcessListener):
    """Notes whether a required node of these packages failed; RViz crashing when it closes is no failure."""

    def __init__(self, parent: ROSLaunchParent) -> None:
        self.parent = parent
        self.failed = False

    def process_died(self, process_name: str, exit_code: Optional[int]) -> None:
        """Called by roslaunch; exit_code is minus the signal's number after a signal, None if unknown."""
        process = self.parent.pm.get_process(process_name)
        if exit_code != 0 and process is not None and process.required and process.package in PACKAGES:
            self.failed = True


def launch(arguments: List[str]) -> int:
    """Run a launch file until it ends; returns the exit status."""
    parser = argparse.ArgumentParser(prog="robocop_launch.py", description=__doc__)
    parser.add_argument("-p", "--port", type=int, help="of the ROS master, if one has to be started")
    parser.add_argument("--screen", action="store_true", help="show the output of all nodes")
    parser.add_argument("--no-summary", action="store_true", help="do not list parameters and nodes at the start")
    parser.add_argument("file", nargs="+", metavar="[PACKAGE] FILE [NAME:=VALUE...]")
    options = parser.parse_args(arguments)
    try:
        files = rlutil.resolve_launch_arguments(options.file)
        run_id = rlutil.get_or_generate_uuid(None, False)
        roslaunch.configure_logging(run_id)
        rlutil.check_log_disk_usage()
        rlutil.change_terminal_name(files, False)
        parent = ROSLaunchParent(
            run_id, files, port=options.port, force_screen=options.screen, show_summary=not options.no_summary
        )
        required = RequiredNodes(parent)
        private_api.add_early_listener(parent, required)
        private_api.install_roslaunch_signal_handlers()  # before Deferred, which restores the handlers it finds
        with signals.Deferred():
            parent.start()
        parent.spin()
    except (roslaunch.RLException, rospkg.ResourceNotFound, ValueError) as error:
        printerrlog(f"{type(error).__name__}: {error}")
        return FAILED
    return FAILED if required.failed else 0


def main(arguments: Optional[List[str]] = None) -> None:
    """Launch what these arguments, or the program's own, name; exits with the status of launch()."""
    status = FAILED
    try:
        status = launch(sys.argv[1:] if arguments is None else arguments)
    finally:
        signals.ignore_all()
    sys.exit(status)


def main_with() -> None:
    """robocop sim --with PATH: launch a hosted package in this process, so that ending it ends everything."""
    path, environment = prepare()
    # Not in a new process: in the hosted package's environment this package might not be found.
    os.environ.clear()
    os.environ.update(environment)
    main([str(path)])
