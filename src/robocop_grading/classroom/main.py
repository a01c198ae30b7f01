"""robocop grade-class: grade a folder of hand-ins in parallel; an interrupted run can be continued."""

import argparse
import contextlib
import os
import random
import sys
import time
from functools import partial
from pathlib import Path
from typing import Callable, Dict, List, Mapping
from xml.etree import ElementTree

from aro_robocop_goto_as.errors import RobocopError
from aro_robocop_goto_as.own_path import expect_own
from aro_robocop_goto_as.process.signals import ignore_all, interrupt_on_signal, reraise_if_interrupted
from aro_robocop_goto_as.process.start import typed
from robocop_hosting import orphans
from robocop_hosting.scratch import scratch_folder
from robocop_hosting.workspace import exclusive, places

from ..cli import INTERRUPTED, WRONG_USE
from ..errors import GradingSetupError
from ..files.exports import class_folder, people, visible
from ..grades import Grade
from ..plan import Plan
from ..plan_file import load
from ..report.write import make_report_folder
from ..sandbox.bubblewrap import open_sandbox
from ..scenarios import MAX_SEED
from ..submission import build_environments
from ..texts import printable_lines, shortened
from .hand_ins import collect
from .overview import page
from .results import HAND_IN_STAMP, MAX_TOLD, Results, write_atomically
from .summary import Summary, pace
from .table import one_line, table
from .worker import work

CSV, HTML = "grades.csv", "index.html"
CLASS_STAMP, PLAN = ".robocop_class", ".plan.yaml"  # in the folder of the results: the seed, and a copy of the plan
WORKERS_LOG = ".workers.log"  # in the folder of the results
NOT_YET = "not graded yet: run the same command again to continue"
CLASS_SEED = "draws the scenarios of the whole class (default: the one of the results so far; at first a random one)"


class Gradebook:
    """The hand-ins of one folder and their grades so far."""

    def __init__(self, folder: Path, results: Results, plan: Plan, hand_ins: Mapping[str, str]) -> None:
        self.folder, self.plan, self.results = folder, plan, results
        self._people = people(folder)
        self.count = len(hand_ins)
        self.done: Dict[str, Grade] = {
            name: results.read(name) for name, digest in hand_ins.items() if results.has(name, digest)
        }
        self.waiting = {name: digest for name, digest in hand_ins.items() if name not in self.done}
        self.problems: Dict[str, str] = {}
        self._started, self._ran = time.monotonic(), 0

    @property
    def figures(self) -> Summary:
        """How many hand-ins are judged so far, and their points."""
        judged = [result.points for result in self.done.values() if result.is_judged]
        return Summary(judged, len(self.done) - len(judged) + len(self.problems), self.plan.points)

    @property
    def pace(self) -> str:
        """The rate of grading and the time left, in words, by the hand-ins that have run; the others take no time."""
        left = [name for name, digest in self.waiting.items() if digest and name not in self.problems]
        return pace(self._ran, len(left), time.monotonic() - self._started)

    def summary_lines(self) -> List[str]:
        """The figures for the terminal, and the hand-ins that are not gradable, with the reasons."""
        reasons = {name: " | ".join(it.problems) for name, it in sorted(self.done.items()) if not it.is_judged}
        reasons.update(self.problems)
        told = [f"not gradable: {it}: {why}" for it, why in reasons.items()]
        figures = [it for it in (self.figures.counts, self.figures.averages) if it]
        return figures + [shortened(one_line(it), MAX_TOLD) for it in told]

    def add(self, name: str, problem: str) -> str:
        """Note that a hand-in has a result, or the reason why it has none; return a line about it for the terminal."""
        if problem:
            self.problems[name] = problem
            return shortened(one_line(f"{name}: {problem}"), MAX_TOLD)
        result = self.done[name] = self.results.read(name)
        self.waiting.pop(name, None)
        self._ran += result.is_judged
        problems = shortened(f" ({' | '.join(result.problems)})", MAX_TOLD) if result.problems else ""
        words = f"{result.words if result.is_judged else 'not gradable'}{problems}"
        left = f"; {self.pace}" if self.pace else ""
        return one_line(f"[{len(self.done)}/{self.count}] {name}: {words}{left}")

    def write(self) -> None:
        """Write the table and the overview of the results so far."""
        results, folder = [self.done[name] for name in sorted(self.done)], self.results.folder
        write_atomically(folder / CSV, table(results, self.plan, self.problems, self._people))
        missing = {name: self.problems.get(name, NOT_YET) for name in self.waiting}
        html = page(self.folder.name, results, self.plan, self.figures, missing, self._people)
        write_atomically(folder / HTML, html)


def arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(prog=typed("grade-class"), description=__doc__, allow_abbrev=False)
    parser.add_argument("folder", metavar="DIR", help="contains a folder, archive or Python file per hand-in")
    parser.add_argument("--report", metavar="DIR", help="folder of the results (default: DIR_results)")
    parser.add_argument("--plan", metavar="YAML", help="limits, points and packages (default: of the results so far)")
    parser.add_argument("--seed", type=int, metavar="N", help=CLASS_SEED)
    parser.add_argument("--workers", type=int, metavar="N", help="hand-ins at once (default: one a core)")
    parser.add_argument("--scheduler", default="", metavar="tls://HOST:PORT", help="use the workers of this scheduler")
    parser.add_argument("--unsafe", action="store_true", help="run the submissions without bubblewrap's sandbox")
    return parser.parse_args()


