"""The page of a report: the mistakes, then the failures, then what passed; each row leads to its plot."""

import re
import shlex
from dataclasses import replace
from html import unescape
from pathlib import Path

import pytest
from grading_records import PLAN, RIGHT, changed, graded
from support import ROOT

from robocop_grading.cli import in_short
from robocop_grading.judge import judge
from robocop_grading.record import Record
from robocop_grading.report import write as report

MOVING = replace(RIGHT, samples=tuple(replace(sample, v=0.2) for sample in RIGHT.samples))
STUCK = changed(results=(), problem="the robot made no progress for 8 s, and the goal did not end")


def written(folder, *records, moves=False, all_plots=False):
    """The report of a server that left these records."""
    by_name = {"server": {record.name: record for record in records}}
    grade = judge("<anna>", PLAN, by_name, {})
    report.write(grade, PLAN, by_name, folder, moves, all_plots)
    return grade, (folder / "report.html").read_text()


def test_report_begins_with_each_mistake_beside_its_picture_and_folds_what_passed(tmp_path):
    _, html = written(tmp_path, MOVING)
    assert "name='viewport'" in html and "<anna>" not in html
    mistake = html[html.index("<section") : html.index("</section>")]
    assert "The robot kept moving" in mistake and mistake.count("<svg") == 1
    folded = re.findall("<details><summary>(.*?)</summary>", html[html.index("</section>") :], re.DOTALL)
    assert [re.sub("<[^>]*>", "", it).split(",")[0].split(" ", 1)[1] for it in folded][-1] == "passed"
    assert html.count("<svg") == 6, "and the five plots of the scenario"


def test_scenarios_in_which_every_check_passed_have_plots_only_if_all_are_asked_for(tmp_path):
    assert "<svg" not in written(tmp_path, RIGHT)[1]
    assert written(tmp_path, RIGHT, all_plots=True)[1].count("<svg") == 5


@pytest.fixture
def no_plots(monkeypatch):
    """Reports without plots, which take seconds."""
    monkeypatch.setattr(report, "_plot", lambda *_: "")


@pytest.mark.usefixtures("no_plots")
def test_what_follows_from_a_mistake_is_one_line_below_it(tmp_path):
    grade, html = written(tmp_path, STUCK, replace(STUCK, name="odd_scan"))
    (mistake,) = [it for it in grade.mistakes if "odd_scans" in {check.name for check in it.followers}]
    assert html.count(mistake.consequences) == 1 and "This follows from" not in html
    assert "failed because of it: " in mistake.consequences and "odd_scans" in mistake.consequences


def test_terminal_has_each_mistake_with_its_cost_and_what_was_seen_the_problems_and_the_points():
    grade = replace(graded(MOVING), notes=("a note",), problems=("server: a \x1b[31mproblem",))
    mistake, seen, *others, problem, notes, points = in_short(grade)
    assert re.match(r"stands_at_end costs [\d.]+ points?: The robot kept moving", mistake)
    assert seen.startswith("    Expected ") and seen.endswith('s of scenario "left"')
    assert others and all(it.startswith("not reached: ") for it in others)
    assert (problem, notes) == ("problem: server: a  [31mproblem", "notes, which cost no points: 1, in the report")
    assert points == f"anna: {grade.words}"


@pytest.mark.usefixtures("no_plots")
@pytest.mark.parametrize("moves", [False, True])
def test_command_that_shows_a_scenario_works_from_anywhere_and_names_no_path_of_somebody_else(tmp_path, moves):
    (tmp_path / "server-left.bag").write_bytes(b"")
    _, html = written(tmp_path, MOVING, moves=moves)
    commands = [shlex.split(unescape(it)) for it in re.findall("<code>([^<]+)</code>", html)]
    program, bag = str(Path(ROOT, "robocop")), str(tmp_path / "server-left.bag")
    expected = ["./robocop", "replay", "server-left.bag"] if moves else [program, "replay", bag]
    assert [command[:3] for command in commands] == [expected] * 2
    assert moves != (str(tmp_path) in html)
    assert [command[3:] for command in commands] == [["--start", "10.0"], []], "a second before the mistake"


def test_scenario_in_which_nothing_happened_is_not_replayed(tmp_path):
    (tmp_path / "server-start.bag").write_bytes(b"")
    _, html = written(tmp_path, Record("start", "server", up=False))
    assert "replay" not in html


def test_folder_of_the_report_is_made_with_those_above_it(tmp_path):
    assert (report.make_report_folder(tmp_path / "a" / "b", "stamp") / "stamp").is_file()


def test_every_report_says_which_files_were_graded(tmp_path):
    file = "server: scripts/robocop_goto_as.py; not graded: backup/robocop_goto_as.py"
    grade = replace(judge("anna", PLAN, {"server": {"left": RIGHT}}, {}), files=(file,))
    report.write(grade, PLAN, {"server": {"left": RIGHT}}, tmp_path)
    for name in ("report.html", "report.json", "results.json"):
        assert file in (tmp_path / name).read_text(), name
