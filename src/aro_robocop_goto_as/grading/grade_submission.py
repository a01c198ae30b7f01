"""Runs, judges and reports one submission."""

import shutil
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Callable, Dict, Mapping, Optional

from ..errors import UngradableError
from ..hosting.tree import remove, temporary_folder
from . import judge, report, runner
from .judge import Grade
from .plan import Plan
from .record import Record
from .sandbox import Sandbox
from .submission import Submission
from .viewer import Viewer

Progress = Callable[[str, str], None]  # part, scenario
ATTEMPTS = 2
KILLED = " by a SIGKILL that did not come from the grader (is the machine short of memory?)"


def grade_submission(
    submission: Submission,
    plan: Plan,
    folder: Path,
    state: Path,
    sandbox: Optional[Sandbox],
    on_progress: Progress = lambda _part, _scenario: None,
    viewer: Optional[Viewer] = None,
    scratch: Optional[Path] = None,
    keep: bool = False,
) -> Grade:
    """Write the report and the bags of failed scenarios to `folder`; temporary files go to `scratch`.

    With `keep` the folder stays where it is, and gets the bags of all scenarios. With a `viewer` the run is shown
    in real time. A part that is killed from outside is run once more; UngradableError if that is killed, too.
    """
    records: Dict[str, Mapping[str, Record]] = {}
    problems: Dict[str, str] = {}
    with temporary_folder("robocop-grade-", scratch) as work:
        notes = list(submission.notes)
        for script in submission.scripts:
            for attempt in range(1, ATTEMPTS + 1):
                out = Path(work, script.part)
                recorded = runner.run(
                    submission,
                    script,
                    plan,
                    out,
                    state,
                    sandbox,
                    on_progress=partial(on_progress, script.part),
                    viewer=viewer,
                )
                if not recorded.killed:
                    break
                if attempt == ATTEMPTS:
                    raise UngradableError(f"not gradable: {recorded.killed}{KILLED}, as in the previous attempt")
                notes.append(f"{script.part}: {recorded.killed}{KILLED}; this part was run again")
                remove(out)
            records[script.part], problems[script.part] = recorded.records, recorded.problem
        grade = judge.judge(submission.name, plan, records, problems)
        grade = replace(grade, problems=(*grade.problems, *notes))
        folder.mkdir(parents=True, exist_ok=True)
        failed = {f"{check.part}-{check.scenario}" for check in grade.checks if check.failure is not None}
        for bag in sorted(Path(work).glob("*/*.bag")):
            if keep or bag.stem in failed:
                shutil.copyfile(bag, folder / bag.name)
        report.write(grade, plan, records, folder, keep)
    return grade
