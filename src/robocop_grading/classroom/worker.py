"""Grades one hand-in of a class and stores its report; run by dask's workers."""

import traceback
from dataclasses import replace
from pathlib import Path
from typing import Tuple

from aro_robocop_goto_as.errors import RobocopError
from robocop_hosting.tree import temporary_folder
from robocop_hosting.workspace import places

from .. import faults
from ..errors import UngradableError
from ..files.packing import pack
from ..grader import grade
from ..grades import Grade
from ..plan import Plan
from ..preparation import prepare
from ..report.write import write
from ..runner import Runner
from ..sandbox.bubblewrap import open_sandbox
from .hand_ins import entries_of
from .results import Results


def work(path: Path, plan: Plan, results: Results, unsafe: bool) -> None:
    """Grade one hand-in; its mistakes go into its report, and an error that is not its fault is raised."""
    state, share = places()
    sandbox = open_sandbox(unsafe, [state / "venv", state / "compat"])
    digest, name = "", path.name.encode("utf-8", "replace").decode()
    with temporary_folder("robocop-class-") as top:
        report = top / "report"
        try:
            digest = pack(entries_of(path), top / "hand_in.tar")
            submission = replace(prepare(top / "hand_in.tar", share, state, sandbox), name=name)
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
            problem = problem.replace(f"{top}/", "")
            write(Grade(name, (), (problem,), tracebacks=tracebacks), plan, {}, report)
        results.keep(path.name, digest, report)
