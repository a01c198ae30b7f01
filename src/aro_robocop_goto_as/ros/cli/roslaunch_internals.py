"""Everything that uses private parts of roslaunch, each with the reason."""

import subprocess
from types import SimpleNamespace
from typing import Any, Callable

from roslaunch import nodeprocess, pmon

from ...errors import ParameterError
from ...process.parent_death import end_with_parent


def load_launch_files(parent: Any) -> None:
    """Load the files of a ROSLaunchParent that is not started yet; its start() loads them only if nobody has.

    ParameterError for so many robots that the files, one within another for each robot, are nested too deeply.
    """
    try:
        parent._load_config()
    except RecursionError as error:
        raise ParameterError("robots: too many for a launch file, or launch files that include themselves") from error


def add_early_listener(parent: Any, listener: Any) -> None:
    """Add a process listener to a ROSLaunchParent that is not started yet, so that it misses no process.

    ROSLaunchParent itself adds listeners when all nodes are up; one may have ended by then.
    """
    start_process_monitor = parent._start_pm

    def start_process_monitor_with_listener() -> None:
        start_process_monitor()
        parent.pm.add_process_listener(listener)

    parent._start_pm = start_process_monitor_with_listener


def start_core_nodes(parent: Any) -> None:
    """Have a ROSLaunchParent that is not started yet start rosout, which gathers the logs of all nodes in /rosout_agg.

    roslaunch does so only with a master that it started itself.
    """
    init_runner = parent._init_runner

    def init_runner_as_with_own_master() -> None:
        init_runner()
        find_master = parent.runner._launch_master

        def find_own_master() -> bool:
            find_master()
            return True

        parent.runner._launch_master = find_own_master

    parent._init_runner = init_runner_as_with_own_master


def install_roslaunch_signal_handlers() -> None:
    """Install roslaunch's signal handlers now; roslaunch does it when it starts the first process."""
    pmon._init_signal_handlers()


def end_processes_with_roslaunch() -> None:
    """Have Linux end all nodes when this process ends without doing so, as by SIGKILL.

    roslaunch starts them in the main thread, and again, with respawn, in one that lives as long as they do. It has no
    hook between fork and exec.
    """
    terminate = end_with_parent()
    start: Any = subprocess.Popen

    def popen(*args: Any, preexec_fn: Callable[[], None], **options: Any) -> Any:
        def between_fork_and_exec() -> None:
            preexec_fn()
            terminate()

        return start(*args, preexec_fn=between_fork_and_exec, **options)

    nodeprocess.subprocess = SimpleNamespace(Popen=popen)
