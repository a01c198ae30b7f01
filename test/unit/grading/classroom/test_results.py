"""Results of a class are stored, and listed in a table and on a page, which counts outcomes and causes."""

import csv
import io
import re
import shutil
from dataclasses import replace

import pytest
from grading_records import PLAN, judged, keep
from hypothesis import given
from hypothesis import strategies as st

from aro_robocop_goto_as.errors import ParameterError
from robocop_grading.classroom.results import Results, StoredGrade, page
from robocop_grading.classroom.table import table
from robocop_grading.files.exports import Person

RESULTS = (
    StoredGrade(
        "=anna",
        (
            judged("cancel", "server", 0.0, "<cause> at 1.5"),
            judged("action_server", "server", 0.5),
            judged("goal_frame", "bridge", 1.0, extra=True),
        ),
    ),
    StoredGrade("ben", (judged("cancel", "server", 0.0, "<cause> at -3"),), ("=cmd",)),
    StoredGrade("carl", (), ("nothing to grade",)),
)


def test_stored_result_is_valid_until_hand_in_or_plan_change(tmp_path):
    results = Results(tmp_path, PLAN)
    hand_in = "anna", "digest of anna"
    assert not results.has(*hand_in)
    keep(results, "anna")
    assert results.has(*hand_in)
    assert results.read("anna").points == 0.2
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


def read(text):
    """The rows of a table that starts with a byte order mark."""
    assert text[0] == "\ufeff"
    return list(csv.DictReader(io.StringIO(text[1:])))


def test_table_has_one_row_per_hand_in_and_no_spreadsheet_formulas():
    rows = read(table(RESULTS, PLAN, {"dora": "a worker died"}))
    columns = {key: [row[key] for row in rows] for key in rows[0]}
    assert columns["name"] == ["'=anna", "ben", "carl", "dora"]
    assert columns["points"] == ["0.5", "0.0", "", ""] and columns["extra"] == ["1.0", "0.0", "", ""]
    assert columns["of"] == ["8.0"] * 4
    assert columns["server"] == ["0.5", "0.0", "", ""]
    assert columns["bridge"] == ["0.0", "not handed in", "", ""], "without the extra point"
    assert columns["cancel"] == ["failed", "failed", "", ""]
    assert columns["problem"] == ["", "'=cmd", "nothing to grade", "a worker died"]


def test_table_has_what_moodle_and_gradescope_import_where_they_say_who_handed_in():
    people = {"=anna": Person("Participant 7", "Anna Nováková"), "dora": Person("", "Dora", "d@example.edu", "-42")}
    rows = read(table(RESULTS, PLAN, {"dora": "a worker died"}, people))
    imported = [[row[key] for key in ("Identifier", "Full name", "Email", "SID", "Grade")] for row in rows]
    assert {row["Last modified (grade)"] for row in rows} == {"-"}, "Moodle's importer needs this column"
    assert imported[0] == ["Participant 7", "Anna Nováková", "", "", "0.5"]
    assert imported[1:] == [["", "", "", "", "0.0"], [""] * 5, ["", "Dora", "d@example.edu", "'-42", ""]]
    assert "Grade" not in read(table(RESULTS, PLAN))[0]


def test_advice_is_told_apart_from_problems_and_no_text_ends_in_the_middle_of_a_word():
    advised = StoredGrade("anna", RESULTS[0].checks, ("bridge: robocop_rviz " * 40,), ("line 7: use rospy.Rate",))
    html = page("class", [advised], PLAN, {}, running=False)
    (problems,) = re.findall("<span class=failed>(.*?)</span>", html)
    assert len(problems) <= 304 and problems.endswith(" robocop_rviz ...")
    assert re.search("class=note><summary>1 note</summary>.*line 7: use rospy.Rate", html)
    (row,) = read(table([advised], PLAN))
    assert row["notes"] == "line 7: use rospy.Rate" and "line 7" not in row["problem"]


@given(st.text(), st.text())
def test_no_name_or_problem_controls_a_spreadsheet_whatever_separator_it_is_read_with(name, problem):
    text = table([StoredGrade(name, (), (problem,))], PLAN, {name: problem})
    assert len(read(text)) == 2
    for separator in ",;\t":
        for row in csv.reader(io.StringIO(text[1:]), delimiter=separator):
            for cell in row:
                assert cell.isprintable()
                assert not cell.lstrip(" '\"").startswith(("=", "+", "@", "\uff1d")) or cell.startswith("'")


def test_the_overview_counts_no_cause_of_a_failure_that_follows_from_another_one(tmp_path):
    results = Results(tmp_path, PLAN)
    keep(results, "anna", "a mistake")
    keep(results, "ben", "another mistake", follows="reaches_goal")
    html = page("class", [results.read("anna"), results.read("ben")], PLAN, {}, running=False)
    assert "1 × a mistake" in html and "another mistake" not in html
    assert "0 of 2" in html, "of cancel, as stored"


def test_the_overview_names_people_by_their_full_names():
    html = page("class", RESULTS[1:], PLAN, {}, running=False, people={"ben": Person("", "Benjamin <B>")})
    assert "<a href='ben/report.html'>Benjamin &lt;B&gt;</a><br><small>ben</small>" in html
    assert "<a href='carl/report.html'>carl</a><td" in html


def test_the_overview_counts_checks_and_causes_and_escapes_them():
    html = page("class <1>", RESULTS, PLAN, {"dora": "waiting"}, running=True, pace="2 a minute")
    assert (
        "2 judged, 1 not gradable<" in html
        and "3 of 4 done, in progress: 2 a minute<" in html
        and "http-equiv='refresh'" in html
    )
    assert "mean 0.25, median 0.25 of 8 points" in html
    assert "2 × &lt;cause&gt; at 1.5" in html and "<cause>" not in html and "<1>" not in html
    assert "0 of 2" in html, "of the two that handed in a server"
    assert "dora" in html
    assert "interrupted" in page("class", RESULTS, PLAN, {"dora": "waiting"}, running=False)
    assert "http" not in page("class", RESULTS, PLAN, {}, running=False)
