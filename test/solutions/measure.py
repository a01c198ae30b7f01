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
import copy
import json
import multiprocessing
import random
import sys
import tempfile
import time
import zlib
from collections import defaultdict
from pathlib import Path
from typing import Any, Callable, Dict, Iterator, List, Set, Tuple

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # test/, as pytest has it

from graded import graded
from processes import busy_processes
from right_solutions import RIGHT
from wrong_solutions import WRONG

from aro_robocop_goto_as.errors import RobocopError
from robocop_grading.judge import Outcome, without_figures

BY_NAME = {wrong.name: wrong for wrong in WRONG}
BASES = ("base_server", "base_bridge", "functions_bang_bang")
OTHERS: Dict[type, Tuple[type, ...]] = {
    ast.Lt: (ast.LtE, ast.Gt),
    ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.Lt),
    ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,),
    ast.Add: (ast.Sub,),
    ast.Sub: (ast.Add,),
    ast.Mult: (ast.Div,),
    ast.Div: (ast.Mult,),
    ast.And: (ast.Or,),
    ast.Or: (ast.And,),
}
FUNCTIONS = {"min": "max", "max": "min", "sin": "cos", "cos": "sin"}
REMOVABLE = (ast.Expr, ast.Assign, ast.AugAssign, ast.Return, ast.Break, ast.Continue)

Entry = Dict[str, Any]


# -- mutants --


def _changes(node: Any) -> Iterator[Callable[[Any], object]]:
    """What can be changed in a copy of a node: functions that do it, or return another node in its place."""
    if isinstance(node, (ast.If, ast.While)):
        yield lambda it: setattr(it, "test", ast.UnaryOp(ast.Not(), it.test))
    elif isinstance(node, REMOVABLE):
        yield lambda it: ast.Pass()
    elif isinstance(node, ast.Compare):
        for number, operator in enumerate(node.ops):
            for other in OTHERS.get(type(operator), ()):
                yield lambda it, number=number, other=other: it.ops.__setitem__(number, other())
    elif isinstance(node, (ast.BinOp, ast.BoolOp)):
        for other in OTHERS.get(type(node.op), ()):
            yield lambda it, other=other: setattr(it, "op", other())
    elif isinstance(node, ast.UnaryOp):
        yield lambda it: it.operand
    elif isinstance(node, ast.Attribute) and node.attr in FUNCTIONS:
        yield lambda it: setattr(it, "attr", FUNCTIONS[it.attr])
    elif isinstance(node, ast.Name) and node.id in FUNCTIONS:
        yield lambda it: setattr(it, "id", FUNCTIONS[it.id])
    elif isinstance(node, ast.Constant) and node.value != "__main__":
        for value in _other_values(node.value):
            yield lambda it, value=value: setattr(it, "value", value)


def _other_values(value: Any) -> Tuple[Any, ...]:
    if isinstance(value, bool):
        return (not value,)
    if isinstance(value, (int, str)):
        return (value + (1 if isinstance(value, int) else "x"),)
    return ((2.0 * value, 0.5 * value) if value else (1.0,)) if isinstance(value, float) else ()


class _Changed(ast.NodeTransformer):
    """Changes the node of a number, in the order of visits."""

    def __init__(self, number: int, change: Callable[[Any], object]) -> None:
        self._left, self._change = number, change

    def visit(self, node: ast.AST) -> Any:
        """Count this node."""
        self._left -= 1
        if self._left == -1:
            other = self._change(node)
            return other if isinstance(other, ast.AST) else node
        return self.generic_visit(node)


class _Nodes(ast.NodeVisitor):
    """All nodes in the order of visits."""

    def __init__(self) -> None:
        self.found: List[ast.AST] = []

    def visit(self, node: ast.AST) -> None:
        """Note this node."""
        self.found.append(node)
        self.generic_visit(node)


def mutants(base: str) -> List[str]:
    """The programs that differ in one place from a solution."""
    tree, nodes = ast.parse(RIGHT[base]), _Nodes()
    nodes.visit(tree)
    found: Set[str] = set()
    for number, node in enumerate(nodes.found):
        for change in _changes(node):
            made = _Changed(number, change).visit(copy.deepcopy(tree))
            with contextlib.suppress(SyntaxError, ValueError):
                text = ast.unparse(ast.fix_missing_locations(made))
                compile(text, base, "exec")
                found.add(text)
    return sorted(found - {ast.unparse(tree)})


def difference(base: str, text: str) -> str:
    """The first line in which a mutant differs."""
    for before, after in zip(ast.unparse(ast.parse(RIGHT[base])).splitlines(), text.splitlines()):
        if before != after:
            return f"{before.strip()}  ->  {after.strip()}"
    return "a line at the end"


# -- gradings --


