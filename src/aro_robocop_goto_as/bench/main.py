"""The command: measures every case, repeat by repeat, and prints the report."""

import argparse
import signal
import sys
from pathlib import Path
from typing import Any, List

import rospy

from ..errors import BenchError
from . import against, cases, report
from .measure import measure_floor, simulate
from .processes import own_ros
from .results import Measured

SECONDS, REPEATS = 5.0, 3
QUICK_SECONDS, QUICK_REPEATS = 1.5, 1
FAST, PACED = 0.0, 1.0  # real-time factors


def _arguments(argv: List[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="robocop bench",
        description="Measure the speed of the simulator, its cost, and its floor.",
        epilog="Exit status 1 when a case failed, 2 when nothing was measured. A run takes about "
        "(3 SECONDS + 6) x REPEATS for each case; make sure that the machine is idle.",
    )
    parser.add_argument("--json", action="store_true", help="as JSON, with every single run")
    parser.add_argument(
        "--quick",
        action="store_true",
        help=f"{QUICK_SECONDS:g} s a measurement, {QUICK_REPEATS} repeat, unless given",
    )
    parser.add_argument("--seconds", type=_seconds, help=f"wall time of each measurement (default {SECONDS:g})")
    parser.add_argument("--repeats", type=_repeats, help=f"the table shows medians (default {REPEATS})")
    parser.add_argument(
        "--cases",
        nargs="+",
        default=[],
        metavar="DRIVE[:ROBOTS]",
        help="such as wheels:1 kinematic, in lockstep wheels:rospy; default: "
        + " ".join(case.name for case in cases.default_cases()),
    )
    parser.add_argument(
        "--against",
        type=Path,
        metavar="CHECKOUT",
        help="alternate between the simulator of another checkout and this one, and print the ratios of their figures",
    )
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


def _measure(measured: Measured, seconds: float, programs: Path, directory: Path) -> None:
    """One repeat of a case; a failure is recorded in `measured`."""
    case = measured.case
    try:
        measured.floors.append(measure_floor(case, seconds, directory))
        measured.fastest.append(simulate(case, FAST, seconds, programs, directory))
        measured.paced.append(simulate(case, PACED, seconds, programs, directory))
    except BenchError as error:
        measured.error = str(error)
        print(f"robocop bench: {case.name}: {error}", file=sys.stderr)


def _measure_all(wanted: List[cases.Case], args: argparse.Namespace) -> List[Measured]:
    """Repeats of all cases alternate, so that other load on the machine does not affect one case alone."""
    programs = Path(sys.argv[0]).absolute().parent
    results = [Measured(case) for case in wanted]
    with own_ros() as directory:
        rospy.init_node("robocop_bench", disable_signals=True)
        for repeat in range(args.repeats):
            for measured in results:
                if measured.error is None:
                    print(f"robocop bench: {measured.case.name}, {repeat + 1} of {args.repeats}", file=sys.stderr)
                    _measure(measured, args.seconds, programs, directory)
        rospy.signal_shutdown("done")
    return results


def _interrupt(_number: int, _frame: Any) -> None:
    raise KeyboardInterrupt


def main() -> None:
    """Entry point; a signal ends everything that was started."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, _interrupt)
    args = _arguments(sys.argv[1:])
    try:
        wanted = cases.parse_cases(args.cases)
        where = report.conditions(args.seconds, args.repeats)
        if args.against is not None:
            if not args.cases:
                wanted += cases.lockstep_cases()
            sys.exit(against.run(wanted, args.against, args.seconds, args.repeats, args.json, where))
        results = _measure_all(wanted, args)
    except BenchError as error:
        print(f"robocop bench: {error}", file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        print("robocop bench: interrupted; all processes are ended", file=sys.stderr)
        sys.exit(130)
    print(report.as_json(results, where) if args.json else report.table(results, where))
    sys.exit(1 if any(measured.error for measured in results) else 0)
