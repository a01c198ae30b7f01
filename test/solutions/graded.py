"""Grades the solutions in this folder like a student's file."""

import os
from pathlib import Path
from typing import Callable, Sequence

from robocop_grading import judge
from robocop_grading.grades import Grade
from robocop_grading.plan_file import load
from robocop_grading.runner import BUDGET, Recorded, Runner
from robocop_grading.sandbox.bubblewrap import Sandbox, open_sandbox
from robocop_grading.submission import prepare_submission

STATE, SHARE = Path(os.environ["ROBOCOP_STATE"]), Path(os.environ["ROBOCOP_SHARE"])
PLAN = SHARE / "config" / "grading.yaml"


def sandbox() -> Sandbox:
    """The sandbox that solutions run in; GradingError says why this machine can't have one."""
    opened = open_sandbox(False, [STATE / "venv", STATE / "compat"])
    assert opened is not None
    return opened


def recorded(
    text: str,
    folder: Path,
    only: Sequence[str] = (),  # checks
    budget: float = BUDGET,
    seed: int = 0,
    on_progress: Callable[[str], None] = lambda _scenario: None,
) -> Recorded:
    """A solution driven through the scenarios of its part, or some of them, in the sandbox."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "solution.py").write_text(text)
    opened = sandbox()
    submission = prepare_submission(str(folder / "solution.py"), SHARE, STATE, folder, opened)
    script, plan = submission.scripts[0], load(PLAN, seed).restricted(only)
    chosen = Runner(plan, STATE, opened, lambda _part, scenario: on_progress(scenario), budget)
    return chosen.run(submission, script, folder / "out")


def graded(name: str, text: str, folder: Path, seed: int = 0, only: Sequence[str] = ()) -> Grade:
    """The grade of a solution, or of what some checks need."""
    return judged(name, recorded(text, folder, only, seed=seed), seed, only)


def judged(name: str, run: Recorded, seed: int = 0, only: Sequence[str] = ()) -> Grade:
    """The grade of a solution that was driven."""
    part = "bridge" if "no_server" in run.records else "server"
    return judge.judge(name, load(PLAN, seed).restricted(only), {part: run.records}, {part: run.problem})
