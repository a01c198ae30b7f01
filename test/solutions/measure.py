"""Measurements of the grader that take hours; no tests.

    ./robocop shell python3 test/solutions/measure.py repeats --log FILE [--times 20] [NAME...]

grades solutions (default: all wrong ones) repeatedly by all checks, and lists each one whose grade is not the expected
one, or whose reports differ in an outcome, a cause or the points. --at-once 8 and --load 60 (processes that keep a
processor busy) are conditions; a log that has gradings in others as well compares them. --drawn draws each repetition's
scenarios, with seeds from 1 on.

    ./robocop shell python3 test/solutions/measure.py mutants --log FILE [--sample 80] [NAME...]

grades correct solutions with one change: an operator, a comparison, a number, a text, a negated condition, a statement
that is removed. It lists those that keep full marks: they are allowed, or show a gap of the checks.

The log holds a JSON object per grading; with an existing log a measurement is continued.
"""

import argparse
import ast
import contextlib
import json
import multiprocessing
import random
import sys
import tempfile
import time
import zlib
from collections import defaultdict
from pathlib import Path
from typing import NamedTuple

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # test/, as pytest has it

from graded import graded
from processes import busy_processes
from right_solutions import RIGHT
from wrong_solutions import WRONG

from aro_robocop_goto_as.errors import RobocopError
from robocop_grading.checks.verdict import without_figures
from robocop_grading.grades import CheckOutcome

BY_NAME = {wrong.name: wrong for wrong in WRONG}
BASES = ("base_server", "base_bridge", "functions_bang_bang")
OTHERS = {
    **{ast.Lt: (ast.LtE, ast.Gt), ast.LtE: (ast.Lt, ast.Gt), ast.Gt: (ast.GtE, ast.Lt), ast.GtE: (ast.Gt, ast.Lt)},
    **{ast.Eq: (ast.NotEq,), ast.NotEq: (ast.Eq,), ast.Is: (ast.IsNot,), ast.IsNot: (ast.Is,)},
    **{ast.Add: (ast.Sub,), ast.Sub: (ast.Add,), ast.Mult: (ast.Div,), ast.Div: (ast.Mult,)},
    **{ast.And: (ast.Or,), ast.Or: (ast.And,), ast.USub: (ast.UAdd,)},
}
FUNCTIONS = {"min": "max", "max": "min", "sin": "cos", "cos": "sin"}
REMOVABLE = (ast.Expr, ast.Assign, ast.AugAssign, ast.Return, ast.Break, ast.Continue)


# -- mutants --


def _others(node, field, value):
    """What may stand in place of the value of a node's field, or of an entry of a list there."""
    if type(value) in OTHERS:
        return [other() for other in OTHERS[type(value)]]
    if isinstance(value, REMOVABLE):
        return [ast.Pass()]
    if field == "test" or field == "operand" and isinstance(node.op, ast.Not):
        return [ast.UnaryOp(ast.Not(), value)]
    if field in ("attr", "id"):
        return [FUNCTIONS[value]] if value in FUNCTIONS else []
    if not isinstance(node, ast.Constant) or field != "value" or value == "__main__":
        return []
    if isinstance(value, (bool, int, str)):
        return [not value if isinstance(value, bool) else value + "x" if isinstance(value, str) else value + 1]
    return ([2.0 * value, 0.5 * value] if value else [1.0]) if isinstance(value, float) else []


def mutants(base):
    """The programs that differ in one place from a solution."""
    tree, found = ast.parse(RIGHT[base]), set()
    original, places = ast.unparse(tree), [(node, *it) for node in ast.walk(tree) for it in ast.iter_fields(node)]
    for node, field, value in places:
        entries = value if isinstance(value, list) else [value]
        for number, other in [(n, other) for n, it in enumerate(entries) for other in _others(node, field, it)]:
            changed = [*entries[:number], other, *entries[number + 1 :]]
            setattr(node, field, changed if isinstance(value, list) else other)
            with contextlib.suppress(SyntaxError, ValueError):
                text = ast.unparse(ast.fix_missing_locations(tree))
                compile(text, base, "exec")
                found.add(text)
            setattr(node, field, value)
    return sorted(found - {original})


def difference(base, text):
    """The first line in which a mutant differs."""
    both = zip(ast.unparse(ast.parse(RIGHT[base])).splitlines(), text.splitlines())
    return next((f"{it.strip()}  ->  {other.strip()}" for it, other in both if it != other), "a line at the end")


# -- gradings --


class Job(NamedTuple):
    """A program to grade; `number` is the one of its repetition."""

    name: str
    condition: str
    text: str
    number: int
    seed: int = 0


