"""The command line of a node, and its limits."""

import resource
import sys

import pytest

from aro_robocop_goto_as.ros import node_main
from aro_robocop_goto_as.ros.node_main import answer_help


def test_unknown_option_is_refused_and_arguments_of_ros_are_not(monkeypatch):
    monkeypatch.setattr(sys, "argv", ["/ws/robocop_sim.py", "__name:=x", "_spawn:=-1 0", "--hlp"])
    with pytest.raises(SystemExit) as refused:
        answer_help("The simulator.")
    assert refused.value.code == "robocop_sim.py: there is no option --hlp; there is: --help"
    sys.argv.pop()
    answer_help("The simulator.")


@pytest.mark.parametrize("granted, wanted", [(4096, 4096), (2**30, 65_536), (resource.RLIM_INFINITY, 65_536)])
def test_node_may_open_as_many_descriptors_as_the_system_allows(monkeypatch, granted, wanted):
    limits = []
    monkeypatch.setattr(resource, "getrlimit", lambda _: (1024, granted))
    monkeypatch.setattr(resource, "setrlimit", lambda *given: limits.append(given))
    node_main.raise_descriptor_limit()
    assert limits == [(resource.RLIMIT_NOFILE, (wanted, granted))]
