"""The plan and the seed of a class; who is graded again; what is told meanwhile."""

import re
import shutil
import time
from argparse import Namespace
from pathlib import Path

import pytest
from grading_records import CANCEL, PLAN, PLAN_FILE, keep, keep_grade
from support import ROOT

from robocop_grading.classroom import main
from robocop_grading.classroom.main import Gradebook
from robocop_grading.classroom.results import Results
from robocop_grading.errors import GradingSetupError
from robocop_grading.grades import Grade
from robocop_grading.plan_file import MAX_SEED


@pytest.fixture
def grade_class(folder, monkeypatch):
    """Grades a class without running anything; the names that are graded, and the gradebook."""

    def run(hand_ins=folder, report=None, plan=None, seed=None, **options):
        ran = []

        def stand_in(gradebook, *_):
            for name in list(gradebook.waiting):
                keep(gradebook.results, name, digest=gradebook.waiting[name])
                ran.append(name)
                gradebook.add(name, "")
            gradebook.write()

        monkeypatch.setenv("ROBOCOP_STATE", str(folder.parent / "state"))
        monkeypatch.setenv("ROBOCOP_SHARE", ROOT)
        monkeypatch.setattr(main, "grade_waiting", stand_in)
        monkeypatch.setattr(main, "build_environments", lambda *_: None)
        given = {"folder": str(hand_ins), "report": report, "plan": plan and str(plan), "seed": seed}
        gradebook = main.grade_class(Namespace(**{"workers": 1, "scheduler": "", "unsafe": True, **given, **options}))
        return ran, gradebook

    return run


@pytest.fixture
def other_points(tmp_path):
    """The plan with 0.5 points for one check."""
    path = tmp_path / "my_plan.yaml"
    path.write_text(re.sub(r"cancel: +{points: [\d.]+", "cancel: {points: 0.5", PLAN_FILE.read_text()))
    return path


@pytest.fixture
def other_limits(tmp_path):
    """The plan with another limit."""
    path = tmp_path / "strict.yaml"
    path.write_text(PLAN_FILE.read_text().replace("  #reached: 0.12", "  reached: 0.11"))
    return path


def test_class_keeps_its_seed_and_its_plan(folder, grade_class, other_points):
    ran, first = grade_class(plan=other_points)
    assert ran and 1 <= first.plan.seed <= MAX_SEED
    other_points.unlink()
    shutil.rmtree(first.results.folder / "anna")
    ran, again = grade_class()
    assert (ran, again.plan.seed) == (["anna"], first.plan.seed)
    assert again.plan.points == first.plan.points == pytest.approx(PLAN.points + 0.5 - CANCEL)


def test_other_points_are_summed_anew_without_another_run(folder, grade_class, other_points):
    _, before = grade_class()
    ran, after = grade_class(plan=other_points)
    assert not ran and (before.done["anna"].points, after.done["anna"].points) == (CANCEL, 0.5)
    assert f",0.5,{after.plan.points}," in (after.results.folder / "grades.csv").read_text(), "points, of"


def test_another_plan_or_seed_than_that_of_the_results_is_refused(grade_class, other_limits):
    grade_class(seed=7)
    for changed in ({"plan": other_limits}, {"seed": 8}):
        with pytest.raises(
            GradingSetupError, match=r"results/\.plan\.yaml and seed 7: another one may differ in points only"
        ):
            grade_class(**changed)
    assert grade_class()[0] == []


def test_classes_in_folders_of_the_same_name_have_results_and_seeds_of_their_own(folder, grade_class):
    tuesday = folder.parent / "tuesday" / folder.name
    tuesday.mkdir(parents=True)
    (tuesday / "anna.py").touch()
    _, first = grade_class(seed=7)
    ran, second = grade_class(tuesday)
    assert first.results.folder == Path(f"{folder}_results") and second.results.folder == Path(f"{tuesday}_results")
    assert ran == ["anna.py"] and (second.results.folder / ".robocop_class").read_text() == f"{second.plan.seed}\n"


def test_results_of_another_class_are_not_replaced(folder, grade_class):
    _, first = grade_class()
    tuesday = folder.parent / "tuesday"
    tuesday.mkdir()
    (tuesday / "carl.py").touch()
    table = (first.results.folder / "grades.csv").read_text()
    with pytest.raises(GradingSetupError, match="has results of other hand-ins, such as anna: give another folder"):
        grade_class(tuesday, report=str(first.results.folder))
    assert (first.results.folder / "grades.csv").read_text() == table
    (tuesday / "anna").mkdir()  # a later export of the same class
    (tuesday / "anna" / "robocop_goto_as.py").touch()
    assert grade_class(tuesday, report=str(first.results.folder))[0] == ["anna", "carl.py"]


def test_scheduler_without_tls_is_refused(grade_class):
    with pytest.raises(GradingSetupError, match="--scheduler tcp://127.0.0.1:1: expected tls://HOST:PORT"):
        grade_class(scheduler="tcp://127.0.0.1:1")


@pytest.fixture
def group(tmp_path):
    """A class of four: Anna is judged, Ben is not gradable, the others have no result yet."""
    hand_ins = {name: f"digest of {name}" for name in ("anna", "ben", "carl.zip", "řehoř")}
    results = Results(tmp_path, PLAN)
    keep(results, "anna")
    keep_grade(results, Grade("ben", (), ("ben.rar: a .rar file",)))
    return Gradebook(tmp_path, results, PLAN, hand_ins)


def test_class_says_how_fast_it_is_and_who_is_not_gradable_and_why(group, monkeypatch):
    monkeypatch.setattr(group, "_started", time.monotonic() - 60.0)
    keep(group.results, "carl.zip")
    line = group.add("carl.zip", "")
    assert line == f"[3/4] carl.zip: {CANCEL:g} of {CANCEL:g} points; 1.0 a minute, about 2 min left"
    assert group.add("řehoř", "no grade: the machine had no time") == "řehoř: no grade: the machine had no time"
    lines = group.summary_lines()
    averages = f"mean {CANCEL:.2f}, median {CANCEL:g} of {PLAN.points:g} points"
    assert lines[:2] == ["2 judged, 2 not gradable", averages]
    assert lines[-2:] == [
        "not gradable: ben: ben.rar: a .rar file",
        "not gradable: řehoř: no grade: the machine had no time",
    ]
    assert group.figures.not_judged == 2


def test_time_left_is_estimated_from_hand_ins_that_ran(group, monkeypatch):
    monkeypatch.setattr(group, "_started", time.monotonic() - 30.0)
    keep_grade(group.results, Grade("carl.zip", (), ("no Python file in it",)))
    group.add("carl.zip", "")
    assert group.pace == "", "what can't be graded takes no time"
    keep(group.results, "řehoř")
    group.add("řehoř", "")
    group.waiting["dora"] = ""  # it can't be read
    assert group.pace == ""
    group.waiting["eva"] = "a digest"
    assert group.pace.endswith(" a minute, about 1 min left")
