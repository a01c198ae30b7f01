"""A submission -> its grade, with the report in a folder: every part driven, judged and written down."""

import shutil
import tempfile
from functools import partial
from pathlib import Path
from typing import Callable, Dict, Optional

from . import judge, record, report, runner
from .judge import Grade
from .plan import Plan, load
from .sandbox import Cage
from .submission import Submission

Progress = Callable[[str, str], None]  # part, scenario


def examine(
    submission: Submission,
    plan_path: Path,
    folder: Path,
    state: Path,
    around: Optional[Cage],
    on_progress: Progress = lambda _part, _scenario: None,
    watched: bool = False,
    scratch: Optional[Path] = None,
) -> Grade:
    """Run and judge all parts of a submission; the report, with the bags of what failed, goes to `folder`.

    What is made on the way is in a folder that is gone at the end, within `scratch` if that is given.

    Watched, all of it is shown in RViz at real time.
    """
    plan: Plan = load(plan_path)
    records: Dict[str, Dict[str, record.Record]] = {}
    problems: Dict[str, str] = {}
    with tempfile.TemporaryDirectory(prefix="robocop-grade-", dir=scratch) as work:
        for script in submission.scripts:
            recorded = runner.run(submission, script, plan_path, Path(work, script.part), state, around,
                                  on_progress=partial(on_progress, script.part), watched=watched)
            records[script.part], problems[script.part] = recorded.records, recorded.problem
        result = judge.judge(submission.name, plan, records, problems)
        folder.mkdir(parents=True, exist_ok=True)
        report.write(result, plan, records, folder)
        _keep_bags(result, Path(work), folder)
    return result


def _keep_bags(result: Grade, work: Path, folder: Path) -> None:
    for line in result.lines:
        bag = work / line.part / f"{line.part}-{line.scenario}.bag"
        if line.failure is not None and bag.is_file():
            shutil.copyfile(bag, folder / bag.name)
