"""The plan and the seed of a class; who is graded again; what is told meanwhile."""

import time
from argparse import Namespace
from pathlib import Path

import pytest
from grading_records import PLAN, PLAN_FILE, keep, keep_grade
from support import ROOT

from robocop_grading.classroom import main
from robocop_grading.classroom.main import Gradebook, to_regrade
from robocop_grading.classroom.results import Results
from robocop_grading.errors import GradingSetupError
from robocop_grading.grades import Grade
from robocop_grading.plan_file import MAX_SEED


@pytest.fixture
def grade_class(folder, monkeypatch):
    """Grades a class without running anything; the names that are graded, and the gradebook."""

    def run(hand_ins=folder, report=None, plan=None, seed=None, again=None, **options):
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
        monkeypatch.setattr(main, "lab_environment", lambda *_: None)
        given = {"folder": str(hand_ins), "report": report, "plan": plan and str(plan), "seed": seed, "again": again}
        gradebook = main.grade_class(Namespace(**{"workers": 1, "scheduler": "", "unsafe": True, **given, **options}))
        return ran, gradebook

    return run


@pytest.fixture
def other_points(tmp_path):
    """The plan with 0.5 points for one check."""
    path = tmp_path / "my_plan.yaml"
    path.write_text(PLAN_FILE.read_text().replace("cancel:            {points: 0.2", "cancel: {points: 0.5"))
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
    ran, again = grade_class(again=["anna"])
    assert (ran, again.plan.seed) == (["anna"], first.plan.seed)
    assert again.plan.points == first.plan.points == PLAN.points + 0.3


def test_other_points_are_summed_anew_without_another_run(folder, grade_class, other_points, capsys):
    _, before = grade_class()
    ran, after = grade_class(plan=other_points)
    assert not ran and after.done["anna"].points == before.done["anna"].points + 0.3 == 0.5
    assert ",0.5,8.3," in (after.results.folder / "grades.csv").read_text(), "points, of"
    assert "the table and the overview have the new ones, reports the old ones until --again" in capsys.readouterr().out


def test_another_plan_or_seed_than_that_of_the_results_is_refused_and_graded_for_everybody_only_on_request(
    folder, grade_class, other_limits
):
    first, gradebook = grade_class(seed=7)
    for changed in ({"plan": other_limits}, {"seed": 8}, {"seed": 8, "again": ["anna"]}):
        with pytest.raises(
            GradingSetupError, match=r"results/\.plan\.yaml and seed 7: another one may differ in points only"
        ):
            grade_class(**changed)
    assert grade_class()[0] == []
    ran, changed = grade_class(plan=other_limits, seed=8, again=[])
    assert ran == first and changed.plan.seed == 8 and grade_class()[0] == []


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

    def make(again=()):
        return Gradebook(tmp_path, results, PLAN, hand_ins, to_regrade(again, hand_ins) if again != () else ())

    return make


def test_hand_in_is_graded_again_by_its_name_and_is_the_first_one(group):
    assert list(group().waiting) == ["carl.zip", "řehoř"]
    assert list(group(["anna"]).waiting) == ["anna", "carl.zip", "řehoř"]
    assert list(group(["class/řehoř/"]).waiting) == ["řehoř", "carl.zip"], "as a shell completes it"
    assert list(group([]).waiting) == ["anna", "ben", "carl.zip", "řehoř"]
    assert list(group(None).waiting) == ["carl.zip", "řehoř"]


@pytest.mark.parametrize(
    "name, advice", [("ana", "; did you mean anna?"), ("carl", "; did you mean carl.zip?"), ("x", "")]
)
def test_unknown_name_is_refused(name, advice, group):
    with pytest.raises(GradingSetupError) as error:
        group([name])
    assert str(error.value) == f"--again {name}: no hand-in of this name{advice}"


def test_class_says_how_fast_it_is_and_who_is_not_gradable_and_why(group, monkeypatch):
    made = group()
    monkeypatch.setattr(made, "_started", time.monotonic() - 60.0)
    keep(made.results, "carl.zip")
    line = made.add("carl.zip", "")
    assert line == "[3/4] carl.zip: 0.2 of 0.2 points, 3 s; 1.0 a minute, about 2 min left"
    assert made.add("řehoř", "no grade: the machine had no time") == "řehoř: no grade: the machine had no time"
    lines = made.summary_lines()
    assert lines[:2] == ["2 judged, 2 not gradable", "mean 0.20, median 0.2 of 8 points"]
    assert lines[-2:] == [
        "not gradable: ben: ben.rar: a .rar file",
        "not gradable: řehoř: no grade: the machine had no time",
    ]
    assert made.figures.not_judged == 2


def test_time_left_is_estimated_from_hand_ins_that_ran(group, monkeypatch):
    made = group(["ben"])
    monkeypatch.setattr(made, "_started", time.monotonic() - 30.0)
    made.add("ben", "")
    assert made.pace == "", "what can't be graded takes no time"
    made.waiting["carl.zip"] = ""  # it can't be read
    keep(made.results, "řehoř")
    made.add("řehoř", "")
    assert made.pace == ""
    made.waiting["anna"] = "a digest"
    assert made.pace.endswith(" a minute, about 1 min left")
