"""robocop grade-class: a folder of hand-ins -> a table, an overview, a report each; it goes on where it ended."""

import argparse
import contextlib
import hashlib
import os
import sys
from pathlib import Path
from typing import Dict, List, Union
from xml.etree import ElementTree

from ...errors import GradingError, RobocopError
from ...hosting.workspace import alone
from ...interruption import as_ctrl_c, check, the_end
from ..plan import Plan, load
from .hand_ins import HandIn, collect
from .overview import page
from .results import Result, Results, in_order, table, write_whole
from .worker import Done, Task

CSV, HTML = "grades.csv", "index.html"


class Class:
    """The hand-ins of one folder, what is done of them, and how far it is."""

    def __init__(self, folder: Path, results: Results, plan: Plan, hand_ins: List[HandIn], again: bool) -> None:
        self.title, self.plan, self._results = folder.name, plan, results
        self.count = len(hand_ins)
        self.done: Dict[str, Result] = {
            it.name: results.read(it.name) for it in hand_ins if not again and results.has(it)}
        self.waiting = [it for it in hand_ins if it.name not in self.done]
        self.problems: Dict[str, str] = {}

    def take(self, name: str, outcome: Union[Done, str]) -> str:
        """Keep what came of one hand-in; a line about it."""
        if isinstance(outcome, str):
            self.problems[name] = outcome
            return f"{shown(name)}: {outcome}"
        self._results.keep(outcome)
        result = self.done[name] = self._results.read(name)
        self.waiting = [it for it in self.waiting if it.name != name]
        self.write(running=True)
        words = f" ({' | '.join(result.problems)})"[:200] if result.problems else ""
        return f"[{len(self.done)}/{self.count}] {shown(name)}: {result.points:g} points, {result.seconds:.0f} s{words}"

    def write(self, running: bool) -> None:
        """The table and the overview, as things are."""
        results, folder = in_order(self.done), self._results.folder
        write_whole(folder / CSV, table(results, self.plan))
        waiting = {it.name: self.problems.get(it.name, "waiting") for it in self.waiting}
        write_whole(folder / HTML, page(self.title, results, self.plan, waiting, running))


def shown(name: str) -> str:
    """A file's name for a person, whatever bytes it is made of."""
    return name.encode("utf-8", "replace").decode()


def main() -> None:
    """Exit status 0: everybody is graded; 1: somebody can't be, or nobody; 130: interrupted."""
    parser = argparse.ArgumentParser(prog="robocop grade-class", description=__doc__)
    parser.add_argument("folder", metavar="DIR", help="in it a folder (a package), zip or Python file for each hand-in")
    parser.add_argument("--report", metavar="DIR", help="where results go (default: .robocop/classes/NAME)")
    parser.add_argument("--plan", metavar="YAML", help="scenarios, limits and points (default: config/grading.yaml)")
    parser.add_argument("--workers", type=int, metavar="N", help="processes here (default: one for each core)")
    parser.add_argument("--scheduler", default="", metavar="tcp://HOST:PORT", help="a dask scheduler to use instead")
    parser.add_argument("--again", action="store_true", help="grade all of them, also those that are done")
    parser.add_argument("--unsafe", action="store_true", help="run the code without bubblewrap around it")
    args = parser.parse_args()
    as_ctrl_c()
    state, share = Path(os.environ["ROBOCOP_STATE"]), Path(os.environ["ROBOCOP_SHARE"])
    plan_path = Path(args.plan) if args.plan else share / "config" / "grading.yaml"
    folder = Path(args.folder).resolve()
    try:
        if args.workers is not None and args.workers < 1:
            raise GradingError(f"--workers {args.workers}: expected 1 or more")
        plan = load(plan_path)
        text = plan_path.read_text()
        hand_ins, others = collect(folder)
        for taken in {it.name for it in hand_ins} & {CSV, HTML}:
            raise GradingError(f"{folder / taken}: the results have a file of that name; rename the hand-in")
        for name in others:
            print(f"left aside: {shown(name)}, which is neither a folder nor a zip nor a Python file", flush=True)
        version = ElementTree.parse(share / "package.xml").findtext("version")
        out = Path(args.report) if args.report else state / "classes" / folder.name
        with alone(out / ".run"):
            results = Results(out, {"plan": hashlib.sha256(text.encode()).hexdigest(), "grader": version})
            group = Class(folder, results, plan, hand_ins, args.again)
            print(f"{group.count} handed in, {len(group.done)} of them graded already", flush=True)
            tasks = [Task(it, text, args.unsafe) for it in group.waiting]
            _grade(group, tasks, args.scheduler, args.workers or len(os.sched_getaffinity(0)), args.unsafe)
    except RobocopError as error:
        print(f"robocop grade-class: {error}", file=sys.stderr)
        sys.exit(1)
    print(f"table: {out / CSV}\noverview: {out / HTML}")
    sys.exit(1 if group.problems else 0)


def _grade(group: Class, tasks: List[Task], scheduler: str, workers: int, unsafe: bool) -> None:
    """Grade what is left. Interrupted, it leaves everything such that the next run goes on."""
    group.write(running=bool(tasks))
    try:
        if tasks:
            from .cluster import connected, grade_all  # dask takes half a second to come up
            with connected(scheduler, min(workers, len(tasks)), unsafe) as client:
                for name, outcome in grade_all(client, tasks):
                    check()
                    try:
                        line = group.take(name, outcome)
                    except OSError as error:
                        line = group.take(name, f"its results can't be kept: {error}")
                    print(line, flush=True)
    except KeyboardInterrupt:
        with contextlib.suppress(OSError):  # its terminal may be gone
            print(f"\ninterrupted: {len(group.done)} of {group.count} graded; the same command goes on from there",
                  file=sys.stderr)
        sys.exit(130)
    finally:
        group.write(running=False)
        the_end()
