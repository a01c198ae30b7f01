"""Mutates correct solutions and grades the mutants: those that keep full marks are allowed or show a gap of the checks.

    ./robocop shell python3 test/solutions/mutants.py --sample 80 --jobs 2 --log FILE [NAME...]

A mutant differs from its solution in one place: an operator, a comparison, a number, a text, a negated condition
or a statement that is removed. Grading ends with the first scenario that takes points off. The log holds a JSON object
per mutant; with an existing log the measurement is continued. Prints how many mutants were killed, and the line of each
one that was not.
"""

import argparse
import ast
import hashlib
import json
import multiprocessing
import random
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Dict, Iterator, List, Tuple

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # test/, as pytest has it

from graded import PLAN, RIGHT, recorded

from aro_robocop_goto_as.errors import RobocopError
from robocop_grading import judge, runner
from robocop_grading.judge import Outcome
from robocop_grading.plan import load

BASES = ("base_server", "base_bridge", "functions_bang_bang")
BUDGET = 900.0  # [s, wall] for a mutant, on however busy a machine
COMPARISONS = {
    ast.Lt: ("<", ("<=", ">")),
    ast.LtE: ("<=", ("<", ">")),
    ast.Gt: (">", (">=", "<")),
    ast.GtE: (">=", (">", "<")),
    ast.Eq: ("==", ("!=",)),
    ast.NotEq: ("!=", ("==",)),
    ast.Is: ("is", ("is not",)),
    ast.IsNot: ("is not", ("is",)),
}
OPERATORS = {
    ast.Add: ("+", "-"),
    ast.Sub: ("-", "+"),
    ast.Mult: ("*", "/"),
    ast.Div: ("/", "*"),
    ast.BitAnd: ("&", "|"),
    ast.BitOr: ("|", "&"),
    ast.And: ("and", "or"),
    ast.Or: ("or", "and"),
}
FUNCTIONS = {"min": "max", "max": "min", "sin": "cos", "cos": "sin", "abs": ""}
REMOVABLE = (ast.Expr, ast.Assign, ast.AugAssign, ast.Return, ast.Break, ast.Continue)

Edit = Tuple[int, int, str]  # the characters from ... to ... become this text


@dataclass(frozen=True)
class Mutant:
    """A solution with one change, and the line in which it is: number, before, after."""

    base: str
    line: int
    before: str
    after: str
    text: str

    @property
    def key(self) -> str:
        """Identifies it in the log."""
        return f"{self.base}-{hashlib.sha256(self.text.encode()).hexdigest()[:12]}"


class Program:
    """The source of a solution, with its syntax tree and the places of its nodes."""

    def __init__(self, text: str) -> None:
        assert text.isascii(), "ast counts bytes"
        self.text, self.tree = text, ast.parse(text)
        self._starts = [0]
        for line in text.splitlines(keepends=True):
            self._starts.append(self._starts[-1] + len(line))

    def start(self, node: Any) -> int:
        """Its first character."""
        return self._starts[node.lineno - 1] + int(node.col_offset)

    def end(self, node: Any) -> int:
        """The character after its last one."""
        return self._starts[node.end_lineno - 1] + int(node.end_col_offset)

    def between(self, left: Any, right: Any, word: str) -> Tuple[int, int]:
        """Where an operator is between its operands, which may be in parentheses."""
        at = self.text.index(word, self.end(left), self.start(right))
        return at, at + len(word)

    def edits(self) -> Iterator[Edit]:
        """All changes."""
        for node in ast.walk(self.tree):
            if isinstance(node, (ast.If, ast.While)) and "__name__" not in ast.dump(node.test):
                place = self.start(node.test), self.end(node.test)
                yield (*place, f"not ({self.text[slice(*place)]})")
            elif isinstance(node, REMOVABLE):
                yield self.start(node), self.end(node), "pass"
            yield from self._operators(node)
            yield from self._values(node)

    def _operators(self, node: ast.AST) -> Iterator[Edit]:
        if isinstance(node, ast.Compare):
            for left, operator, right in zip([node.left, *node.comparators], node.ops, node.comparators):
                word, others = COMPARISONS.get(type(operator), ("", ()))
                for other in others:
                    yield (*self.between(left, right, word), other)
        elif isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
            word, other = OPERATORS[type(node.op)]
            yield (*self.between(node.left, node.right, word), other)
        elif isinstance(node, ast.BoolOp):
            word, other = OPERATORS[type(node.op)]
            for left, right in zip(node.values, node.values[1:]):
                yield (*self.between(left, right, word), other)
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.USub, ast.Not)):
            yield self.start(node), self.start(node.operand), ""
        elif isinstance(node, ast.Call):
            name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
            if name in FUNCTIONS:
                yield self.end(node.func) - len(name), self.end(node.func), FUNCTIONS[name]

    def _values(self, node: ast.AST) -> Iterator[Edit]:
        if not isinstance(node, ast.Constant):
            return
        place = self.start(node), self.end(node)
        if isinstance(node.value, bool):
            yield (*place, str(not node.value))
        elif isinstance(node.value, int):
            yield (*place, str(node.value + 1))
        elif isinstance(node.value, float):
            for value in (2.0 * node.value, 0.5 * node.value) if node.value else (1.0,):
                yield (*place, str(value))
        elif isinstance(node.value, str) and node.value != "__main__":
            yield (*place, repr(node.value + "x"))


