"""The command line of a node."""

import sys

import pytest

from aro_robocop_goto_as.ros.node_main import answer_help


def test_unknown_option_is_refused_and_arguments_of_ros_are_not(monkeypatch):
    monkeypatch.setattr(sys, "argv", ["/ws/robocop_sim.py", "__name:=x", "_spawn:=-1 0", "--hlp"])
    with pytest.raises(SystemExit) as refused:
        answer_help("The simulator.")
    assert refused.value.code == "robocop_sim.py: there is no option --hlp; there is: --help"
    sys.argv.pop()
    answer_help("The simulator.")