def once(job: Tuple[str, str, str, int, int]) -> Entry:
    """Grade a program by all checks: name, condition, program, number of the repetition, seed."""
    name, condition, text, number, seed = job
    started, points, report, failed = time.monotonic(), None, {}, []  # type: float, Any, Dict[str, Any], List[str]
    with tempfile.TemporaryDirectory() as folder:
        try:
            grade = graded(name, text, Path(folder), seed)
            points, failed = grade.points, [it.name for it in grade.checks if it.outcome is not Outcome.PASSED]
            report = {it.name: [it.outcome.value, it.words] for it in grade.checks}
        except RobocopError as error:
            failed = [f"no grade: {error}"]
    seconds = round(time.monotonic() - started, 1)
    entry = {"name": name, "condition": condition, "number": number, "seconds": seconds, "points": points}
    return {**entry, "failed": failed, "report": report}


def run(jobs: List[Tuple[str, str, str, int, int]], log: Path, at_once: int, load_: int = 0) -> List[Entry]:
    """The log with the gradings that it did not have."""
    entries = [json.loads(line) for line in log.read_text().splitlines()] if log.exists() else []
    known = {(it["name"], it["condition"], it["number"]) for it in entries}
    left = [job for job in jobs if (job[0], job[1], job[3]) not in known]
    context = multiprocessing.get_context("spawn")  # a fresh process for each grading
    busy = busy_processes(load_) if load_ else contextlib.nullcontext()
    with busy, open(log, "a") as file, context.Pool(at_once, maxtasksperchild=1) as pool:
        for entry in pool.imap_unordered(once, left):
            print(json.dumps(entry), file=file, flush=True)
            entries.append(entry)
            print(f"{entry['name']}: {entry['points']} points, {entry['seconds']} s", file=sys.stderr, flush=True)
    return entries


def repeats(args: argparse.Namespace) -> int:
    """Print what is not as expected, and what differs; the number of these lines."""
    condition = f"{args.at_once} at once, {args.load} busy loops"
    names = args.names or list(BY_NAME)
    text = {name: BY_NAME[name].text() if name in BY_NAME else RIGHT[name] for name in names}
    numbers = range(args.times)
    jobs = [(it, condition, text[it], number, number + 1 if args.drawn else 0) for number in numbers for it in names]
    entries = [it for it in run(jobs, args.log, args.at_once, args.load) if it["name"] in names]
    found: List[str] = []
    seen: Dict[str, Set[str]] = defaultdict(set)
    for entry in entries:
        wrong, name = BY_NAME.get(entry["name"]), entry["name"]
        outcome, words = entry["report"].get(wrong.check, ["", ""]) if wrong else ("", "")
        expected = outcome == "failed" and wrong.words in words if wrong else not entry["failed"]
        found += [] if expected else [f"not as expected: {name}, {entry['condition']}: {words or entry['failed']}"]
        lines = {f"{name}: {check}": without_figures(str(it)) for check, it in entry["report"].items()}
        for place, told in {**lines, f"{name}: points": str(entry["points"])}.items():
            seen[place].add(told)
    found += [f"differs: {place}: {sorted(told)}" for place, told in sorted(seen.items()) if len(told) > 1]
    print("\n".join([*found, f"{len(entries)} gradings in {sorted({it['condition'] for it in entries})}"]))
    return len(found)


def mutate(args: argparse.Namespace) -> int:
    """Print the mutants that keep full marks; 0."""
    jobs = []
    for base in args.names or BASES:
        of_base = mutants(base)
        chosen = random.Random(base).sample(of_base, min(args.sample, len(of_base)))
        jobs += [(base, "mutant", text, zlib.crc32(text.encode()), 0) for text in chosen]
    random.Random(0).shuffle(jobs)  # an interrupted measurement has mutants of all solutions
    text = {(job[0], job[3]): job[2] for job in jobs}
    entries = [it for it in run(jobs, args.log, args.at_once) if (it["name"], it["number"]) in text]
    kept = [it for it in entries if not it["failed"]]
    print("\n".join(f"{it['name']}: {difference(it['name'], text[it['name'], it['number']])}" for it in kept))
    print(f"{len(entries)} mutants, {len(entries) - len(kept)} of them lost points")
    return 0


def main() -> None:
    """Exit status 1 if a repeated grade is not as expected or differs."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    kinds = parser.add_subparsers(required=True)
    repeated, mutated = (kinds.add_parser(name) for name in ("repeats", "mutants"))
    for part in (repeated, mutated):
        part.add_argument("names", nargs="*", metavar="NAME")
        part.add_argument("--log", type=Path, required=True)
        part.add_argument("--at-once", type=int, default=2)
    repeated.add_argument("--times", type=int, default=20)
    repeated.add_argument("--load", type=int, default=0)
    repeated.add_argument("--drawn", action="store_true")
    mutated.add_argument("--sample", type=int, default=10**6)
    repeated.set_defaults(measure=repeats)
    mutated.set_defaults(measure=mutate)
    args = parser.parse_args()
    sys.exit(1 if args.measure(args) else 0)


if __name__ == "__main__":
    main()
