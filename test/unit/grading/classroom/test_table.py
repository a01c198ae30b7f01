"""The table of a class: a row for each hand-in, which spreadsheets read as it is, and Moodle and Gradescope import."""

import csv
import io
from dataclasses import replace

from grading_records import GROUP, PLAN
from hypothesis import given
from hypothesis import strategies as st

from robocop_grading.classroom.table import table
from robocop_grading.files.exports import Person
from robocop_grading.grades import Grade


def read(text):
    """The rows of a table that starts with a byte order mark."""
    assert text[0] == "\ufeff"
    return list(csv.DictReader(io.StringIO(text[1:])))


def test_table_has_one_row_per_hand_in_and_no_spreadsheet_formulas():
    rows = read(table(GROUP, PLAN, {"dora": "a worker died"}))
    columns = {key: [row[key] for row in rows] for key in rows[0]}
    assert columns["name"] == ["'=anna", "ben", "carl", "dora"]
    assert columns["points"] == ["0.5", "0.0", "", ""] and columns["extra"] == ["1.0", "0.0", "", ""]
    assert columns["of"] == [str(PLAN.points)] * 4
    assert columns["server"] == ["0.5", "0.0", "", ""]
    assert columns["bridge"] == ["0.0", "not handed in", "", ""], "without the extra point"
    assert columns["cancel"] == ["failed", "failed", "", ""]
    assert columns["problem"] == ["", "'=cmd", "nothing to grade", "a worker died"]


def test_table_has_what_moodle_and_gradescope_import_where_they_say_who_handed_in():
    people = {"=anna": Person("Participant 7", "Anna Nováková"), "dora": Person("", "Dora", "d@example.edu", "-42")}
    rows = read(table(GROUP, PLAN, {"dora": "a worker died"}, people))
    imported = [[row[key] for key in ("Identifier", "Full name", "Email", "SID", "Grade")] for row in rows]
    assert {row["Last modified (grade)"] for row in rows} == {"-"}, "Moodle's importer needs this column"
    assert imported[0] == ["Participant 7", "Anna Nováková", "", "", "0.5"]
    assert imported[1:] == [["", "", "", "", "0.0"], [""] * 5, ["", "Dora", "d@example.edu", "'-42", ""]]
    assert "Grade" not in read(table(GROUP, PLAN))[0]


def test_notes_and_problems_have_columns_of_their_own():
    (row,) = read(table([replace(GROUP[1], problems=("a .rar file",), notes=("line 7: use rospy.Rate",))], PLAN))
    assert (row["problem"], row["notes"]) == ("a .rar file", "line 7: use rospy.Rate")


@given(st.text(), st.text())
def test_no_name_or_problem_controls_a_spreadsheet_whatever_separator_it_is_read_with(name, problem):
    text = table([Grade(name, (), (problem,))], PLAN, {name: problem})
    assert len(read(text)) == 2
    for separator in ",;\t":
        for row in csv.reader(io.StringIO(text[1:]), delimiter=separator):
            for cell in row:
                assert cell.isprintable()
                assert not cell.lstrip(" '\"").startswith(("=", "+", "@", "\uff1d")) or cell.startswith("'")
