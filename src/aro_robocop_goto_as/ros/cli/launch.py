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
from typing import Any, Dict, Iterator, List, Optional, TextIO, cast

import rosgraph
import roslaunch
import rospkg
from roslaunch import rlutil
from roslaunch.core import printerrlog
from rospkg import get_log_dir

from ...errors import RobocopError, RobotModelError
from ...process import signals
from ...robot.model_names import urdf_of
from .. import log_handlers
from ..names import RVIZ_LOG, SIMULATOR, absolute
from .roslaunch_internals import Launcher

FAILED = 1  # exit status
READY_SERVICE = "pause"  # one of those that the simulator offers when it runs
READY_PATIENCE = 30.0  # [s, wall] for a simulator with a large world on a slow machine
POLL = 0.05  # [s, wall]
STDOUT, STDERR = 1, 2  # file descriptors


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
        sys.stdout = cast(TextIO, log_handlers.Lossy(sys.stdout))
        log_handlers.use()
        roslaunch.configure_logging(run_id)
        rlutil.change_terminal_name(files, False)
        launcher = Launcher(
            run_id,
            files,
            port=options.port,
            force_screen=options.screen,
            force_log=options.quiet,
            show_summary=not options.no_summary,
        )
        with deferred:  # after the launcher has installed its signal handlers, which are restored
            with buffered_stderr(deferred):
                launcher.load()
            _check(launcher.config)
            launcher.start()
        if options.quiet or options.overview:
            simulator = _simulator(launcher, expected=options.overview)
            if not launcher.pm.is_shutdown:
                from .overview import overview  # now that everything else has started

                print(overview(launcher.config, simulator, logs, not options.quiet), file=screen, flush=True)
        if not options.no_summary:
            rlutil.check_log_disk_usage()
        launcher.spin()
    except RobocopError as error:
        print(f"[FATAL] {error.code}: {error}", file=sys.stderr)  # as the simulator's own
        return FAILED
    except (roslaunch.RLException, rospkg.ResourceNotFound, ValueError, OSError) as error:
        if not deferred.interrupted:
            printerrlog(_explained(error) if isinstance(error, OSError) else f"{type(error).__name__}: {error}")
        return FAILED
    return FAILED if launcher.failed else 0


def _simulators(config: Any) -> List[str]:
    """The names of the simulators that a launch file starts."""
    return [rosgraph.names.ns_join(node.namespace, node.name) for node in config.nodes if node.name == SIMULATOR]


def _check(config: Any) -> None:
    """RobocopError for what a simulator would refuse, unless all its parameters have their defaults."""
    for name in _simulators(config):
        given = {key[len(name) + 1 :]: spec.value for key, spec in config.params.items() if key.startswith(f"{name}/")}
        if given:
            from . import preflight

            preflight.check(given, name)


def _simulator(launcher: Launcher, expected: bool) -> Optional[Dict[str, Any]]:
    """Wait until the simulator runs, if the launch file starts one or another process is `expected` to; its parameters.

    So the reason why a simulator can't start is not preceded by what to do with it.
    """
    names = _simulators(launcher.config) or ([absolute("", SIMULATOR)] if expected else [])
    master = rosgraph.Master("/robocop_launch", launcher.config.master.uri)
    deadline = time.monotonic() + READY_PATIENCE
    while names and not launcher.pm.is_shutdown and time.monotonic() < deadline:
        with contextlib.suppress(rosgraph.MasterException, OSError):
            master.lookupService(f"{names[0]}/{READY_SERVICE}")
            return dict(master.getParam(names[0])) if master.hasParam(names[0]) else {}
        launcher.spin_once()
        time.sleep(POLL)
    return None


def _quiet(folder: Path) -> TextIO:
    """Send what this process and its children print to a log file, but not their errors; returns the screen."""
    folder.mkdir(parents=True, exist_ok=True)
    screen = os.fdopen(os.dup(STDOUT), "w", encoding="utf-8", errors="replace")
    with open(folder / "roslaunch.log", "ab") as log:
        os.dup2(log.fileno(), STDOUT)
    os.environ[RVIZ_LOG] = str(folder / "rviz.log")
    return cast(TextIO, log_handlers.Lossy(screen))


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
                with contextlib.suppress(OSError):  # a full disk
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
