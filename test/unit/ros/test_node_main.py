"""The command line of a node."""

import subprocess
import sys

import pytest

from aro_robocop_goto_as.ros.client import rviz_bridge
from aro_robocop_goto_as.ros.node_main import answer_help
from aro_robocop_goto_as.ros.server import node


def test_unknown_option_is_refused_and_arguments_of_ros_are_not(monkeypatch):
    monkeypatch.setattr(sys, "argv", ["/ws/robocop_sim.py", "__name:=x", "_spawn:=-1 0", "--hlp"])
    with pytest.raises(SystemExit) as refused:
        answer_help("The simulator.")
    assert refused.value.code == "robocop_sim.py: there is no option --hlp; there is: --help"
    sys.argv.pop()
    answer_help("The simulator.")


@pytest.mark.parametrize("program, text", [(rviz_bridge, "The bridge: makes goals"), (node, "The go-to action server")])
def test_help_is_printed_without_a_ros_system(monkeypatch, capsys, program, text):
    monkeypatch.setattr(sys, "argv", ["robocop.py", "--help"])
    monkeypatch.setattr(program, "node", None)
    with pytest.raises(SystemExit):
        program.main()
    assert text in capsys.readouterr().out


def test_node_may_open_as_many_descriptors_as_the_system_allows() -> None:
    program = (
        "import resource\n"
        "from aro_robocop_goto_as.ros.node_main import raise_descriptor_limit\n"
        "hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]\n"
        "resource.setrlimit(resource.RLIMIT_NOFILE, (20, hard))\n"
        "raise_descriptor_limit()\n"
        "assert resource.getrlimit(resource.RLIMIT_NOFILE) == (min(hard, 65_536), hard)\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True)
