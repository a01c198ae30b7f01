"""The X server that DISPLAY names."""

import pytest
from command import x_server

from aro_robocop_goto_as.probes import x_display


def test_a_server_answers(monkeypatch):
    with x_server() as display:
        monkeypatch.setenv("DISPLAY", display)
        assert x_display.answers()


@pytest.mark.parametrize("display", ["", ":4711"])
def test_there_is_none_without_a_server(monkeypatch, display):
    monkeypatch.setenv("DISPLAY", display)
    assert not x_display.answers()
