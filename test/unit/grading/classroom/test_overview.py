"""The page of a class counts outcomes and causes."""

from class_records import PLAN, RESULTS

from robocop_grading.classroom import overview


def test_the_overview_counts_checks_and_causes_and_escapes_them():
    html = overview.page("class <1>", RESULTS, PLAN, {"dora": "waiting"}, running=True)
    assert "3 of 4 graded, in progress" in html and "http-equiv='refresh'" in html
    assert "2 × &lt;cause&gt; at 1.5" in html and "<cause>" not in html and "<1>" not in html
    assert "0 of 2" in html, "of the two that handed in a server"
    assert "dora" in html
    assert "interrupted" in overview.page("class", RESULTS, PLAN, {"dora": "waiting"}, running=False)
    assert "http" not in overview.page("class", RESULTS, PLAN, {}, running=False)
