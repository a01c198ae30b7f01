"""roslaunch with an exit status that tells how the simulator ended.

roslaunch itself ends with 0 whatever became of its nodes, of a required one too. This is the same program in the same
process, so signals, output and options are its own.
"""

import os
import sys
from typing import Any, List, Optional

import roslaunch
import roslaunch.pmon

from ..hosting.main import prepare

PACKAGES = ("aro_robocop_goto_as", "aro_sim")  # of the simulator, and of what starts it for other people's packages
FAILED = 1  # exit status: a required node of these ended by an error. RViz' crashes on closing are no failure of a run


class RequiredNodes(roslaunch.pmon.ProcessListener):
    """Hears of each process that ends before roslaunch is told to end."""

    def __init__(self, monitor: Any) -> None:
        self.monitor = monitor
        self.failed = False

    def process_died(self, process_name: str, exit_code: Optional[int]) -> None:
        """exit_code: negative, the number of a signal that it was killed by; None, unknown."""
        process = self.monitor.get_process(process_name)
        if exit_code != 0 and process is not None and process.required and process.package in PACKAGES:
            self.failed = True


def main(arguments: Optional[List[str]] = None) -> None:
    """Run roslaunch with these arguments, or with this program's; exit status as roslaunch's, or FAILED."""
    heard = []
    start_process_monitor = roslaunch.pmon.start_process_monitor

    def start_and_listen() -> Any:
        monitor = start_process_monitor()
        if monitor is not None:  # not where a signal has come meanwhile
            heard.append(RequiredNodes(monitor))
            monitor.add_process_listener(heard[-1])
        return monitor

    # ROSLaunchParent takes listeners too, but adds them when all nodes are up: one may have died by then.
    roslaunch.pmon.start_process_monitor = start_and_listen
    roslaunch.main(["roslaunch", *(sys.argv[1:] if arguments is None else arguments)])
    sys.exit(FAILED if any(listener.failed for listener in heard) else 0)


def main_with() -> None:
    """robocop sim --with PATH: becomes the roslaunch of somebody's package, so that what ends this ends all."""
    path, environment = prepare()
    # In this process, where this package is found whatever the hosted one is called.
    os.environ.clear()
    os.environ.update(environment)
    main([str(path)])
