"""Grades the solutions in this folder like a student's file."""

import os
from pathlib import Path

from robocop_grading import judge
from robocop_grading.files.packing import pack
from robocop_grading.plan_file import load
from robocop_grading.preparation import prepare
from robocop_grading.runner import BUDGET, Runner
from robocop_grading.sandbox.bubblewrap import open_sandbox

STATE, SHARE = Path(os.environ["ROBOCOP_STATE"]), Path(os.environ["ROBOCOP_SHARE"])
PLAN = SHARE / "config" / "grading.yaml"


def sandbox():
    """The sandbox that solutions run in; GradingError says why this machine can't have one."""
    opened = open_sandbox(False, [STATE / "venv", STATE / "compat"])
    assert opened is not None
    return opened


def prepared(path, folder, opened=None):
    """The submission at a path, by way of files in a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    pack([path], folder / "hand_in.tar")
    return prepare(folder / "hand_in.tar", SHARE, STATE, opened or sandbox())


def recorded(
    text,
    folder,
    only=(),  # checks
    budget=BUDGET,
    seed=0,
    on_progress=lambda _scenario: None,
):
    """A solution driven through the scenarios of its part, or some of them, in the sandbox."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "solution.py").write_text(text)
    opened = sandbox()
    submission = prepared(folder / "solution.py", folder, opened)
    script, plan = submission.scripts[0], load(PLAN, seed).restricted(only)
    chosen = Runner(plan, STATE, opened, lambda _part, scenario: on_progress(scenario), budget)
    return chosen.run(submission, script, folder / "out")


def graded(name, text, folder, seed=0, only=()):
    """The grade of a solution, or of what some checks need."""
    return judged(name, recorded(text, folder, only, seed=seed), seed, only)


def judged(name, run, seed=0, only=()):
    """The grade of a solution that was driven."""
    part = "bridge" if "no_server" in run.records else "server"
    return judge.judge(name, load(PLAN, seed).restricted(only), {part: run.records}, {part: run.problem})
