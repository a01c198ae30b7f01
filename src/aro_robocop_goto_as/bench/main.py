"""The command: every case, repeat by repeat, then the report."""

import argparse
import signal
import sys
from pathlib import Path
from typing import Any, List

import rospy

from ..errors import BenchError
from . import cases, report
from .measure import bare, simulate
from .processes import own_ros
from .results import Measured

SECONDS, REPEATS = 5.0, 3
QUICK_SECONDS, QUICK_REPEATS = 1.5, 1
FAST, PACED = 0.0, 1.0  # real-time factors


def _arguments(argv: List[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="robocop bench", description="Measure how fast the simulator is, what it costs, and its floor.",
        epilog="Exit status 1 when a case failed, 2 when nothing was measured. A run takes about "
               "(3 SECONDS + 6) x REPEATS for each case; be sure that the machine has nothing else to do.")
    parser.add_argument("--json", action="store_true", help="for machines, every single run included")
    parser.add_argument("--quick", action="store_true",
                        help=f"{QUICK_SECONDS:g} s a measurement, {QUICK_REPEATS} repeat, where not said otherwise")
    parser.add_argument("--seconds", type=_seconds, help=f"wall time of each measurement (default {SECONDS:g})")
    parser.add_argument("--repeats", type=_repeats, help=f"of which the medians are shown (default {REPEATS})")
    parser.add_argument("--cases", nargs="+", default=[], metavar="DRIVE[:ROBOTS]",
                        help="such as wheels:1 kinematic; default: " +
                             " ".join(case.name for case in cases.default_cases()))
    args = parser.parse_args(argv)
    args.seconds = args.seconds or (QUICK_SECONDS if args.quick else SECONDS)
    args.repeats = args.repeats or (QUICK_REPEATS if args.quick else REPEATS)
    return args


def _seconds(text: str) -> float:
    value = float(text)
    if not 0.1 <= value <= 3600.0:
        raise argparse.ArgumentTypeError(f"expected 0.1 to 3600 s, got {text}")
    return value


def _repeats(text: str) -> int:
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"expected 1 or more, got {text}")
    return value


def _measure(measured: Measured, seconds: float, simulator: str, directory: Path) -> None:
    """One repeat of a case; a failure is kept with it."""
    case = measured.case
    try:
        measured.floors.append(bare(case, seconds, directory))
        measured.fastest.append(simulate(case, FAST, seconds, simulator, directory))
        measured.paced.append(simulate(case, PACED, seconds, simulator, directory))
    except BenchError as error:
        measured.error = str(error)
        print(f"robocop bench: {case.name}: {error}", file=sys.stderr)


def _measure_all(wanted: List[cases.Case], args: argparse.Namespace) -> List[Measured]:
    """Repeats of all cases take turns, so that a busy spell of the machine does not hit one case alone."""
    simulator = str(Path(sys.argv[0]).absolute().parent / "robocop_sim.py")
    results = [Measured(case) for case in wanted]
    with own_ros() as directory:
        rospy.init_node("robocop_bench", disable_signals=True)
        for repeat in range(args.repeats):
            for measured in results:
                if measured.error is None:
                    print(f"robocop bench: {measured.case.name}, {repeat + 1} of {args.repeats}", file=sys.stderr)
                    _measure(measured, args.seconds, simulator, directory)
        rospy.signal_shutdown("done")
    return results


def _on_terminate(_number: int, _frame: Any) -> None:
    raise KeyboardInterrupt


def main() -> None:
    """Entry point; a signal ends all that was started."""
    signal.signal(signal.SIGTERM, _on_terminate)
    args = _arguments(sys.argv[1:])
    try:
        wanted = cases.parse_cases(args.cases)
        where = report.conditions(args.seconds, args.repeats)
        results = _measure_all(wanted, args)
    except BenchError as error:
        print(f"robocop bench: {error}", file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        print("robocop bench: interrupted; all that was started is ended", file=sys.stderr)
        sys.exit(130)
    print(report.as_json(results, where) if args.json else report.table(results, where))
    sys.exit(1 if any(measured.error for measured in results) else 0)
