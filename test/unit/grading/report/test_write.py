"""The page of a report: the mistakes, then the failures, then what passed; each row leads to its plot."""

import re
from dataclasses import replace

import pytest
from grading_records import PLAN, RIGHT

from robocop_grading.cli import as_text
from robocop_grading.judge import judge
from robocop_grading.report import write as report


def test_report_begins_with_the_mistakes_and_links_each_row_to_its_plot(tmp_path):
    moving = replace(RIGHT, samples=tuple(replace(sample, v=0.2) for sample in RIGHT.samples))
    records = {"server": {"left": moving}}
    grade = judge("<anna>", PLAN, records, {})
    report.write(grade, PLAN, records, tmp_path)
    html = (tmp_path / "report.html").read_text()
    assert "name='viewport'" in html and "<anna>" not in html
    begin, failed, passed = (html.index(text) for text in ("What to fix", ">failed: ", "'>passed<"))
    assert begin < html.index("The robot kept moving") < failed < passed
    not_reached = html.index("not reached, ")
    assert html.rindex("<details>", 0, not_reached) > passed, "folded"
    targets = set(re.findall("href='#([^']+)'", html))
    assert targets and all(f"id='{target}'" in html for target in targets)
    rows = html[html.index("<table>") : html.index("</table>")]
    assert rows.count("<a href='#") == rows.count("<tr><td>") > 5


@pytest.mark.parametrize("kept", [True, False])
def test_report_names_a_bag_by_its_path_only_if_it_stays_there(tmp_path, kept):
    (tmp_path / "server-left.bag").write_bytes(b"")
    records = {"server": {"left": RIGHT}}
    report.write(judge("anna", PLAN, records, {}), PLAN, records, tmp_path, kept)
    (command,) = re.findall(r"\./robocop replay ([^<]+)</code>", (tmp_path / "report.html").read_text())
    assert command == (str(tmp_path / "server-left.bag") if kept else "server-left.bag")


def test_folder_of_the_report_is_made_with_those_above_it(tmp_path):
    assert report.make_report_folder(tmp_path / "a" / "b").is_dir()


def test_every_report_and_the_terminal_say_which_files_were_graded(tmp_path):
    file = "server: scripts/robocop_goto_as.py; not graded: backup/robocop_goto_as.py"
    grade = replace(judge("anna", PLAN, {"server": {"left": RIGHT}}, {}), files=(file,))
    report.write(grade, PLAN, {"server": {"left": RIGHT}}, tmp_path)
    for name in ("report.html", "summary.md", "report.json", "results.json"):
        assert file in (tmp_path / name).read_text(), name
    assert f"graded: {file}" in as_text(grade, {}).splitlines()
