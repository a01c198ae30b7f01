"""Measures how reliably each solution gets the expected grade by grading it repeatedly.

    ./robocop shell python3 test/solutions/repeats.py --times 20 --jobs 3 --log FILE [NAME...]

Wrong solutions run through the scenarios of the intended check, correct ones through all of them; `reference` is this
package, built each time. The log holds a JSON object per grading; with an existing log the measurement is continued.

    ... --whole --load 4

grades wrong solutions by all checks, too, beside four processes that keep a processor busy. Reports of one solution,
also those that the log has from other conditions, that differ in an outcome, a cause or the points are listed.

    ... --proof --jobs 1 --log FILE; ... --proof --jobs 8 --log FILE; ... --proof --jobs 1 --load 60 --log FILE

grades all in right/ and twelve wrong ones by all checks once in each condition; the last table compares them.

    ... --drawn --times 200 base_server

draws the scenarios of each repetition from the plan's ranges, with seeds from 1 on: a correct solution passes them all.
"""

import argparse
import contextlib
import json
import multiprocessing
import re
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from typing import Any, Dict, List, Tuple

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # test/, as pytest has it

from graded import HERE, PLAN, RIGHT, SHARE, STATE, graded, recorded, sandbox
from processes import busy_processes
from wrong_solutions import WRONG, Wrong

from aro_robocop_goto_as.errors import NoTimeError
from robocop_grading import judge
from robocop_grading.grader import grade as grade_submission
from robocop_grading.judge import Grade, Outcome
from robocop_grading.plan import load
from robocop_grading.runner import Runner
from robocop_grading.submission import prepare_submission

# One for each kind of mistake: feedback, motion, endings, obstacles, preemption, exceptions, pace; and of bridges.
PROOF_WRONG = (
    *("degrees", "direction_calculated_once", "moves_first", "done_never_cleared", "unpaced_loop", "slow_loop"),
    *("scan_read_once", "exits_after_goal", "exception_in_scan", "feedback_of_the_last_iteration"),
    *("bridge_never_cancels", "bridge_states_shifted"),
)
PROOF = [*(path.name[: -len(".py.in")] for path in sorted((HERE / "right").glob("*.py.in"))), *PROOF_WRONG]
BY_NAME = {wrong.name: wrong for wrong in WRONG}
REFERENCE = "reference"
NUMBER = re.compile(r"-?\d+(\.\d+)?")

Entry = Dict[str, Any]


Job = Tuple[str, str, int, bool, int]  # name, condition, number, by all checks, seed of the scenarios


def once(job: Job) -> Entry:
    """Grade a solution once."""
    name, condition, number, whole, seed = job
    started = time.monotonic()
    words, points, checks = [], None, ()  # type: List[str], Optional[float], Sequence[CheckResult]
    with tempfile.TemporaryDirectory() as folder:
        try:
            if name in BY_NAME:
                words, grade = _wrong(BY_NAME[name], Path(folder), whole, seed)
            else:
                words, grade = _right(name, Path(folder), seed)
            points, checks = grade.points, grade.checks
        except NoTimeError as error:
            words = [f"no grade: {error}"]
    return {
        "name": name,
        "condition": condition,
        "number": number,
        "seed": seed,
        "seconds": round(time.monotonic() - started, 1),
        "right": not words,
        "words": words,
        "points": points,
        "report": {check.name: [check.outcome.value, check.failure and check.failure.cause] for check in checks},
    }


def _wrong(wrong: Wrong, folder: Path, whole: bool, seed: int) -> Tuple[List[str], Grade]:
    """The explanation of the intended check, if it is not the expected one; the grade."""
    plan = load(PLAN, seed).restricted([] if whole else [wrong.check])
    part = next(check.part for check in plan.checks if check.name == wrong.check)
    run = recorded(wrong.text(), folder, [] if whole else [wrong.check], seed=seed)
    grade = judge.judge(wrong.name, plan, {part: run.records}, {part: run.problem})
    result = next(result for result in grade.checks if result.name == wrong.check)
    expected = result.outcome is Outcome.FAILED and wrong.words in result.words
    return ([] if expected else [result.words]), grade


