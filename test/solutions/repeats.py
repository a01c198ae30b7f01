"""Measures how reliably each solution gets the expected grade by grading it repeatedly.

    ./robocop shell python3 test/solutions/repeats.py --times 20 --jobs 3 --log FILE [NAME...]

Wrong solutions run through the scenarios of the intended check, correct ones through all of them; `reference` is this
package, built each time. The log holds a JSON object per grading; with an existing log the measurement is continued.
"""

import argparse
import json
import multiprocessing
import sys
import tempfile
import time
from pathlib import Path
from typing import Any, Dict, List, Tuple

from graded import PLAN, RIGHT, SHARE, STATE, graded, recorded, sandbox
from wrong_solutions import WRONG, Wrong

from aro_robocop_goto_as.grading import judge
from aro_robocop_goto_as.grading.grade_submission import grade_submission
from aro_robocop_goto_as.grading.judge import Outcome
from aro_robocop_goto_as.grading.plan import load
from aro_robocop_goto_as.grading.submission import prepare_submission

BY_NAME = {wrong.name: wrong for wrong in WRONG}
REFERENCE = "reference"

Entry = Dict[str, Any]


def once(job: Tuple[str, int]) -> Entry:
    """Grade a solution once."""
    name, number = job
    started = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        words = _wrong(BY_NAME[name], Path(folder)) if name in BY_NAME else _right(name, Path(folder))
    return {
        "name": name,
        "number": number,
        "seconds": round(time.monotonic() - started, 1),
        "right": not words,
        "words": words,
    }


def _wrong(wrong: Wrong, folder: Path) -> List[str]:
    """The explanation of the intended check, if it is not the expected one."""
    plan = load(PLAN)
    check = next(check for check in plan.checks if check.name == wrong.check)
    only = [name for name in check.scenarios if name != "start"] or ["no other"]
    run = recorded(wrong.text(), folder, only)
    grade = judge.judge(wrong.name, plan, {check.part: run.records}, {check.part: run.problem})
    result = next(result for result in grade.checks if result.name == wrong.check)
    expected = result.outcome is Outcome.FAILED and wrong.words in result.explanation()
    return [] if expected else [result.explanation()]


def _right(name: str, folder: Path) -> List[str]:
    """The explanations of all checks that did not pass, including extra ones."""
    if name == REFERENCE:
        opened = sandbox()
        submission = prepare_submission(str(SHARE), SHARE, STATE, folder, opened)
        grade = grade_submission(submission, load(PLAN), folder / "report", STATE, opened)
    else:
        grade = graded(name, RIGHT[name].read_text(), folder)
    return [check.explanation() for check in grade.checks if check.outcome is not Outcome.PASSED]


def table(entries: List[Entry]) -> str:
    """The results as a table, a row for each solution."""
    by_name: Dict[str, List[Entry]] = {}
    for entry in sorted(entries, key=lambda entry: str(entry["name"])):
        by_name.setdefault(entry["name"], []).append(entry)
    rows = ["| solution | check | as expected | seconds |", "| --- | --- | --- | --- |"]
    for name, gradings in by_name.items():
        check = BY_NAME[name].check if name in BY_NAME else "all pass"
        seconds = sorted(entry["seconds"] for entry in gradings)
        rows.append(
            f"| {name} | {check} | {sum(entry['right'] for entry in gradings)} of {len(gradings)} | "
            f"{seconds[0]:g} to {seconds[-1]:g} |"
        )
    good = sum(entry["right"] for entry in entries)
    return "\n".join([*rows, "", f"{good} of {len(entries)} as expected"])


def repeat() -> None:
    """Run the gradings that the log does not have, then print the table; exit status 1 if one was not as expected."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help="solutions (default: all wrong ones)")
    parser.add_argument("--times", type=int, default=20)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--log", type=Path, required=True)
    args = parser.parse_args()
    names = args.names or list(BY_NAME)
    done = [json.loads(line) for line in args.log.read_text().splitlines()] if args.log.exists() else []
    known = {(entry["name"], entry["number"]) for entry in done}
    jobs = [(name, number) for number in range(args.times) for name in names if (name, number) not in known]
    context = multiprocessing.get_context("spawn")  # a fresh process for each grading
    with open(args.log, "a") as log, context.Pool(args.jobs, maxtasksperchild=1) as pool:
        for entry in pool.imap_unordered(once, jobs):
            print(json.dumps(entry), file=log, flush=True)
            done.append(entry)
            if not entry["right"]:
                print(f"NOT as expected: {entry}", file=sys.stderr, flush=True)
    mine = [entry for entry in done if entry["name"] in names]
    print(table(mine))
    sys.exit(0 if all(entry["right"] for entry in mine) else 1)


if __name__ == "__main__":
    repeat()
