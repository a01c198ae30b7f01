"""The X server that DISPLAY names."""

import pytest
from command import x_server

from aro_robocop_goto_as import x_display


def test_a_server_answers(monkeypatch):
    with x_server() as display:
        monkeypatch.setenv("DISPLAY", display)
        assert x_display.answers()


@pytest.mark.parametrize("display", ["", ":4711"])
def test_without_a_server_none_answers(monkeypatch, display):
    monkeypatch.setenv("DISPLAY", display)
    assert not x_display.answers()
