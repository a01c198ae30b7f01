"""Results of a class are stored, each in a folder of its own, which is replaced only by another result."""

import shutil
from dataclasses import replace

import pytest
from grading_records import CANCEL, PLAN, keep

from aro_robocop_goto_as.errors import ParameterError
from robocop_grading.classroom.results import Results


def test_stored_result_is_valid_until_hand_in_or_plan_change(tmp_path):
    results = Results(tmp_path, PLAN)
    hand_in = "anna", "digest of anna"
    assert not results.has(*hand_in)
    keep(results, "anna")
    assert results.has(*hand_in)
    assert results.read("anna").points == CANCEL
    assert not results.has("anna", "another")
    assert not Results(tmp_path, replace(PLAN, seed=1)).has(*hand_in)
    assert not Results(tmp_path, PLAN, "another version").has(*hand_in)
    keep(results, "anna", "a mistake")
    assert results.read("anna").points == 0.0


def test_folder_in_the_results_that_is_none_is_not_replaced(tmp_path):
    (tmp_path / "anna").mkdir()
    (tmp_path / "anna" / "notes.txt").write_text("of the teacher")
    with pytest.raises(ParameterError, match="anna has other files in it"):
        keep(Results(tmp_path, PLAN), "anna")
    assert [path.name for path in tmp_path.rglob("*")] == ["anna", "notes.txt"]


def test_incomplete_result_is_ignored_and_removed(tmp_path):
    results = Results(tmp_path, PLAN)
    keep(results, "anna")
    (tmp_path / "anna" / "hand_in.json").write_text("{")
    assert not results.has("anna", "digest of anna")
    shutil.copytree(tmp_path / "anna", tmp_path / ".new-anna")
    Results(tmp_path, PLAN)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["anna"]
