"""The overview of a class: a row for each hand-in; for each check its outcomes and the most frequent causes."""

import re

from grading_records import GROUP, PLAN, keep

from robocop_grading.classroom.overview import page
from robocop_grading.classroom.results import Results
from robocop_grading.classroom.summary import Summary
from robocop_grading.files.exports import Person
from robocop_grading.grades import Grade

FIGURES = Summary((0.5, 0.0), 1, 8.0)


def test_it_counts_checks_and_causes_and_escapes_them():
    html = page("class <1>", GROUP, PLAN, FIGURES, {"dora": "not graded yet"})
    assert "2 judged, 1 not gradable<" in html and "mean 0.25, median 0.25 of 8 points" in html
    assert "2 × &lt;cause&gt; at 1.5" in html and "<cause>" not in html and "<1>" not in html
    assert "0 of 2" in html, "of the two that handed in a server"
    assert re.search("<td class=not>dora<td [^>]*>not graded yet", html)
    assert re.search("carl</a>\\s*<td [^>]*>not gradable\\s*<td><span class=failed>nothing to grade<", html)
    assert "http" not in html and "<script" not in html


def test_it_counts_no_cause_of_a_failure_that_follows_from_another_one(tmp_path):
    results = Results(tmp_path, PLAN)
    keep(results, "anna", "a mistake")
    keep(results, "ben", "another mistake", follows="reaches_goal")
    html = page("class", [results.read("anna"), results.read("ben")], PLAN, FIGURES)
    assert "1 × a mistake" in html and "another mistake" not in html
    assert "0 of 2" in html, "of cancel, as stored"


def test_advice_is_told_apart_from_problems_and_no_text_ends_in_the_middle_of_a_word():
    advised = Grade("anna", GROUP[0].checks, ("bridge: robocop_rviz " * 40,), ("line 7: use rospy.Rate",))
    html = page("class", [advised], PLAN, FIGURES)
    (problems,) = re.findall("<span class=failed>(.*?)</span>", html)
    assert len(problems) <= 304 and problems.endswith(" robocop_rviz ...")
    assert re.search("class=note><summary>1 note</summary>.*line 7: use rospy.Rate", html)


def test_it_names_people_by_their_full_names():
    html = page("class", GROUP[1:], PLAN, FIGURES, people={"ben": Person("", "Benjamin <B>")})
    assert "<a href='ben/report.html'>Benjamin &lt;B&gt;</a><br><small>ben</small>" in html
    assert re.search("<a href='carl/report.html'>carl</a>\\s*<td", html)
