"""Runs, judges and reports one submission."""

import shutil
import tempfile
from functools import partial
from pathlib import Path
from typing import Callable, Dict, Mapping, Optional

from . import judge, report, runner
from .judge import Grade
from .plan import Plan
from .record import Record
from .sandbox import Sandbox
from .submission import Submission

Progress = Callable[[str, str], None]  # part, scenario


def grade_submission(
    submission: Submission,
    plan: Plan,
    folder: Path,
    state: Path,
    sandbox: Optional[Sandbox],
    on_progress: Progress = lambda _part, _scenario: None,
    watched: bool = False,
    scratch: Optional[Path] = None,
) -> Grade:
    """Write the report and the bags of failed scenarios to `folder`; temporary files go to `scratch`.

    With `watched` the run is shown in RViz in real time.
    """
    records: Dict[str, Mapping[str, Record]] = {}
    problems: Dict[str, str] = {}
    with tempfile.TemporaryDirectory(prefix="robocop-grade-", dir=scratch) as work:
        for script in submission.scripts:
            recorded = runner.run(
                submission,
                script,
                plan.path,
                Path(work, script.part),
                state,
                sandbox,
                on_progress=partial(on_progress, script.part),
                watched=watched,
            )
            records[script.part], problems[script.part] = recorded.records, recorded.problem
        grade = judge.judge(submission.name, plan, records, problems)
        folder.mkdir(parents=True, exist_ok=True)
        report.write(grade, plan, records, folder)
        for check in grade.checks:
            bag = Path(work, check.part, f"{check.part}-{check.scenario}.bag")
            if check.failure is not None and bag.is_file():
                shutil.copyfile(bag, folder / bag.name)
    return grade
