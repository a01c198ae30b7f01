"""The scripts that roslaunch would start, among all that a folder contains."""

import pytest
from hosted_packages import tree

from robocop_hosting.errors import HostingError
from robocop_hosting.launch_file import LaunchNode
from robocop_hosting.scripts import choose, interpreter, start_problems

SERVER = "actionlib.SimpleActionServer('robocop_goto_as')"
RAW = "Subscriber('/robocop_goto_as/goal', GoToPositionActionGoal); Publisher('x', GoToPositionActionResult)"
BRIDGE = "rospy.Subscriber('/move_base_simple/goal'); SimpleActionClient()"
CLIENT = "SimpleActionClient('robocop_goto_as')"
NAME = "robocop_goto_as.py"
BEGIN = "#!/usr/bin/env python3"


def chosen(top, *started):
    """Server and bridge, when the launch file starts these types."""
    found = choose(top, [LaunchNode("lab", name, "node", "x.launch, line 1") for name in started])
    server, bridge = (found.get(part) for part in ("server", "bridge"))
    return server and str(server.path.relative_to(top)), bridge and str(bridge.path.relative_to(top))


@pytest.mark.parametrize(
    "files, expected",
    [
        ({f"backup/{NAME}": "", f"scripts/{NAME}": ""}, f"scripts/{NAME}"),
        ({f"nodes/{NAME}": "", f"zz old/{NAME}": "x"}, f"nodes/{NAME}"),
        ({f".ipynb_checkpoints/{NAME}": "x", f"__MACOSX/{NAME}": "x", f"z/{NAME}": ""}, f"z/{NAME}"),
        ({f"backup/{NAME}": "x", "scripts/server.py": SERVER}, "scripts/server.py"),
        ({"goto.py": RAW, "test_client.py": CLIENT}, "goto.py"),
        ({"robocop_goto_as (1).py": SERVER}, "robocop_goto_as (1).py"),
        ({f"a/{NAME}": "same", f"b/{NAME}": "same"}, f"a/{NAME}"),
        ({"main.py": "# SimpleActionServer\n"}, None),
    ],
)
def test_server_is_the_script_of_its_name_or_the_only_one_that_offers_the_action_and_no_copy(tmp_path, files, expected):
    assert chosen(tree(tmp_path, files)) == (expected, None)


def test_what_is_launched_comes_first(tmp_path):
    tree(tmp_path, {f"scripts/{NAME}": "", "scripts/mine.py": SERVER, "patrol.py": CLIENT, "clicks.py": BRIDGE})
    assert chosen(tmp_path) == (f"scripts/{NAME}", "clicks.py")
    assert chosen(tmp_path, "mine.py") == ("scripts/mine.py", "clicks.py")
    assert chosen(tmp_path, "patrol.py", "clicks.py") == (f"scripts/{NAME}", "clicks.py")
    (tmp_path / "clicks.py").unlink()
    assert chosen(tmp_path) == (f"scripts/{NAME}", None)
    assert chosen(tmp_path, "patrol.py") == (f"scripts/{NAME}", "patrol.py")


MAIN = "import rospy, goto_server as it\nrospy.init_node('goto')\nit.Server()\n"


@pytest.mark.parametrize(
    "main, expected, others",
    [
        ("main.py", "main.py", []),  # goto_server.py is a part of it
        (NAME, NAME, ["main.py"]),
        ("test_goto.py", "main.py", ["test_goto.py"]),
    ],
)
def test_program_that_imports_the_server_is_started_not_the_module(tmp_path, main, expected, others):
    found = choose(tree(tmp_path, {"goto_server.py": SERVER, "main.py": MAIN, main: MAIN, "plot.py": "import main"}))
    assert found["server"].path.name == expected and [it.name for it in found["server"].others] == others


def test_launched_program_is_the_server_that_it_imports(tmp_path):
    tree(tmp_path, {"lab/node.py": f"{SERVER}\ninit_node", "lab/run.py": "from lab.node import main\nmain()\n"})
    assert chosen(tmp_path) == ("lab/node.py", None)
    assert chosen(tmp_path, "run.py") == ("lab/run.py", None)


def test_what_the_build_has_made_a_program_of_is_installed(tmp_path):
    tree(tmp_path, {f"src/{NAME}": "", f"old/{NAME}": "x"})
    (found,) = choose(tmp_path, (), [tmp_path.parent / NAME]).values()
    assert (found.path, found.is_installed, found.others) == (
        tmp_path / "src" / NAME,
        True,
        [tmp_path / "old" / NAME],
    )


@pytest.mark.parametrize("names", [(f"nodes/{NAME}", f"scripts/{NAME}"), ("first.py", "second.py")])
def test_two_equal_candidates_are_refused_by_name(tmp_path, names):
    tree(tmp_path, {name: f"{SERVER}  # {name}" for name in names})
    with pytest.raises(HostingError, match=f"{names[0]} and {names[1]}: each of them could be the server"):
        choose(tmp_path)


@pytest.mark.parametrize(
    "content, expected",
    [
        (f"{BEGIN}\n", []),
        (f"{BEGIN}\r\n", ["has Windows line endings (CRLF)"]),
        (f"\ufeff{BEGIN}\n", ["begins with a byte-order mark"]),
        (f"\n{BEGIN}\n", ["does not begin with a #! line"]),
        ("import rospy\n", ["does not begin with a #! line"]),
        ("", ["does not begin with a #! line"]),
    ],
)
def test_reason_why_linux_can_not_start_a_script_is_named(tmp_path, content, expected):
    script = tmp_path / "a.py"
    script.write_bytes(content.encode())
    script.chmod(0o755)
    assert [problem for problem, _ in start_problems(script)] == expected
    script.chmod(0o644)
    assert [problem for problem, _ in start_problems(script)] == ["is not executable", *expected]


@pytest.mark.parametrize(
    "line, expected",
    [
        (BEGIN, ""),
        ("#! /usr/bin/python3 -u", ""),
        ("#!/usr/bin/env -S python3 -u", ""),
        ("#!/usr/bin/env python", "/usr/bin/env python"),
        ("#!/usr/bin/env python3 -u", "/usr/bin/env python3 -u"),
        ("#!/home/anna/venv/bin/python3", "/home/anna/venv/bin/python3"),
    ],
)
def test_interpreter_other_than_the_systems_python3_is_named(tmp_path, line, expected):
    (tmp_path / "a.py").write_text(f"{line}\n")
    assert interpreter(tmp_path / "a.py") == expected
