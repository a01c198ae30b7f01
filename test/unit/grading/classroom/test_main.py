"""The seed of a class; who is graded again; what is told meanwhile."""

import time

import pytest
from grading_records import PLAN, keep, keep_grade

from robocop_grading.classroom.main import Gradebook, class_seed, to_regrade
from robocop_grading.classroom.results import Results
from robocop_grading.errors import GradingSetupError
from robocop_grading.grades import Grade
from robocop_grading.plan_file import MAX_SEED


@pytest.mark.parametrize("used", [0, 7])
def test_class_keeps_its_seed_unless_another_one_is_given(used, tmp_path):
    keep(Results(tmp_path, {"seed": used}), "anna", 0.2)
    assert class_seed(None, tmp_path) == used
    assert class_seed(3, tmp_path) == 3


def test_new_class_gets_a_seed_that_draws(tmp_path):
    assert 1 <= class_seed(None, tmp_path / "not there yet") <= MAX_SEED


@pytest.fixture
def group(tmp_path):
    """A class of four: Anna is judged, Ben is not gradable, the others have no result yet."""
    hand_ins = {name: f"digest of {name}" for name in ("anna", "ben", "carl.zip", "řehoř")}
    results = Results(tmp_path, {})
    keep(results, "anna", 0.5)
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
    keep(made.results, "carl.zip", 8.0)
    line = made.add("carl.zip", "")
    assert line == "[3/4] carl.zip: 8 of 1 points, 3 s; 1.0 a minute, about 2 min left"
    assert made.add("řehoř", "no grade: the machine had no time") == "řehoř: no grade: the machine had no time"
    lines = made.summary_lines()
    assert lines[:2] == ["2 judged, 2 not gradable", "mean 4.25, median 4.25 of 8 points"]
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
    keep(made.results, "řehoř", 8.0)
    made.add("řehoř", "")
    assert made.pace == ""
    made.waiting["anna"] = "a digest"
    assert made.pace.endswith(" a minute, about 1 min left")
