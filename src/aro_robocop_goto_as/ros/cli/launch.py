"""roslaunch, but its exit status reports how the simulator ended, and it can be interrupted at any time.

roslaunch itself exits with 0 even when a required node failed. A signal that arrives while it starts a process makes it
wait for itself, give up after 20 s and leave master and nodes running.
"""

import argparse
import contextlib
import os
import sys
import tempfile
import time
from pathlib import Path
from typing import Any, Dict, Iterator, List, Optional, TextIO

import rosgraph
import roslaunch
import rospkg
from roslaunch import rlutil
from roslaunch.core import printerrlog
from roslaunch.parent import ROSLaunchParent
from roslaunch.pmon import ProcessListener
from rospkg import get_log_dir

from ...errors import RobotModelError
from ...hosting.main import parsed, prepare
from ...process import signals
from ...robot.catalog import urdf_of
from .. import private_api
from . import rviz
from .overview import overview

PACKAGES = ("aro_robocop_goto_as", "aro_sim")  # the simulator's, and the one that starts it for other packages
FAILED = 1  # exit status
SIMULATOR, READY_SERVICE = "robocop_sim", "pause"  # the node, and one of the services that it offers when it runs
READY_PATIENCE = 30.0  # [s, wall] for a simulator with a large world on a slow machine
POLL = 0.05  # [s, wall]
STDOUT, STDERR = 1, 2  # file descriptors


class RequiredNodes(ProcessListener):
    """Notes whether a required node of these packages failed; RViz crashing when it closes is no failure."""

    def __init__(self, parent: ROSLaunchParent) -> None:
        self.parent = parent
        self.failed = False

    def process_died(self, process_name: str, exit_code: Optional[int]) -> None:
        """Called by roslaunch; exit_code is minus the signal's number after a signal, None if unknown."""
        process = self.parent.pm.get_process(process_name)
        if process is None or process.name.rpartition("/")[2].startswith("rviz"):
            return
        if exit_code != 0 and process.required and process.package in PACKAGES:
            self.failed = True


def launch(arguments: List[str]) -> int:
    """Run a launch file until it ends; returns the exit status."""
    parser = argparse.ArgumentParser(prog="robocop_launch.py", description=__doc__)
    parser.add_argument("-p", "--port", type=int, help="of the ROS master, if one has to be started")
    parser.add_argument("--screen", action="store_true", help="show the output of all nodes")
    parser.add_argument("--no-summary", action="store_true", help="do not list parameters and nodes at the start")
    parser.add_argument("--overview", action="store_true", help="show how to use the system when it runs")
    parser.add_argument("--quiet", action="store_true", help="show only that, warnings and errors")
    parser.add_argument("file", nargs="+", metavar="[PACKAGE] FILE [NAME:=VALUE...]")
    options = parser.parse_args(arguments)
    deferred = signals.Deferred()
    try:
        files = rlutil.resolve_launch_arguments(options.file)
        run_id = rlutil.get_or_generate_uuid(None, False)
        logs = Path(get_log_dir(), run_id)
        screen = _quiet(logs) if options.quiet else sys.stdout
        roslaunch.configure_logging(run_id)
        rlutil.check_log_disk_usage()
        rlutil.change_terminal_name(files, False)
        parent = ROSLaunchParent(
            run_id,
            files,
            port=options.port,
            force_screen=options.screen,
            force_log=options.quiet,
            show_summary=not options.no_summary,
        )
        required = RequiredNodes(parent)
        private_api.add_early_listener(parent, required)
        private_api.install_roslaunch_signal_handlers()  # before Deferred, which restores the handlers it finds
        with deferred:
            with buffered_stderr(deferred):
                private_api.load_launch_files(parent)
            parent.start()
        if options.quiet or options.overview:
            simulator = _simulator(parent, expected=options.overview)
            if not parent.pm.is_shutdown:
                print(overview(parent.config, simulator, logs, not options.quiet), file=screen, flush=True)
        parent.spin()
    except (roslaunch.RLException, rospkg.ResourceNotFound, ValueError, OSError) as error:
        if not deferred.interrupted:
            printerrlog(_explained(error) if isinstance(error, OSError) else f"{type(error).__name__}: {error}")
        return FAILED
    return FAILED if required.failed else 0


def _simulator(parent: ROSLaunchParent, expected: bool) -> Optional[Dict[str, Any]]:
    """Wait until the simulator runs, if the launch file starts one or another process is `expected` to; its parameters.

    So the reason why a simulator can't start is not preceded by what to do with it.
    """
    names = [rosgraph.names.ns_join(n.namespace, n.name) for n in parent.config.nodes if n.name == SIMULATOR]
    names = names or ([f"/{SIMULATOR}"] if expected else [])
    master = rosgraph.Master("/robocop_launch", parent.config.master.uri)
    deadline = time.monotonic() + READY_PATIENCE
    while names and not parent.pm.is_shutdown and time.monotonic() < deadline:
        with contextlib.suppress(rosgraph.MasterException, OSError):
            master.lookupService(f"{names[0]}/{READY_SERVICE}")
            return dict(master.getParam(names[0])) if master.hasParam(names[0]) else {}
        parent.spin_once()
        time.sleep(POLL)
    return None


def _quiet(folder: Path) -> TextIO:
    """Send what this process and its children print to a log file, but not their errors; returns the screen."""
    folder.mkdir(parents=True, exist_ok=True)
    screen = os.fdopen(os.dup(STDOUT), "w", encoding="utf-8", errors="replace")
    with open(folder / "roslaunch.log", "ab") as log:
        os.dup2(log.fileno(), STDOUT)
    os.environ[rviz.LOG] = str(folder / "rviz.log")
    return screen


@contextlib.contextmanager
def buffered_stderr(deferred: signals.Deferred) -> Iterator[None]:
    """Print what the block and its child processes write to standard error at its end, unless it is interrupted.

    Ctrl-C also reaches the commands that roslaunch runs for parameters; Python prints a traceback for each.
    """
    sys.stderr.flush()
    screen = os.dup(STDERR)
    with tempfile.TemporaryFile() as buffer, os.fdopen(screen, "wb", buffering=0) as stream:
        os.dup2(buffer.fileno(), STDERR)
        try:
            yield
        finally:
            sys.stderr.flush()
            os.dup2(screen, STDERR)
            buffer.seek(0)
            if not deferred.interrupted:
                stream.write(buffer.read())


def _explained(error: OSError) -> str:
    """An error about a file that an argument names; the file may be that of a robot's model."""
    folder, _, model = str(error.filename).partition("/urdf/")
    if not model.endswith(".urdf"):
        return f"{error.filename}: {error.strerror}" if error.filename else str(error)
    try:
        return str(error) if urdf_of(model[: -len(".urdf")], folder) else ""
    except RobotModelError as unknown:
        return f"{unknown.code}: {unknown}"


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
    args = parsed()
    path, environment = prepare(args)
    # Not in a new process: in the hosted package's environment this package might not be found.
    os.environ.clear()
    os.environ.update(environment)
    main([*([] if args.verbose else ["--no-summary"]), "--overview", str(path)])
