"""How often each solution gets the grade it should: every one judged again and again, several at a time.

    ./robocop shell python3 test/solutions/repeats.py --times 20 --jobs 3 --log FILE [NAME...]

Wrong solutions are driven through the scenarios of the check that is meant for them, right ones through all;
`reference` is this package, built each time. What was done is in the log, a JSON object per line; started again with
the same log, it goes on from there.
"""

import argparse
import json
import multiprocessing
import sys
import tempfile
import time
from pathlib import Path
from typing import Any, Dict, List, Tuple

from graded import PLAN, RIGHT, SHARE, STATE, graded, recorded, the_cage
from wrong_solutions import WRONG, Wrong

from aro_robocop_goto_as.grading import judge
from aro_robocop_goto_as.grading.exam import examine
from aro_robocop_goto_as.grading.judge import Outcome
from aro_robocop_goto_as.grading.plan import load
from aro_robocop_goto_as.grading.submission import take

BY_NAME = {wrong.name: wrong for wrong in WRONG}
REFERENCE = "reference"  # this very package
FRESH_START = "spawn"  # a process of its own for each, as for a student

Entry = Dict[str, Any]


def once(job: Tuple[str, int]) -> Entry:
    """Judge a solution once."""
    name, number = job
    started = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        words = _wrong(BY_NAME[name], Path(folder)) if name in BY_NAME else _right(name, Path(folder))
    return {"name": name, "number": number, "seconds": round(time.monotonic() - started, 1), "right": not words,
            "words": words}


def _wrong(wrong: Wrong, folder: Path) -> List[str]:
    """What the check meant for it says, if that is not what it should say."""
    plan = load(PLAN)
    check = next(check for check in plan.checks if check.name == wrong.check)
    only = [name for name in check.scenarios if name != "start"] or ["no other"]
    it = recorded(wrong.text(), folder, only)
    grade = judge.judge(wrong.name, plan, {check.part: it.records}, {check.part: it.problem})
    line = next(line for line in grade.lines if line.name == wrong.check)
    return [] if line.outcome is Outcome.FAILED and wrong.words in line.words() else [line.words()]


def _right(name: str, folder: Path) -> List[str]:
    """Whatever is not passed, extra checks too."""
    if name == REFERENCE:
        around = the_cage()
        grade = examine(take(str(SHARE), SHARE, STATE, folder, around), PLAN, folder / "report", STATE, around)
    else:
        grade = graded(name, RIGHT[name].read_text(), folder)
    return [line.words() for line in grade.lines if line.outcome is not Outcome.PASSED]


def table(entries: List[Entry]) -> str:
    """What came of it, a row for each solution."""
    by_name: Dict[str, List[Entry]] = {}
    for entry in sorted(entries, key=lambda it: str(it["name"])):
        by_name.setdefault(entry["name"], []).append(entry)
    rows = ["| solution | check | as it should be | seconds |", "| --- | --- | --- | --- |"]
    for name, of_it in by_name.items():
        check = BY_NAME[name].check if name in BY_NAME else "all pass"
        seconds = sorted(entry["seconds"] for entry in of_it)
        rows.append(f"| {name} | {check} | {sum(it['right'] for it in of_it)} of {len(of_it)} | "
                    f"{seconds[0]:g} to {seconds[-1]:g} |")
    good = sum(entry["right"] for entry in entries)
    return "\n".join([*rows, "", f"{good} of {len(entries)} as they should be"])


def repeat() -> None:
    """Run what the log lacks, then print the table; exit status 1 when one grade was not as it should be."""
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
    context = multiprocessing.get_context(FRESH_START)
    with open(args.log, "a") as log, context.Pool(args.jobs, maxtasksperchild=1) as pool:
        for entry in pool.imap_unordered(once, jobs):
            print(json.dumps(entry), file=log, flush=True)
            done.append(entry)
            if not entry["right"]:
                print(f"NOT as it should be: {entry}", file=sys.stderr, flush=True)
    mine = [entry for entry in done if entry["name"] in names]
    print(table(mine))
    sys.exit(0 if all(entry["right"] for entry in mine) else 1)


if __name__ == "__main__":
    repeat()