def once(job):
    """Grade a program by all checks: an entry of the log."""
    started, entry = time.monotonic(), {"name": job.name, "condition": job.condition, "number": job.number}
    with tempfile.TemporaryDirectory() as folder:
        try:
            grade = graded(job.name, job.text, Path(folder), job.seed)
            failed = [it.name for it in grade.checks if it.outcome is not CheckOutcome.PASSED]
            report = {it.name: [it.outcome.value, it.words] for it in grade.checks}
            entry.update(points=grade.points, failed=failed, report=report)
        except RobocopError as error:
            entry.update(points=None, failed=[f"no grade: {error}"], report={})
    return {**entry, "seconds": round(time.monotonic() - started, 1)}


def run(jobs, log, at_once, load=0):
    """The log with the gradings that it did not have."""
    entries = [json.loads(line) for line in log.read_text().splitlines()] if log.exists() else []
    known = {(it["name"], it["condition"], it["number"]) for it in entries}
    left = [job for job in jobs if (job.name, job.condition, job.number) not in known]
    context = multiprocessing.get_context("spawn")  # a fresh process for each grading
    busy = busy_processes(load) if load else contextlib.nullcontext()
    with busy, open(log, "a") as file, context.Pool(at_once, maxtasksperchild=1) as pool:
        for entry in pool.imap_unordered(once, left):
            print(json.dumps(entry), file=file, flush=True)
            entries.append(entry)
            print(f"{entry['name']}: {entry['points']} points, {entry['seconds']} s", file=sys.stderr, flush=True)
    return entries


def repeats(args):
    """Print what is not as expected, and what differs; the number of these lines."""
    condition = f"{args.at_once} at once, {args.load} busy loops"
    text = {name: BY_NAME[name].text() if name in BY_NAME else RIGHT[name] for name in args.names or BY_NAME}
    jobs = [Job(it, condition, text[it], n, n + 1 if args.drawn else 0) for n in range(args.times) for it in text]
    entries = [it for it in run(jobs, args.log, args.at_once, args.load) if it["name"] in text]
    found, seen = [], defaultdict(set)
    for entry in entries:
        wrong, name = BY_NAME.get(entry["name"]), entry["name"]
        outcome, words = entry["report"].get(wrong.check, ["", ""]) if wrong else ("", "")
        expected = outcome == "failed" and wrong.words in words if wrong else not entry["failed"]
        found += [] if expected else [f"not as expected: {name}, {entry['condition']}: {words or entry['failed']}"]
        for check, told in {**entry["report"], "points": entry["points"]}.items():
            seen[f"{name}: {check}"].add(without_figures(str(told)) if check != "points" else str(told))
    found += [f"differs: {place}: {sorted(told)}" for place, told in sorted(seen.items()) if len(told) > 1]
    print("\n".join([*found, f"{len(entries)} gradings in {sorted({it['condition'] for it in entries})}"]))
    return len(found)


def mutate(args):
    """Print the mutants that keep full marks; 0."""
    jobs = []
    for base in args.names or BASES:
        of_base = mutants(base)
        chosen = random.Random(base).sample(of_base, min(args.sample, len(of_base)))
        jobs += [Job(base, "mutant", text, zlib.crc32(text.encode())) for text in chosen]
    random.Random(0).shuffle(jobs)  # an interrupted measurement has mutants of all solutions
    text = {(job.name, job.number): job.text for job in jobs}
    entries = [it for it in run(jobs, args.log, args.at_once) if (it["name"], it["number"]) in text]
    kept = [it for it in entries if not it["failed"]]
    print("\n".join(f"{it['name']}: {difference(it['name'], text[it['name'], it['number']])}" for it in kept))
    print(f"{len(entries)} mutants, {len(entries) - len(kept)} of them lost points")
    return 0


def main():
    """Exit status 1 if a repeated grade is not as expected or differs."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    kinds = parser.add_subparsers(required=True)
    repeated, mutated = (kinds.add_parser(name) for name in ("repeats", "mutants"))
    for part, measure in ((repeated, repeats), (mutated, mutate)):
        part.add_argument("names", nargs="*", metavar="NAME")
        part.add_argument("--log", type=Path, required=True)
        part.add_argument("--at-once", type=int, default=2)
        part.set_defaults(measure=measure)
    repeated.add_argument("--times", type=int, default=20)
    repeated.add_argument("--load", type=int, default=0)
    repeated.add_argument("--drawn", action="store_true")
    mutated.add_argument("--sample", type=int, default=10**6)
    args = parser.parse_args()
    sys.exit(1 if args.measure(args) else 0)


if __name__ == "__main__":
    main()
