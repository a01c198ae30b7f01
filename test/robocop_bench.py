#!/usr/bin/env python3
"""`./robocop bench`: measures every case, repeat by repeat, and prints the report."""

import argparse
import itertools
import os
import signal
import sys
import tempfile
from pathlib import Path

from bench import BenchError, cases, instructions, report
from bench.measure import measure, other_checkout
from bench.report import Measured
from systems import System

USUAL, QUICK = (5.0, 3), (1.5, 1)  # [s] a measurement, repeats


def _arguments():
    parser = argparse.ArgumentParser(
        prog="robocop bench",
        description="Measure the speed of the simulator and its cost.",
        epilog="Exit status 1 when a case failed, 2 when nothing was measured. A run takes about "
        "(2 SECONDS + 6) x REPEATS for each case; make sure that the machine is idle.",
    )
    parser.add_argument("--json", action="store_true", help="as JSON, with every single run")
    quick = "{:g} s a measurement, {} repeat, unless given".format(*QUICK)
    parser.add_argument("--quick", action="store_true", help=quick)
    parser.add_argument("--seconds", type=float, help=f"wall time of each measurement (default {USUAL[0]:g})")
    parser.add_argument("--repeats", type=int, help=f"the table shows medians (default {USUAL[1]})")
    known = "such as wheels:1 kinematic, in lockstep wheels:rospy; default: " + " ".join(cases.DEFAULT)
    parser.add_argument("--cases", nargs="+", default=[], metavar="DRIVE[:ROBOTS]", help=known)
    against = "alternate between the simulator of another checkout and this one, and print the ratios of their figures"
    parser.add_argument("--against", type=Path, metavar="CHECKOUT", help=against)
    counting = "count the instructions of a simulated second by valgrind, without ROS; other load does not change them"
    parser.add_argument("--instructions", action="store_true", help=counting)
    args = parser.parse_args()
    seconds, repeats = QUICK if args.quick else USUAL
    args.seconds = seconds if args.seconds is None else args.seconds
    args.repeats = repeats if args.repeats is None else args.repeats
    if not (0.1 <= args.seconds <= 3600.0 and args.repeats >= 1):
        parser.error(f"expected 0.1 to 3600 s and 1 repeat or more, got {args.seconds:g} s and {args.repeats}")
    return args


def _instructions(wanted, against):
    """The table of instructions of the cases without a controller, in this checkout and another one."""
    others = {"other": (against.absolute(), other_checkout(against))} if against else {}
    counted = [case for case in wanted if not case.lockstep]
    return instructions.table(counted, {**others, "this": (Path(__file__).parents[1], os.environ)})


def _measure(rows, checkouts, seconds, repeats):
    """Measure every case in each checkout, alternating, so that other load affects all of them alike.

    A case that fails is not repeated.
    """
    with tempfile.TemporaryDirectory(prefix="robocop_bench_") as directory, System(Path(directory)) as ros:
        ros.start_master()
        for repeat, row in itertools.product(range(repeats), rows):
            for measured, checkout in list(zip(row, checkouts))[:: -1 if repeat % 2 else 1]:
                if any(one.error for one in row):
                    continue
                name = measured.case.name
                print(f"robocop bench: {name}, {repeat + 1} of {repeats}", measured.checkout, file=sys.stderr)
                try:
                    for figure, value in measure(measured.case, seconds, checkout, ros).items():
                        measured.figures.setdefault(figure, []).append(value)
                except BenchError as error:
                    measured.error = str(error)
                    print(f"robocop bench: {measured.notes()[0]}", file=sys.stderr)


def main():
    """Print the report; a signal ends everything that was started, and what was measured until then is printed."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.default_int_handler)
    for name in ("ROS_IP", "ROS_NAMESPACE"):
        os.environ.pop(name, None)
    args, status = _arguments(), 0
    rows = []
    try:
        wanted = cases.parse_cases(args.cases or [*cases.DEFAULT, *(cases.LOCKSTEP if args.against else ())])
        if args.instructions:
            print(_instructions(wanted, args.against))
            return 0
        where = report.conditions(args.seconds, args.repeats)
        checkouts = [*([other_checkout(args.against)] if args.against else []), os.environ]
        names = ["other", "this"] if args.against else [""]
        rows = [[Measured(case, name) for name in names] for case in wanted]
        _measure(rows, checkouts, args.seconds, args.repeats)
    except BenchError as error:
        print(f"robocop bench: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("robocop bench: interrupted; all processes are ended", file=sys.stderr)
        status = 130
        rows = [row for row in rows if any(measured.figures or measured.error for measured in row)]
        if not rows:
            return status
        where.append("Interrupted: some cases are missing or have fewer repeats.")
    print((report.as_json if args.json else report.table)(rows, where))
    return status or int(any(measured.error for row in rows for measured in row))


if __name__ == "__main__":
    sys.exit(main())
