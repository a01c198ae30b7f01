"""Runs, judges and reports one submission."""

import re
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Dict, List, Mapping, Sequence

from robocop_hosting.tree import temporary_folder

from . import judge
from .grades import Grade, completed
from .plan import PARTS
from .record import Record
from .report import write as report
from .runner import Runner
from .submission import Submission

NOT_WHOLE = "this is no full grade: only some checks, and the scenarios that they need"
MISSING = "Python's module {} is not installed here; if the lab has it, name its package in the plan, under packages"
BESIDE = "{0} lies beside {1}, but only {1} was given: grade the folder"
_NO_MODULE = re.compile(r"ModuleNotFoundError: No module named '(\w+)'")


def grade(runner: Runner, submission: Submission, folder: Path, moves: bool = False, all_plots: bool = False) -> Grade:
    """Write the report to `folder`, with plots and bags of the scenarios in which a check failed, or of all.

    `moves`: it goes to whoever handed in. UngradableError if the machine has no time or no memory for it.
    """
    plan = runner.plan
    records: Dict[str, Mapping[str, Record]] = {}
    problems: Dict[str, str] = {}
    with temporary_folder("robocop-grade-") as work:
        notes = [] if plan.is_whole else [NOT_WHOLE]
        missing: List[str] = []
        for script in (script for script in submission.scripts if plan.examines(script.part)):
            recorded = runner.run(submission, script, Path(work, script.part))
            records[script.part], problems[script.part] = recorded.records, recorded.problem
            notes += [f"{script.part}: {it}" for it in recorded.told]
            missing += [
                f"{script.part}: {it}" for it in _missing_modules(recorded.records, script.path.name, submission.beside)
            ]
        judged = completed(judge.judge(submission.name, plan, records, problems), plan)
        told = dict.fromkeys([*judged.notes, *notes, *submission.notes])
        judged = replace(
            judged, files=tuple(submission.files), problems=(*judged.problems, *missing), notes=tuple(told)
        )
        folder.mkdir(parents=True, exist_ok=True)
        for part in PARTS:
            for earlier in folder.glob(f"{part}-*.bag"):
                earlier.unlink()
        for bag in sorted(Path(work).glob("*/*.bag")):
            if all_plots or judged.failed_in(*bag.stem.split("-", 1)):
                shutil.copyfile(bag, folder / bag.name)
        report.write(judged, plan, records, folder, moves, all_plots)
    return judged


def _missing_modules(records: Mapping[str, Record], script: str, beside: Sequence[str]) -> List[str]:
    lines = [line.text for record in records.values() for line in record.lines]
    names = sorted({name for line in lines for name in _NO_MODULE.findall(line)})
    left = {it: next((name for name in (f"{it}.py", it) if name in beside), "") for it in names}  # a file or a folder
    return [BESIDE.format(name, script) if name else MISSING.format(it) for it, name in left.items()]
