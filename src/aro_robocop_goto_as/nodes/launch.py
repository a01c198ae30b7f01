"""roslaunch with an exit status that tells how the simulator ended, and with an end at whatever moment it is told to.

roslaunch itself ends with 0 whatever became of its nodes, of a required one too; and a signal that comes while it
starts a process makes it wait for itself, give up after 20 s and leave master and nodes running. This is the same
program in the same process, so output and options are its own.
"""

import os
import sys
from typing import Any, List, Optional

import roslaunch
import roslaunch.parent
import roslaunch.pmon

from ..hosting.main import prepare
from ..interruption import Deferred, the_end

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


class Parent(roslaunch.parent.ROSLaunchParent):
    """Starts all processes before a signal ends them, and listens from the first one on.

    (roslaunch's own way of adding listeners does so when all nodes are up: one may have died by then.)
    """

    listeners: List[RequiredNodes] = []

    def start(self, auto_terminate: bool = True) -> None:
        roslaunch.pmon._init_signal_handlers()  # as its child mode does; it would be with the first process
        with Deferred():
            super().start(auto_terminate)

    def _start_pm(self) -> None:
        super()._start_pm()
        self.listeners.append(RequiredNodes(self.pm))
        self.pm.add_process_listener(self.listeners[-1])


def main(arguments: Optional[List[str]] = None) -> None:
    """Run roslaunch with these arguments, or with this program's; exit status as roslaunch's, or FAILED."""
    roslaunch.parent.ROSLaunchParent = Parent
    try:
        roslaunch.main(["roslaunch", *(sys.argv[1:] if arguments is None else arguments)])
    finally:
        the_end()
    sys.exit(FAILED if any(listener.failed for listener in Parent.listeners) else 0)


def main_with() -> None:
    """robocop sim --with PATH: becomes the roslaunch of somebody's package, so that what ends this ends all."""
    path, environment = prepare()
    # In this process, where this package is found whatever the hosted one is called.
    os.environ.clear()
    os.environ.update(environment)
    main([str(path)])
