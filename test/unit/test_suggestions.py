"""What is suggested for a mistyped word."""

import pytest

from aro_robocop_goto_as.suggestions import did_you_mean


@pytest.mark.parametrize(
    "word, meant",
    [("stag_1", "; did you mean stage_1?"), ("burgr", ""), ("", ""), ("stage_1", "; did you mean stage_1?")],
)
def test_the_nearest_word_is_suggested_if_it_is_near(word, meant):
    assert did_you_mean(word, ["stage_1", "empty"]) == meant


def test_the_form_of_the_suggestion_can_be_chosen():
    assert did_you_mean("cuont", ["count"], "'{}'") == "; did you mean 'count'?"