def _right(name: str, folder: Path, seed: int) -> Tuple[List[str], Grade]:
    """The explanations of all checks that did not pass, including extra ones; the grade."""
    if name == REFERENCE:
        opened = sandbox()
        submission = prepare_submission(str(SHARE), SHARE, STATE, folder, opened)
        grade = grade_submission(Runner(load(PLAN, seed), STATE, opened), submission, folder / "report")
    else:
        grade = graded(name, RIGHT[name].read_text(), folder, seed)
    return [check.words for check in grade.checks if check.outcome is not Outcome.PASSED], grade


def differences(entries: List[Entry]) -> List[str]:
    """The checks of each solution that have several outcomes or causes, with all of them and how often each occurred.

    Figures in a cause may differ.
    """
    seen: Dict[Tuple[str, str], Counter[str]] = {}
    for entry in entries:
        seen.setdefault((entry["name"], "points"), Counter())[str(entry["points"])] += 1
        for check, (outcome, cause) in entry["report"].items():
            seen.setdefault((entry["name"], check), Counter())[NUMBER.sub("#", f"{outcome}: {cause}")] += 1
    return [f"{name}: {check}: {dict(found)}" for (name, check), found in sorted(seen.items()) if len(found) > 1]


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


def comparison(entries: List[Entry]) -> str:
    """The points and seconds of each solution in each condition, as a table."""
    conditions = list(dict.fromkeys(entry["condition"] for entry in entries))
    found = {(entry["name"], entry["condition"]): entry for entry in entries}
    rows = [f"| solution | {' | '.join(conditions)} |", f"| --- |{' --- |' * len(conditions)}"]
    for name in dict.fromkeys(entry["name"] for entry in entries):
        cells = []
        for condition in conditions:
            entry = found.get((name, condition))
            points = "no grade" if entry is None or entry["points"] is None else f"{entry['points']:g} points"
            cells.append("" if entry is None else f"{points}, {entry['seconds']:.0f} s")
        rows.append(f"| {name} | {' | '.join(cells)} |")
    return "\n".join(rows)


def repeat() -> None:
    """Run the gradings that the log does not have, then print the table; exit status 1 if one was not as expected."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help="solutions (default: all wrong ones)")
    parser.add_argument("--times", type=int, default=20)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--log", type=Path, required=True)
    parser.add_argument("--whole", action="store_true", help="grade wrong solutions by all checks")
    parser.add_argument("--drawn", action="store_true", help="draw the scenarios with another seed each time")
    parser.add_argument("--proof", action="store_true", help="grade all right and twelve wrong ones once by all checks")
    parser.add_argument("--load", type=int, default=0, help="processes that keep a processor busy meanwhile")
    args = parser.parse_args()
    names = args.names or (PROOF if args.proof else list(BY_NAME))
    if args.proof:
        args.whole, args.times = True, 1
    condition = f"{'alone' if args.jobs == 1 else f'{args.jobs} at once'}, {args.load} busy loops"
    done = [json.loads(line) for line in args.log.read_text().splitlines()] if args.log.exists() else []
    known = {(entry["name"], entry["condition"], entry["number"]) for entry in done}
    jobs = [
        (name, condition, number, args.whole, number + 1 if args.drawn else 0)
        for number in range(args.times)
        for name in names
        if (name, condition, number) not in known
    ]
    context = multiprocessing.get_context("spawn")  # a fresh process for each grading
    busy = busy_processes(args.load) if args.load else contextlib.nullcontext()
    with busy, open(args.log, "a") as log, context.Pool(args.jobs, maxtasksperchild=1) as pool:
        for entry in pool.imap_unordered(once, jobs):
            print(json.dumps(entry), file=log, flush=True)
            done.append(entry)
            if not entry["right"]:
                print(f"NOT as expected: {entry}", file=sys.stderr, flush=True)
    mine = [entry for entry in done if entry["name"] in names]
    print(comparison(mine) if args.proof else table(mine))
    different = differences(mine)
    print("\n".join(["reports that differ:", *different] if different else ["no two reports of one solution differ"]))
    sys.exit(0 if all(entry["right"] for entry in mine) and not different else 1)


if __name__ == "__main__":
    repeat()
