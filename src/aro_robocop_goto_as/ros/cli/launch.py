"""roslaunch with an exit status: 1 after a required node has failed, where roslaunch's is 0; and an overview."""

import argparse
import sys
import time
import xmlrpc.client
from pathlib import Path
from typing import Any, Dict, List, Optional

import rosgraph
import roslaunch
import rospkg
from roslaunch import rlutil
from roslaunch.parent import ROSLaunchParent
from roslaunch.pmon import ProcessListener, ProcessMonitor

from ...names import PACKAGE, SIMULATOR, absolute
from ...process import signals

FAILED = 1  # exit status
READY_SERVICE = "pause"  # one of those that the simulator offers when it runs
READY_TIMEOUT = 30.0  # [s, wall] for a simulator with a large world on a slow machine
POLL = 0.05  # [s, wall]
WHOLE_NODE = "\n\nNode xml is"  # in roslaunch's text about a <param>, after the XML of that


class Failure(ProcessListener):
    """Whether a required node has failed."""

    def __init__(self, monitor: ProcessMonitor) -> None:
        self._monitor = monitor
        self.happened = monitor.is_shutdown  # it has, before this listener was there

    def process_died(self, process_name: str, exit_code: Optional[int]) -> None:
        """Called by roslaunch; exit_code is minus the signal's number after a signal, None if unknown."""
        process = self._monitor.get_process(process_name)
        is_rviz = process_name.rpartition("/")[2].startswith("rviz")  # it may crash when it is closed
        if exit_code != 0 and process is not None and process.required and not is_rviz:
            self.happened = True


def launch(arguments: List[str]) -> int:
    """Run a launch file until it ends; returns the exit status."""
    parser = argparse.ArgumentParser(prog="robocop_launch.py", description=__doc__)
    parser.add_argument("--no-summary", action="store_true", help="do not list parameters and nodes")
    parser.add_argument("--overview", action="store_true", help="show how to use the system when it runs")
    parser.add_argument("--quiet", action="store_true", help="both, and of the nodes only warnings and errors")
    parser.add_argument("file", nargs="+", metavar="[PACKAGE] FILE [NAME:=VALUE...]")
    deferred = signals.Deferred()
    try:
        return _run(parser.parse_args(arguments), deferred)
    except RecursionError:  # launch/each_robot.launch includes itself for the next robot
        print("[FATAL] robots: too many for a launch file", file=sys.stderr)
    except (roslaunch.RLException, rospkg.ResourceNotFound, ValueError, OSError) as error:
        if not deferred.interrupted:  # Ctrl-C also ends the commands that roslaunch runs for parameters
            print(f"[FATAL] {str(error).partition(WHOLE_NODE)[0]}", file=sys.stderr)
    return FAILED


def _run(options: argparse.Namespace, deferred: signals.Deferred) -> int:
    """Start the processes with signals deferred, and wait for their end; returns the exit status."""
    run_id = rlutil.get_or_generate_uuid(None, False)
    roslaunch.configure_logging(run_id)
    launcher = ROSLaunchParent(
        run_id,
        rlutil.resolve_launch_arguments(options.file),
        force_log=options.quiet,
        show_summary=not (options.quiet or options.no_summary),
    )
    roslaunch.Process(PACKAGE, "launcher", [], {})  # never started: the first one installs roslaunch's signal handlers
    with deferred:  # a signal while roslaunch starts a process makes it wait for itself, for 10 s and more
        try:
            launcher.start()
        except (TypeError, OverflowError) as error:
            raise roslaunch.RLException(f"{_unsendable(launcher.config.params)}: {error}") from error
        failure = Failure(launcher.pm)
        launcher.pm.add_process_listener(failure)
    if options.quiet or options.overview:
        _show_overview(launcher, Path(rospkg.get_log_dir(), run_id), options)
    launcher.spin()
    return FAILED if failure.happened else 0


def _unsendable(params: Dict[str, Any]) -> str:
    """The parameter that has no value or a large integer. roslaunch names the last one of all instead."""
    for name, parameter in params.items():
        try:
            xmlrpc.client.dumps((parameter.value,))
        except (TypeError, OverflowError):
            return name
    return "parameters"


def _show_overview(launcher: ROSLaunchParent, logs: Path, options: argparse.Namespace) -> None:
    """Print it when the simulator runs: if it ends at its start, its reason is the last line on the screen."""
    started = launcher.config.nodes
    expected = options.overview or any(node.name == SIMULATOR for node in started)
    simulator = _simulator(launcher) if expected else None
    from .overview import overview  # now that everything else has started

    if not launcher.pm.is_shutdown:
        running = {process.rpartition("-")[0] for process in launcher.pm.get_active_names()}
        nodes = [node for node in started if f"{node.namespace}{node.name}".strip("/") in running]
        print(overview(nodes, simulator, logs, not options.quiet), flush=True)


def _simulator(launcher: ROSLaunchParent) -> Optional[Dict[str, Any]]:
    """Wait for the simulator; its parameters, or None if everything ends or READY_TIMEOUT is over."""
    name = absolute("", SIMULATOR)
    master = rosgraph.Master("/robocop_launch", launcher.config.master.uri)
    deadline = time.monotonic() + READY_TIMEOUT
    while not launcher.pm.is_shutdown and time.monotonic() < deadline:
        try:
            master.lookupService(f"{name}/{READY_SERVICE}")
            return dict(master.getParam(name)) if master.hasParam(name) else {}
        except (rosgraph.MasterException, OSError):
            launcher.spin_once()
            time.sleep(POLL)
    return None


def main(arguments: Optional[List[str]] = None) -> None:
    """Launch what these arguments, or the program's own, name; exits with the status of launch()."""
    status = FAILED
    try:
        status = launch(sys.argv[1:] if arguments is None else arguments)
    finally:
        signals.ignore_all()
    sys.exit(status)
