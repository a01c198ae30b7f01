"""The seed of a class, also when it is graded twice at a time."""

import subprocess
import sys

import pytest
from class_records import report

from robocop_grading.classroom import main as classroom
from robocop_grading.classroom.main import class_seed
from robocop_grading.classroom.results import Results
from robocop_grading.hosting.workspace import exclusive
from robocop_grading.plan import LARGEST_SEED


@pytest.mark.parametrize("used", [0, 7])
def test_class_keeps_its_seed_unless_another_one_is_given(used, tmp_path):
    Results(tmp_path, {"seed": used}).keep(report("anna", 0.2))
    assert class_seed(None, tmp_path) == used
    assert class_seed(3, tmp_path) == 3


def test_gradings_of_a_new_class_at_the_same_time_share_a_seed(tmp_path):
    (tmp_path / "class").mkdir()
    (tmp_path / "class" / "anna.py").write_text("one")
    out = tmp_path / "out"
    code = f"from {classroom.__name__} import main; main()"
    command = [sys.executable, "-u", "-c", code, tmp_path / "class", "--report", out]
    with exclusive(out / ".run"):  # the first one is running
        second = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        assert "waiting for another process" in second.stderr.readline()
        Results(out, {"seed": 4711}).keep(report("anna", 0.2))
    try:
        assert [second.stdout.readline() for _ in range(2)][1] == "scenarios: seed 4711\n"
    finally:
        second.kill()
        second.communicate()


def test_new_class_gets_a_seed_that_draws(tmp_path):
    assert 1 <= class_seed(None, tmp_path / "not there yet") <= LARGEST_SEED
