"""roslaunch, but its exit status reports how the simulator ended, and the screen shows what its user needs.

roslaunch itself exits with 0 even when a required node failed.
"""

import argparse
import contextlib
import os
import re
import sys
import time
from pathlib import Path
from typing import Any, Callable, Dict, List, Optional, TextIO, TypeVar

import rosgraph
import roslaunch
import rospkg
from roslaunch import rlutil
from roslaunch.parent import ROSLaunchParent
from roslaunch.pmon import ProcessListener

from ...errors import RobocopError
from ...names import PACKAGE, RVIZ_LOG, SIMULATOR, absolute
from ...process import signals

FAILED = 1  # exit status
PACKAGES = (PACKAGE, "aro_sim")  # the simulator's, and the one that starts it for other packages
READY_SERVICE = "pause"  # one of those that the simulator offers when it runs
READY_TIMEOUT = 30.0  # [s, wall] for a simulator with a large world on a slow machine
POLL = 0.05  # [s, wall]
STDOUT = 1  # file descriptor
T = TypeVar("T")


class Launcher(ROSLaunchParent, ProcessListener):
    """roslaunch's parent of all nodes; it notes whether the simulator has failed, and reports a clean end if brief."""

    failed = False  # whether a required node of PACKAGES has; an RViz that crashes when it closes is no failure

    def __init__(self, *args: Any, brief: bool, **options: Any) -> None:
        """Arguments as those of ROSLaunchParent; brief: roslaunch's own messages go to a log."""
        super().__init__(*args, process_listeners=[self], **options)
        self._brief = brief
        self.ended: List[str] = []  # names of nodes

    def process_died(self, process_name: str, exit_code: Optional[int]) -> None:
        """Called by roslaunch; exit_code is minus the signal's number after a signal, None if unknown."""
        process = self.pm.get_process(process_name)
        if process is None or process.name.rpartition("/")[2].startswith("rviz"):
            return
        if exit_code != 0 and process.required and process.package in PACKAGES:
            self.failed = True
        name = process_name.rpartition("-")[0]
        self.ended += [] if process.respawn else [name]
        if exit_code == 0 and self._brief and not (process.respawn or self.pm.is_shutdown):
            reasons = "as after `rosnode kill`, or if its program has nothing left to do (is rospy.spin() called?)"
            print(f"[WARN] {name} has ended, without an error, {reasons}", file=sys.stderr)


def launch(arguments: List[str]) -> int:
    """Run a launch file until it ends; returns the exit status."""
    options = _parsed(arguments)
    deferred = signals.Deferred()
    try:
        _check(options.file)
        return _run(options, deferred)
    except RobocopError as error:
        print(f"[FATAL] {error.code}: {error}", file=sys.stderr)  # as the simulator's own
    except RecursionError:  # launch/each_robot.launch includes itself for the next robot
        print("[FATAL] PARAMETER: robots: too many for a launch file", file=sys.stderr)
    except (roslaunch.RLException, rospkg.ResourceNotFound, ValueError, OSError) as error:
        if not deferred.interrupted:  # Ctrl-C also ends the commands that roslaunch runs for parameters
            print(f"[FATAL] {type(error).__name__}: {_told(error, options.file)}", file=sys.stderr)
    return FAILED