def mutants(base: str) -> List[Mutant]:
    """All mutants of a solution that are valid Python."""
    program = Program(RIGHT[base].read_text())
    found: Dict[str, Mutant] = {}
    for start, end, new in program.edits():
        text = program.text[:start] + new + program.text[end:]
        number = program.text.count("\n", 0, start)
        try:
            compile(text, base, "exec")
        except (SyntaxError, ValueError):
            continue
        before, after = program.text.splitlines()[number], text.splitlines()[number]
        found.setdefault(text, Mutant(base, number + 1, before.strip(), after.strip(), text))
    found.pop(program.text, None)
    return list(found.values())


def grade(mutant: Mutant) -> Dict[str, Any]:
    """The mutant's entry in the log; `killed` names the checks that took points off, in the order of the plan."""
    started = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        killed = _lost(mutant.text, Path(folder))
    seconds = round(time.monotonic() - started, 1)
    entry = {"key": mutant.key, "base": mutant.base, "line": mutant.line, "before": mutant.before}
    return {**entry, "after": mutant.after, "killed": killed, "seconds": seconds}


class _Killed(Exception):
    """A scenario has taken points off."""


def _lost(text: str, folder: Path) -> List[str]:
    """The checks that took points off until the first scenario that did."""
    plan = load(PLAN)

    def judged(part: str, records: Dict[str, Any], problem: str = "") -> judge.Grade:
        return judge.judge("mutant", plan, {part: records}, {part: problem})

    def stop_after_failure(_scenario: str) -> None:
        for part in ("server", "bridge"):
            failed = judged(part, runner.records_in(folder / "out", part)).failed()
            if failed:
                raise _Killed(failed)

    try:
        run = recorded(text, folder, budget=BUDGET, on_progress=stop_after_failure)
    except _Killed as killed:
        return list(killed.args[0])
    except RobocopError as error:
        return [f"not gradable: {error}"]
    part = next((record.part for record in run.records.values()), "server")
    checks = judged(part, run.records, run.problem or ("" if run.records else "no records")).checks
    return [check.name for check in checks if check.outcome is not Outcome.PASSED]


def table(entries: List[Dict[str, Any]]) -> str:
    """How many mutants of each solution were killed, and each one that was not."""
    rows = ["| solution | mutants | killed | full marks |", "| --- | --- | --- | --- |"]
    for base in sorted({entry["base"] for entry in entries}):
        killed = [bool(entry["killed"]) for entry in entries if entry["base"] == base]
        rows.append(f"| {base} | {len(killed)} | {sum(killed)} | {len(killed) - sum(killed)} |")
    kept = sorted(
        (entry["base"], entry["line"], entry["before"], entry["after"]) for entry in entries if not entry["killed"]
    )
    return "\n".join([*rows, "", *(f"{base}:{line}\n  - {old}\n  + {new}" for base, line, old, new in kept)])


def mutate() -> None:
    """Grade the mutants that the log does not have, then print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", default=BASES, help=f"solutions (default: {BASES})")
    parser.add_argument("--sample", type=int, metavar="N", help="mutants of each solution, drawn once (default: all)")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--log", type=Path, required=True)
    parser.add_argument(
        "--kept", action="store_true", help="grade those again that keep full marks according to the log"
    )
    args = parser.parse_args()
    chosen: List[Mutant] = []
    for name in args.names:
        of_base = mutants(name)
        count = len(of_base) if args.sample is None else min(args.sample, len(of_base))
        chosen += random.Random(name).sample(of_base, count)
    random.Random(0).shuffle(chosen)  # an interrupted measurement has mutants of all solutions
    lines = args.log.read_text().splitlines() if args.log.exists() else []
    done = {entry["key"]: entry for entry in map(json.loads, lines)}
    waiting = [mutant for mutant in chosen if mutant.key not in done or (args.kept and not done[mutant.key]["killed"])]
    context = multiprocessing.get_context("spawn")  # a fresh process for each grading
    with open(args.log, "a") as log, context.Pool(args.jobs, maxtasksperchild=1) as pool:
        for entry in pool.imap_unordered(grade, waiting):
            print(json.dumps(entry), file=log, flush=True)
            done[entry["key"]] = entry
            print(f"{len(done)} of {len(chosen)}", file=sys.stderr, flush=True)
    print(table([done[mutant.key] for mutant in chosen]))


if __name__ == "__main__":
    mutate()
