"""The command: measures every case, repeat by repeat, and prints the report."""

import argparse
import itertools
import signal
import sys
from pathlib import Path
from typing import List, Sequence

from ..errors import BenchError, RobocopError
from . import cases, report
from .baseline import measure_baseline
from .checkout import Checkout, other_checkout, this_checkout
from .measure import simulate
from .processes import own_ros
from .report import Measured, Row
from .worlds import world_of

USUAL, QUICK = (5.0, 3), (1.5, 1)  # [s] a measurement, repeats
FACTORS = (0.0, 1.0)  # real-time factors: as fast as possible, paced


def _arguments(argv: List[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="robocop bench",
        description="Measure the speed of the simulator, its cost, and its baseline: the same simulator without ROS.",
        epilog="Exit status 1 when a case failed, 2 when nothing was measured. A run takes about "
        "(3 SECONDS + 6) x REPEATS for each case; make sure that the machine is idle.",
    )
    parser.add_argument("--json", action="store_true", help="as JSON, with every single run")
    quick = "{:g} s a measurement, {} repeat, unless given".format(*QUICK)
    parser.add_argument("--quick", action="store_true", help=quick)
    parser.add_argument("--seconds", type=float, help=f"wall time of each measurement (default {USUAL[0]:g})")
    parser.add_argument("--repeats", type=int, help=f"the table shows medians (default {USUAL[1]})")
    parser.add_argument(
        "--cases",
        nargs="+",
        default=[],
        metavar="DRIVE[:ROBOTS]",
        help="such as wheels:1 kinematic, in lockstep wheels:rospy, with moving obstacles kinematic:moving, in a large "
        "map kinematic:map; default: " + " ".join(case.name for case in cases.default_cases()),
    )
    against = "alternate between the simulator of another checkout and this one, and print the ratios of their figures"
    parser.add_argument("--against", type=Path, metavar="CHECKOUT", help=against)
    args = parser.parse_args(argv)
    args.seconds, args.repeats = (
        default if given is None else given
        for given, default in zip((args.seconds, args.repeats), QUICK if args.quick else USUAL)
    )
    if not (0.1 <= args.seconds <= 3600.0 and args.repeats >= 1):
        parser.error(f"expected 0.1 to 3600 s and 1 repeat or more, got {args.seconds:g} s and {args.repeats}")
    return args


def _measure(results: Sequence[Row], checkouts: Sequence[Checkout], seconds: float, repeats: int) -> None:
    """Measure every case in each checkout, alternating, so that other load affects all of them alike.

    A case that fails is not repeated. A single checkout is compared with its baseline.
    """
    with own_ros() as directory:
        for repeat, row in itertools.product(range(repeats), results):
            for measured, checkout in list(zip(row, checkouts))[:: -1 if repeat % 2 else 1]:
                case = measured.case
                if any(one.error for one in row):
                    continue
                print(f"robocop bench: {case.name}, {repeat + 1} of {repeats}", measured.checkout, file=sys.stderr)
                try:
                    world = world_of(case, directory)
                    baseline = measure_baseline(case, world, seconds) if len(row) == 1 else {}
                    fastest, paced = (simulate(case, world, at, seconds, checkout, directory) for at in FACTORS)
                    measured.add(fastest, paced, baseline)
                except RobocopError as error:
                    measured.error = str(error)
                    print(f"robocop bench: {measured.notes()[0]}", file=sys.stderr)


def main() -> None:
    """Entry point; a signal ends everything that was started, and what was measured until then is printed."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.default_int_handler)
    args = _arguments(sys.argv[1:])
    results: List[Row] = []
    try:
        wanted = cases.parse_cases(args.cases)
        where = report.conditions(args.seconds, args.repeats)
        checkouts = [this_checkout()]
        if args.against is not None:
            checkouts.insert(0, other_checkout(args.against))
            wanted += [] if args.cases else cases.lockstep_cases()
        results = [[Measured(case, one.name if len(checkouts) > 1 else "") for one in checkouts] for case in wanted]
        _measure(results, checkouts, args.seconds, args.repeats)
        status = 1 if any(measured.error for row in results for measured in row) else 0
    except BenchError as error:
        print(f"robocop bench: {error}", file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        print("robocop bench: interrupted; all processes are ended", file=sys.stderr)
        status = 130
        results = [row for row in results if any(measured.figures or measured.error for measured in row)]
        if not results:
            sys.exit(status)
        where.append("Interrupted: some cases are missing or have fewer repeats.")
    print((report.as_json if args.json else report.table)(results, where))
    sys.exit(status)
