"""robocop grade: judge a submission and write a report."""

import argparse
import contextlib
import os
import sys
import traceback
from dataclasses import replace
from pathlib import Path
from typing import Callable, List, Sequence

from aro_robocop_goto_as.errors import InstallationError, ParameterError, RobocopError
from aro_robocop_goto_as.own_path import expect_own
from aro_robocop_goto_as.process.signals import ignore_all, interrupt_on_signal, reraise_if_interrupted
from aro_robocop_goto_as.process.start import typed
from robocop_hosting.scratch import scratch_folder
from robocop_hosting.tree import temporary_folder
from robocop_hosting.workspace import places

from . import faults
from .errors import GradingError, GradingSetupError, PlanError, UngradableError
from .files.exports import EXPECTED
from .files.packing import pack
from .grader import grade as grade_submission
from .grades import CheckOutcome, Grade
from .plan import Plan
from .plan_file import load
from .preparation import prepare
from .report.write import make_report_folder
from .runner import Runner
from .sandbox.bubblewrap import open_sandbox
from .scenarios import MIDDLE
from .texts import printable, printable_lines

# Exit statuses; 2 is argparse's, 130 is the shells'.
NOT_EVERYTHING, WRONG_USE, NO_GRADE, NOT_GRADED, INTERRUPTED = 1, 2, 3, 4, 130
SEED_HELP = "draw the scenarios' goals and obstacles from their ranges (default 0: the middle of each range)"
ALL_PLOTS = "draw plots and keep bags of all scenarios (default: of those in which a check failed)"
WRONG_USES = (GradingSetupError, InstallationError, ParameterError, PlanError)
MAX_ERROR = 1_000  # characters of an error
REPORT_STAMP = ".robocop_report"  # in a folder of a report


def progress(plan: Plan, parts: Sequence[str]) -> Callable[[str, str], None]:
    """What shows that a scenario of a part has begun, and its number among the scenarios of these parts."""
    order = [(part, name) for part in parts if plan.examines(part) for name in plan.scenarios_of(part)]

    def begin(part: str, scenario: str) -> None:
        reraise_if_interrupted()
        number = order.index((part, scenario)) + 1
        print(f"{number}/{len(order)} {part}: {scenario}", file=sys.stderr, flush=True)

    return begin


def in_short(grade: Grade) -> List[str]:
    """The lines for the terminal: mistakes, the one to fix first before the others; problems; the points."""
    lines = []
    for mistake in grade.mistakes:
        lines.append(f"{mistake.check.name} costs {mistake.cost}: {mistake.sentence}")
        lines.append(f"    {mistake.check.observed}")
    lines += [words for words, checks in grade.others.items() if checks[0].outcome is not CheckOutcome.PASSED]
    lines += [f"problem: {problem}" for problem in grade.problems]
    lines += [f"notes, which cost no points: {len(grade.notes)}, in the report"] if grade.notes else []
    lines.append(f"{grade.name}: {grade.words}")
    return [printable(line) for line in lines]  # causes may quote the submission's output


def report_folder(reports: Path, path: str) -> Path:
    """The folder with the path of the submission as it was given: names of files alone are often the same."""
    parts = [part for part in Path(os.path.normpath(path)).parts if part not in (os.sep, "//", os.pardir)]
    return reports.joinpath(*(parts or [Path(os.path.realpath(path)).name]))


def arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(prog=typed("grade"), description=__doc__, allow_abbrev=False)
    parser.add_argument("path", help="a package, a server or bridge (a .py file), or an archive of them")
    parser.add_argument("--report", metavar="DIR", help="folder of the report (default: .robocop/reports/PATH)")
    parser.add_argument("--plan", metavar="YAML", help="limits, points and packages (default: config/grading.yaml)")
    parser.add_argument("--seed", type=int, default=MIDDLE, metavar="N", help=SEED_HELP)
    parser.add_argument("--unsafe", action="store_true", help="run the submission without bubblewrap's sandbox")
    parser.add_argument("--all-plots", action="store_true", help=ALL_PLOTS)
    parser.add_argument("--only", nargs="+", default=(), metavar="CHECK", help="run only what these checks need")
    return parser.parse_args()


def _plan(args: argparse.Namespace, share: Path) -> Plan:
    file = Path(args.plan).resolve() if args.plan else share / "config" / "grading.yaml"
    return load(file, args.seed).restricted([name for word in args.only for name in word.split(",") if name])


def _kept_traceback(args: argparse.Namespace) -> Path:
    """The path of a file in the report's folder, to which the traceback of the present exception is written."""
    folder = Path(args.report or report_folder(places()[0] / "reports", args.path))
    return faults.keep([traceback.format_exc()], make_report_folder(folder, REPORT_STAMP))


def main() -> None:
    """Exit with the status that docs/grading.md describes."""
    args = arguments()
    interrupt_on_signal()
    try:
        state, share = places()
        if args.report:
            expect_own(Path(os.path.realpath(args.report)), REPORT_STAMP, Path(os.path.realpath(args.path)))
        plan = _plan(args, share)
        given = make_report_folder(Path(args.report), REPORT_STAMP) if args.report else None
        sandbox = open_sandbox(args.unsafe, [state / "venv", state / "compat"])
        with scratch_folder(), temporary_folder("robocop-hand-in-") as work:
            handed_in = Path(os.path.realpath(args.path))
            if not handed_in.exists():
                raise GradingError(f"{args.path}: expected {EXPECTED}, but nothing is there")
            pack([handed_in], work / "hand_in.tar")
            submission = prepare(work / "hand_in.tar", share, state, sandbox)
            if handed_in.is_file():
                submission = replace(submission, beside=os.listdir(handed_in.parent))
            if not any(plan.examines(script.part) for script in submission.scripts):
                raise GradingSetupError(f"{args.path}: nothing in it that these checks examine: {' '.join(args.only)}")
            folder = given or make_report_folder(report_folder(state / "reports", args.path), REPORT_STAMP)
            on_progress = progress(plan, [script.part for script in submission.scripts])
            runner = Runner(plan, state, sandbox, on_progress)
            grade = grade_submission(runner, submission, folder, all_plots=args.all_plots)
    except UngradableError as error:
        print(f"robocop grade: no grade: {printable_lines(str(error))}", file=sys.stderr)
        sys.exit(NO_GRADE)
    except RobocopError as error:
        print(f"robocop grade: {printable_lines(str(error))}", file=sys.stderr)
        sys.exit(WRONG_USE if isinstance(error, WRONG_USES) else NOT_GRADED)
    except KeyboardInterrupt:
        ignore_all()
        sys.exit(INTERRUPTED)
    except Exception as error:  # the grader failed on this submission
        shown = printable_lines(repr(error))[:MAX_ERROR]
        print(f"robocop grade: could not be graded: {shown}", file=sys.stderr)
        with contextlib.suppress(OSError, RobocopError):  # the disk may be full
            print(f"its traceback is in {_kept_traceback(args)}", file=sys.stderr)
        sys.exit(NO_GRADE)
    print("\n".join(in_short(grade)))
    print(printable(f"report: {folder / 'report.html'}"))
    sys.exit(0 if grade.all_right else NOT_EVERYTHING)
