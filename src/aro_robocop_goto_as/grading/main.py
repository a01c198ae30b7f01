"""robocop grade: judge a submission and write a report."""

import argparse
import os
import sys
import zlib
from pathlib import Path

from ..errors import RobocopError
from ..hosting.scratch import scratch_folder
from ..hosting.workspace import exclusive
from ..process.signals import ignore_all, interrupt_on_signal, reraise_if_interrupted
from .grade_submission import grade_submission
from .judge import Grade, Outcome, printable, printable_lines
from .plan import load
from .report_folder import make_report_folder
from .sandbox import CPU_TIME, WATCHED_CPU_TIME, open_sandbox
from .scenario_draw import MIDDLE
from .submission import prepare_submission
from .viewer import choose_viewer

INTERRUPTED = 130  # the shells' exit status for Ctrl-C
SEED_HELP = "draw the scenarios' goals and obstacles from their ranges (default 0: the middle of each range)"
PAGE_ADVICE = "open {url} in a browser to watch; server and bridge each wait a minute for it"
MOST_SHOWN = 1_000  # characters of an error
LABELS = {Outcome.PASSED: "passed", Outcome.FAILED: "FAILED", Outcome.NOT_REACHED: "not reached"}


def _show_progress(part: str, scenario: str) -> None:
    reraise_if_interrupted()
    if sys.stderr.isatty():
        print(f"\r\033[K{part}: {scenario} ...", end="", file=sys.stderr, flush=True)


def as_text(grade: Grade) -> str:
    """The grade for a terminal."""
    lines = []
    for result in grade.checks:
        extra = " (extra)" if result.extra else ""
        points = f"{result.points:4g} / {result.points_available:<4g}"
        lines.append(f"{LABELS[result.outcome]:11}  {points}  {result.sentence}{extra}")
        if result.outcome is not Outcome.PASSED:
            lines.append(f"{'':11}  {result.explanation()}")
    lines += [f"problem: {problem}" for problem in grade.problems]
    lines += [f"fix first: {mistake.sentence}" for mistake in grade.mistakes[:1]]
    lines.append(f"{grade.name}: {grade.points:g} of {grade.points_available:g} points")
    return "\n".join(printable(line) for line in lines)  # explanations may quote the submission's output


def main() -> None:
    """Exit status 0: every check passed; 1: a check failed or nothing could be graded; 130: interrupted."""
    parser = argparse.ArgumentParser(prog="robocop grade", description=__doc__, allow_abbrev=False)
    parser.add_argument("path", help="a package, a server (robocop_goto_as.py) or a bridge (robocop_rviz_goto_ac.py)")
    parser.add_argument("--report", metavar="DIR", help="folder of the report (default: .robocop/reports/NAME)")
    parser.add_argument("--plan", metavar="YAML", help="scenarios, limits and points (default: config/grading.yaml)")
    parser.add_argument("--seed", type=int, default=MIDDLE, metavar="N", help=SEED_HELP)
    parser.add_argument("--unsafe", action="store_true", help="run the submission without bubblewrap's sandbox")
    parser.add_argument(
        "--watch", action="store_true", help="show the run in real time, in RViz or, without a display, in a browser"
    )
    args = parser.parse_args()
    interrupt_on_signal()
    state, share = Path(os.environ["ROBOCOP_STATE"]), Path(os.environ["ROBOCOP_SHARE"])
    try:
        plan = load(Path(args.plan).resolve() if args.plan else share / "config" / "grading.yaml", args.seed)
        given = make_report_folder(Path(args.report)) if args.report else None
        cpu_time = WATCHED_CPU_TIME if args.watch else CPU_TIME
        sandbox = open_sandbox(args.unsafe, [state / "venv", state / "compat"], cpu_time)
        viewer = choose_viewer(sandbox) if args.watch else None
        if viewer is not None and viewer.is_page:
            print(f"robocop grade: {PAGE_ADVICE.format(url=viewer.url)}", file=sys.stderr, flush=True)
        folder_in_use = state / "grade" / f"{zlib.crc32(os.fsencode(os.path.realpath(args.path))):08x}"
        with scratch_folder(), exclusive(folder_in_use):
            _show_progress("package", "build")
            submission = prepare_submission(args.path, share, state, state / "grade", sandbox)
            folder = given or make_report_folder(state / "reports" / submission.name)
            grade = grade_submission(submission, plan, folder, state, sandbox, _show_progress, viewer, keep=True)
    except RobocopError as error:
        print(f"robocop grade: {printable_lines(str(error))}", file=sys.stderr)
        sys.exit(1)
    except KeyboardInterrupt:
        ignore_all()
        sys.exit(INTERRUPTED)
    except Exception as error:  # the grader failed on this submission: report it in one line
        print(f"robocop grade: could not be graded: {printable_lines(repr(error))[:MOST_SHOWN]}", file=sys.stderr)
        sys.exit(1)
    if sys.stderr.isatty():
        print("\r\033[K", end="", file=sys.stderr, flush=True)
    print(as_text(grade))
    print(f"scenarios: seed {plan.seed}")
    print(f"report: {folder / 'report.html'}")
    sys.exit(0 if grade.all_right else 1)