def grade_class(args: argparse.Namespace) -> Gradebook:
    """Grade what is not graded yet; RobocopError says why that can't be done."""
    folder = Path(args.folder).resolve()
    state, share = places()
    if args.workers is not None and args.workers < 1:
        raise GradingSetupError(f"--workers {args.workers}: expected 1 or more")
    if args.scheduler and not args.scheduler.startswith("tls://"):
        # Anyone who can reach the port of another one can run any code on its workers, with their user's rights.
        raise GradingSetupError(f"--scheduler {args.scheduler}: expected tls://HOST:PORT, see docs/grading.md")
    out = Path(os.path.realpath(args.report or f"{folder}_results"))
    expect_own(out, CLASS_STAMP, folder)
    given, folder = folder, class_folder(folder, (CSV, HTML))
    if folder != given:
        print(f"{one_line(str(folder))} is the class: nothing else is in {one_line(str(given))}", flush=True)
    hand_ins = _hand_ins(folder)
    stored = [path.name for path in visible(out) if (path / HAND_IN_STAMP).is_file()] if out.is_dir() else []
    if stored and not {*stored} & {*hand_ins}:
        others = f"results of other hand-ins, such as {stored[0]}"
        raise GradingSetupError(f"{out} has {others}: give another folder by --report")
    version = ElementTree.parse(share / "package.xml").findtext("version")
    make_report_folder(out, CLASS_STAMP)
    with scratch_folder(), exclusive(out / ".run"):
        plan = class_plan(args, out, share)
        results = Results(out, plan, version or "")
        gradebook = Gradebook(folder, results, plan, hand_ins)
        write_atomically(out / CLASS_STAMP, f"{plan.seed}\n")
        write_atomically(out / PLAN, plan.path.read_text(encoding="utf-8"))
        print(f"{gradebook.count} handed in, {len(gradebook.done)} of them already graded", flush=True)
        print(f"scenarios: seed {plan.seed}", flush=True)
        if not args.scheduler:
            open_sandbox(args.unsafe)
            build_environments(share, state)
        workers = args.workers or len(os.sched_getaffinity(0))
        grade_waiting(gradebook, args.scheduler, workers, partial(work, plan=plan, results=results, unsafe=args.unsafe))
    return gradebook


def _hand_ins(folder: Path) -> Dict[str, str]:
    """What the folder has, by name; what is no hand-in is printed."""
    hand_ins, others = collect(folder, (CSV, HTML))
    for name in others:
        print(f"ignored: {one_line(name)}, which is no hand-in", flush=True)
    return hand_ins


def main() -> None:
    """Exit status 0: everybody is judged; 1: somebody was not gradable; 2: as of robocop grade; 130: interrupted."""
    args = arguments()
    interrupt_on_signal()
    try:
        gradebook = grade_class(args)
    except RobocopError as error:
        print(f"robocop grade-class: {printable_lines(str(error))}", file=sys.stderr)
        sys.exit(WRONG_USE)
    except KeyboardInterrupt:
        ignore_all()
        with contextlib.suppress(OSError):  # the terminal may be closed
            sys.stdout.flush()
            sys.stderr.flush()
        os._exit(INTERRUPTED)  # dask's handlers at exit would wait for workers that had not started, and print why not
    finally:
        ignore_all()
    out = gradebook.results.folder
    print("\n".join([*gradebook.summary_lines(), f"table: {out / CSV}", f"overview: {out / HTML}"]))
    sys.exit(1 if gradebook.figures.not_judged else 0)


def class_plan(args: argparse.Namespace, out: Path, share: Path) -> Plan:
    """The given plan and seed, else those of the results so far; GradingSetupError if other outcomes would follow."""
    kept = out / PLAN
    before = load(kept, int((out / CLASS_STAMP).read_text())) if kept.is_file() else None
    seeds = (args.seed, before.seed if before else None, random.randint(1, MAX_SEED))
    path = Path(args.plan) if args.plan else kept if before else share / "config" / "grading.yaml"
    plan = load(path, next(seed for seed in seeds if seed is not None))
    if before and before.outcomes != plan.outcomes:
        told = "another one may differ in points only; for other grades give another folder by --report"
        raise GradingSetupError(f"{out} has the results of the plan {kept} and seed {before.seed}: {told}")
    return plan


def grade_waiting(gradebook: Gradebook, scheduler: str, workers: int, task: Callable[[Path], None]) -> None:
    """Grade the remaining hand-ins, and write what is done; if interrupted, say so, and raise KeyboardInterrupt."""
    try:
        if gradebook.waiting:
            from .cluster import connected, done, send_child_errors_to  # importing dask takes half a second

            send_child_errors_to(gradebook.results.folder / WORKERS_LOG)
            paths = [gradebook.folder / name for name in gradebook.waiting]
            with connected(scheduler, min(workers, len(paths))) as client:
                for path, problem in done(client, task, paths):
                    reraise_if_interrupted()
                    orphans.reap_adopted("bwrap")  # one of each node
                    print(gradebook.add(path.name, problem), flush=True)
    except KeyboardInterrupt:
        with contextlib.suppress(OSError):  # the terminal may be closed
            so_far = f"{len(gradebook.done)} of {gradebook.count} graded"
            print(f"\ninterrupted: {so_far}; run the same command again to continue", file=sys.stderr)
        sys.stderr = open(os.devnull, "w")  # for what dask's objects report when they are deleted
        raise
    finally:
        gradebook.write()