def _parsed(arguments: List[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="robocop_launch.py", description=__doc__)
    parser.add_argument("-p", "--port", type=int, help="of the ROS master, if one has to be started")
    parser.add_argument("--no-summary", action="store_true", help="do not show roslaunch's own messages")
    parser.add_argument("--overview", action="store_true", help="show how to use the system when it runs")
    parser.add_argument("--quiet", action="store_true", help="show only that, warnings and errors")
    parser.add_argument("file", nargs="+", metavar="[PACKAGE] FILE [NAME:=VALUE...]")
    return parser.parse_args(arguments)


def _run(options: argparse.Namespace, deferred: signals.Deferred) -> int:
    """Start the processes with signals deferred, and wait for their end; returns the exit status."""
    files = rlutil.resolve_launch_arguments(options.file)
    run_id = rlutil.get_or_generate_uuid(None, False)
    logs = Path(rospkg.get_log_dir(), run_id)
    brief = options.quiet or options.no_summary
    screen = _to_log(logs, options.quiet) if brief else sys.stdout
    roslaunch.configure_logging(run_id)
    rlutil.change_terminal_name(files, False)
    launcher = Launcher(
        run_id,
        files,
        port=options.port,
        force_log=options.quiet,
        brief=brief,
        show_summary=not options.no_summary,
    )
    roslaunch.Process(PACKAGE, "launcher", [], {})  # never started: the first one installs roslaunch's signal handlers
    with deferred:  # a signal while roslaunch starts a process makes it wait for itself, for 10 s and more
        launcher.start()
        failed = launcher.pm.is_shutdown and not deferred.interrupted  # too early for process_died()
    if options.quiet or options.overview:
        simulator = _simulator(launcher, expected=options.overview)
        from .overview import is_page, overview  # now that everything else has started

        running = [node for node in launcher.config.nodes if not is_page(node) or _has_started(launcher, node)]
        if not launcher.pm.is_shutdown:
            print(overview(running, simulator, logs, not options.quiet), file=screen, flush=True)
            for name in launcher.ended:
                print(f"[WARN] {name} has ended already; its last messages are above", file=sys.stderr, flush=True)
    if not options.no_summary:
        with deferred:  # a signal during logging would leave its lock held, and the monitor would wait 20 s for it
            rlutil.check_log_disk_usage()
    launcher.spin()
    return FAILED if failed or launcher.failed else 0


def _check(words: List[str]) -> None:
    """RobocopError for NAME:=VALUE that would end the simulator or roslaunch at its start."""
    given = dict(word.split(":=", 1) for word in words if ":=" in word)
    if given:
        from . import preflight

        preflight.check(given)


def _told(error: Exception, words: List[str]) -> str:
    """An error's text without the XML that roslaunch appends, after each NAME:=VALUE whose value it refuses."""
    text = re.split(r"\s*\w+ xml is ", str(error), maxsplit=1)[0]
    refused = []
    for word in words:
        _, separator, value = word.partition(":=")
        value = re.escape(value.strip())
        # roslaunch writes it in lower case
        if separator and re.search(rf"(^|: ){value} is not a '", text, re.IGNORECASE):
            refused.append(word)
    return ": ".join([*refused, text])


def _simulator(launcher: Launcher, expected: bool) -> Optional[Dict[str, Any]]:
    """Wait until the simulator runs, if the launch file starts one or another process is `expected` to; its parameters.

    Otherwise the overview would be printed before the reason why the simulator can't start.
    """
    nodes = [node for node in launcher.config.nodes if node.name == SIMULATOR]
    names = [rosgraph.names.ns_join(node.namespace, node.name) for node in nodes]
    names = names or ([absolute("", SIMULATOR)] if expected else [])
    master = _master(launcher)

    def parameters() -> Dict[str, Any]:
        master.lookupService(f"{names[0]}/{READY_SERVICE}")
        return dict(master.getParam(names[0])) if master.hasParam(names[0]) else {}

    return _answer(launcher, parameters) if names else None


def _has_started(launcher: Launcher, node: Any) -> bool:
    """Wait until a node has registered with the master; return whether it has, instead of ending before."""
    name = rosgraph.names.ns_join(node.namespace, node.name)
    master = _master(launcher)

    def is_registered() -> bool:
        runs = any(process.rpartition("-")[0] == name.strip("/") for process in launcher.pm.get_active_names())
        return runs and bool(master.lookupNode(name))

    return bool(_answer(launcher, is_registered))


def _master(launcher: Launcher) -> rosgraph.Master:
    return rosgraph.Master("/robocop_launch", launcher.config.master.uri)


def _answer(launcher: Launcher, ask: Callable[[], T]) -> Optional[T]:
    """What `ask` returns once it has no error of the master's; None if everything ends or READY_TIMEOUT is over."""
    deadline = time.monotonic() + READY_TIMEOUT
    while not launcher.pm.is_shutdown and time.monotonic() < deadline:
        with contextlib.suppress(rosgraph.MasterException, OSError):
            return ask()
        launcher.spin_once()
        time.sleep(POLL)
    return None


def _to_log(folder: Path, with_children: bool) -> TextIO:
    """Send what this process prints, but not its errors, to a log file, also what its children print if
    `with_children`; returns the screen.
    """
    folder.mkdir(parents=True, exist_ok=True)
    screen = os.fdopen(os.dup(STDOUT), "w", encoding="utf-8", errors="replace")
    sys.stdout = open(folder / "roslaunch.log", "a", buffering=1, encoding="utf-8", errors="replace")
    if with_children:
        os.dup2(sys.stdout.fileno(), STDOUT)
    os.environ[RVIZ_LOG] = str(folder / "rviz.log")
    return screen


def main(arguments: Optional[List[str]] = None) -> None:
    """Launch what these arguments, or the program's own, name; exits with the status of launch()."""
    status = FAILED
    try:
        status = launch(sys.argv[1:] if arguments is None else arguments)
    finally:
        signals.ignore_all()
    sys.exit(status)
