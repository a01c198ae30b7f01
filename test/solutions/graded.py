"""Solutions kept as text, graded as a student's file would be."""

import multiprocessing
import os
import sys
import tempfile
import time
from pathlib import Path
from typing import Dict, Optional, Sequence

from wrong_solutions import WRONG, Wrong

from aro_robocop_goto_as.errors import GradingError
from aro_robocop_goto_as.grading import judge, runner
from aro_robocop_goto_as.grading.judge import Grade
from aro_robocop_goto_as.grading.plan import load
from aro_robocop_goto_as.grading.sandbox import Cage, cage
from aro_robocop_goto_as.grading.submission import take

HERE = Path(__file__).resolve().parent
STATE, SHARE = Path(os.environ["ROBOCOP_STATE"]), Path(os.environ["ROBOCOP_SHARE"])
PLAN = SHARE / "config" / "grading.yaml"
RIGHT: Dict[str, Path] = {path.name[:-len(".py.in")]: path
                          for path in sorted([*HERE.glob("base_*.py.in"), *(HERE / "right").glob("*.py.in")])}


def _can_be_caged() -> bool:
    try:
        return cage(False) is not None
    except GradingError:
        return False


CAGED = _can_be_caged()  # these solutions are ours: where bubblewrap can't run they are judged without it
SWITCHES = [] if CAGED else ["--unsafe"]


def the_cage() -> Optional[Cage]:
    """What these solutions run in here."""
    return cage(not CAGED, [STATE / "venv", STATE / "compat"])


def recorded(text: str, folder: Path, only: Sequence[str] = (), budget: float = runner.BUDGET) -> runner.Recorded:
    """A solution driven through the scenarios of its part, or some of them, in the cage."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "solution.py").write_text(text)
    around = the_cage()
    submission = take(str(folder / "solution.py"), SHARE, STATE, folder, around)
    return runner.run(submission, submission.scripts[0], PLAN, folder / "out", STATE, around, only, budget=budget)


def graded(name: str, text: str, folder: Path) -> Grade:
    """A solution's grade."""
    it = recorded(text, folder)
    part = "bridge" if "no_server" in it.records else "server"
    return judge.judge(name, load(PLAN), {part: it.records}, {part: it.problem})


def row(wrong: Wrong) -> str:
    """A wrong solution against all checks: a row for docs/grading.md."""
    started = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        grade = graded(wrong.name, wrong.text(), Path(folder))
    seconds = time.monotonic() - started
    line = {line.name: line for line in grade.lines}[wrong.check]
    found, said = line.failure is not None, wrong.words in line.words()
    others = ", ".join(name for name in grade.failed() if name != wrong.check)
    cells = (wrong.name, wrong.check if found else "NO", "yes" if said else "NO", others, f"{grade.points:g}",
             f"{seconds:.0f}")
    return f"| {' | '.join(cells)} |"


def main() -> None:
    """Print the rows of wrong solutions, two at a time; arguments: names, all of them without."""
    print("| mistake | found by the check meant for it | with the right words | failed besides | points | seconds |\n"
          "| --- | --- | --- | --- | --- | --- |")
    chosen = [wrong for wrong in WRONG if len(sys.argv) == 1 or wrong.name in sys.argv[1:]]
    with multiprocessing.get_context("spawn").Pool(2, maxtasksperchild=1) as pool:
        for words in pool.imap(row, chosen):
            print(words, flush=True)


if __name__ == "__main__":
    main()
