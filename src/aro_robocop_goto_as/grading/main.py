"""robocop grade: a submission -> a line per check, points, a report; exit status 0 when all is right."""

import argparse
import os
import sys
import zlib
from pathlib import Path

from ..errors import RobocopError
from ..hosting.workspace import alone
from ..interruption import as_ctrl_c, check, the_end
from . import display
from .exam import examine
from .judge import Grade, Outcome, printable
from .plan import load
from .sandbox import CPU_TIME, WATCHED_CPU_TIME, cage
from .submission import take

INTERRUPTED = 130  # as shells have it for who is ended by Ctrl-C
SIGNS = {Outcome.PASSED: "passed", Outcome.FAILED: "FAILED", Outcome.NOT_REACHED: "not reached"}


def _progress(part: str, scenario: str) -> None:
    check()
    if sys.stderr.isatty():
        print(f"\r\033[K{part}: {scenario} ...", end="", file=sys.stderr, flush=True)


def show(result: Grade) -> str:
    """The grade for a terminal."""
    lines = []
    for line in result.lines:  # words may hold what a submission says, which must not write lines of its own
        lines.append(
            f"{SIGNS[line.outcome]:11}  {line.points:4g} / {line.of:<4g}  {line.sentence}"
            + (" (extra)" if line.extra else "")
        )
        if line.outcome is not Outcome.PASSED:
            lines.append(f"{'':11}  {line.words()}")
    lines += [f"problem: {problem}" for problem in result.problems]
    lines.append(f"{result.name}: {result.points:g} of {result.of:g} points")
    return "\n".join(printable(line) for line in lines)


def main() -> None:
    """Exit status 0: every check passed; 1: not, or there is nothing to grade; 130: interrupted."""
    parser = argparse.ArgumentParser(prog="robocop grade", description=__doc__)
    parser.add_argument("path", help="a package, a robocop_goto_as.py, or a robocop_rviz_goto_ac.py")
    parser.add_argument("--report", metavar="DIR", help="where the report goes (default: .robocop/reports/NAME)")
    parser.add_argument("--plan", metavar="YAML", help="scenarios, limits and points (default: config/grading.yaml)")
    parser.add_argument("--unsafe", action="store_true", help="run the code without bubblewrap around it")
    parser.add_argument("--watch", action="store_true", help="show the run in RViz, at real time")
    args = parser.parse_args()
    as_ctrl_c()
    state, share = Path(os.environ["ROBOCOP_STATE"]), Path(os.environ["ROBOCOP_SHARE"])
    plan_path = Path(args.plan).resolve() if args.plan else share / "config" / "grading.yaml"
    try:
        load(plan_path)  # complains now, and not after the build
        around = cage(args.unsafe, [state / "venv", state / "compat"], WATCHED_CPU_TIME if args.watch else CPU_TIME)
        if args.watch:
            display.require(around)
        with alone(state / "grade" / f"{zlib.crc32(os.fsencode(os.path.realpath(args.path))):08x}"):
            submission = take(args.path, share, state, state / "grade", around)
            folder = Path(args.report) if args.report else state / "reports" / submission.name
            result = examine(submission, plan_path, folder, state, around, _progress, args.watch)
    except RobocopError as error:
        print(f"robocop grade: {error}", file=sys.stderr)
        sys.exit(1)
    except KeyboardInterrupt:
        the_end()
        sys.exit(INTERRUPTED)
    if sys.stderr.isatty():
        print("\r\033[K", end="", file=sys.stderr, flush=True)
    print(show(result))
    print(f"report: {folder / 'report.html'}")
    sys.exit(0 if result.all_right else 1)
