"""Grades one hand-in of a class and stores its report; run by dask's workers."""

import traceback
from dataclasses import replace
from pathlib import Path
from typing import List, Tuple

from aro_robocop_goto_as.errors import RobocopError
from robocop_hosting.tree import temporary_folder
from robocop_hosting.workspace import places

from .. import faults
from ..errors import UngradableError
from ..grader import grade
from ..grades import Grade
from ..plan import Plan
from ..report.write import write
from ..runner import Runner
from ..sandbox.bubblewrap import open_sandbox
from ..submission import prepare_submission
from .hand_ins import unpacked
from .results import Results


def work(path: Path, plan: Plan, results: Results, unsafe: bool) -> None:
    """Grade one hand-in; its mistakes go into its report, and an error that is not its fault is raised."""
    state, share = places()
    sandbox = open_sandbox(unsafe, [state / "venv", state / "compat"])
    digest, name = "", path.name.encode("utf-8", "replace").decode()
    notes: List[str] = []  # about what is not used of it
    with temporary_folder("robocop-class-") as top:
        report = top / "report"
        try:
            handed_in = unpacked(path)
            digest, notes = handed_in.digest, handed_in.notes
            handed_in.write(top / "hand_in" / path.name)
            submission = prepare_submission(str(top / "hand_in" / path.name), share, state, top / "workshop", sandbox)
            submission = replace(submission, name=name, notes=[*submission.notes, *notes])
            grade(Runner(plan, state, sandbox), submission, report, moves=True)
        except UngradableError:
            raise
        except Exception as error:  # a hand-in that breaks the grader affects only its own row
            report.mkdir(exist_ok=True)
            problem = str(error)
            tracebacks: Tuple[str, ...] = ()
            if not isinstance(error, RobocopError):
                problem = f"could not be graded, see {faults.FILE}: {error!r}"
                tracebacks = (traceback.format_exc(),)
            problem = problem.replace(f"{top / 'hand_in'}/", "").replace(f"{top}/", "")
            write(Grade(name, (), (problem,), tuple(notes), tracebacks=tracebacks), plan, {}, report)
        results.keep(path.name, digest, report)
