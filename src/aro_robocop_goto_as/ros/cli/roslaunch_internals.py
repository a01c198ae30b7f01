"""Everything that uses private parts of roslaunch, each with the reason."""

import functools
import os
import subprocess
from pathlib import Path
from types import SimpleNamespace
from typing import Any, Callable, Optional

import rosgraph
import rosparam  # with its tags for YAML, such as !degrees
from rosgraph.xmlrpc import XmlRpcNode
from roslaunch import loader, nodeprocess, pmon
from roslaunch.parent import ROSLaunchParent
from roslaunch.pmon import ProcessListener

from ...bootstrap import master
from ...errors import MasterError, ParameterError
from ...process.orphans import end_with_parent
from ...reading import reading
from ..names import PACKAGE
from ..own_master import start_master
from .preflight import require_parameters

PACKAGES = (PACKAGE, "aro_sim")  # the simulator's, and the one that starts it for other packages


class Launcher(ROSLaunchParent, ProcessListener):
    """roslaunch's parent of all nodes, with a ROS master in its own process where none answers.

    roslaunch would start one as a process of its own. It has imported rosmaster in any case, and uses a master that
    answers.
    """

    failed = False  # whether a required node of PACKAGES did; RViz crashing when it closes is no failure
    _master: Optional[XmlRpcNode] = None

    def __init__(self, *args: Any, **options: Any) -> None:
        """Arguments as those of ROSLaunchParent."""
        super().__init__(*args, **options)
        pmon._init_signal_handlers()  # roslaunch does it when it starts the first process
        nodeprocess.subprocess = SimpleNamespace(Popen=_popen)  # roslaunch has no hook between fork and exec
        loader.Loader.load_rosparam = _checking_files(loader.Loader.load_rosparam)

    def load(self) -> None:
        """Load the launch files; start() loads them only if nobody has.

        ParameterError for so many robots that the files, one within another for each robot, are nested too deeply.
        """
        try:
            self._load_config()
        except RecursionError as error:
            raise ParameterError(
                "robots: too many for a launch file, or launch files that include themselves"
            ) from error

    def _start_pm(self) -> None:
        """Listen from the first process on: roslaunch adds listeners when all run, and one may have ended by then."""
        super()._start_pm()
        self.pm.add_process_listener(self)

    def _init_runner(self) -> None:
        super()._init_runner()
        find_master = self.runner._launch_master

        def start_or_find_master() -> bool:
            is_own = self._start_master(self.config.master.uri)
            return find_master() or is_own  # if so, roslaunch starts rosout, which gathers all logs in /rosout_agg

        self.runner._launch_master = start_or_find_master

    def _start_master(self, uri: str) -> bool:
        """Whether this process has a master at this address now: not if one answers there or it is another machine's.

        Then, or if another process has the port, roslaunch uses that master, or says why it can't.
        """
        host, port = rosgraph.network.parse_http_host_and_port(uri)
        try:
            if not rosgraph.network.is_local_address(host) or master.master_answers(uri):
                return False
        except MasterError:  # something else answers there
            return False
        self._master = start_master(port)
        return self._master is not None

    def _stop_infrastructure(self) -> None:
        super()._stop_infrastructure()
        if self._master:
            self._master.shutdown("the launcher ends")

    def process_died(self, process_name: str, exit_code: Optional[int]) -> None:
        """Called by roslaunch; exit_code is minus the signal's number after a signal, None if unknown."""
        process = self.pm.get_process(process_name)
        if process is None or process.name.rpartition("/")[2].startswith("rviz"):
            return
        if exit_code != 0 and process.required and process.package in PACKAGES:
            self.failed = True


def _checking_files(load_rosparam: Callable[..., None]) -> Callable[..., None]:
    """A loader of <rosparam> that checks files; roslaunch prints a traceback for values that XML-RPC can't send."""

    @functools.wraps(load_rosparam)
    def checked(*arguments: Any, **options: Any) -> None:
        _, _, _, command, _, file, *_ = arguments
        if command == "load" and file and os.path.isfile(file):
            with reading(file, ParameterError, "parameters in YAML"):
                require_parameters(rosparam.yaml.safe_load(Path(file).read_text()) or {}, file)
        load_rosparam(*arguments, **options)

    return checked


def _popen(command: Any, preexec_fn: Callable[[], None], **options: Any) -> "subprocess.Popen[Any]":
    """Start a node that Linux ends when this process ends without doing so, as by SIGKILL.

    roslaunch starts nodes in the main thread, and again, with respawn, in one that lives as long as they do.
    """
    terminate = end_with_parent()

    def between_fork_and_exec() -> None:
        preexec_fn()
        terminate()

    return subprocess.Popen(command, preexec_fn=between_fork_and_exec, **options)
