"""What is said of a submission before it runs."""

import pytest
from hosted_packages import tree

from robocop_grading import submission
from robocop_grading.errors import GradingError
from robocop_hosting.errors import HostingError

NAME = "robocop_goto_as.py"
SERVER = "import rospy\nrospy.init_node('lab')\nactionlib.SimpleActionServer('robocop_goto_as')\n"


def prepared(top):
    return submission.find(top, top / "workspace", {"": {}})


@pytest.mark.parametrize("other", [SERVER, "import rospy)\n"])
def test_second_version_of_a_script_is_named_as_not_graded(tmp_path, other):
    for name, code in (("robocop_goto_as.py", SERVER), ("robocop_goto_as_final.py", other), ("tools.py", "")):
        (tmp_path / name).write_text(code)
    assert "server: robocop_goto_as.py is graded, but not robocop_goto_as_final.py" in prepared(tmp_path).notes


def test_script_of_a_single_file_or_without_a_launch_file_gets_no_arguments_of_roslaunch(tmp_path):
    (tmp_path / "robocop_goto_as.py").write_text(SERVER)
    (script,) = prepared(tmp_path).scripts
    assert script.command()[-1] == str(tmp_path / "robocop_goto_as.py")


def test_script_outside_of_the_package_is_named_as_not_graded(tmp_path, monkeypatch):
    files = {"lab/package.xml": "<package><name>lab</name></package>", f"lab/{NAME}": SERVER, NAME: f"{SERVER}# done\n"}
    tree(tmp_path, files)
    empty = submission.Submission("lab", {}, [])
    monkeypatch.setattr(submission, "_package", lambda *_: empty)
    assert prepared(tmp_path).notes == [f"server: {NAME} is outside of the package, so it is not graded"]


@pytest.mark.parametrize("launch, reason", [(False, "nothing to start"), (True, "Could not find roscpp")])
def test_hand_in_in_cpp_is_told_so_before_what_is_missing(tmp_path, monkeypatch, launch, reason):
    def build(*_):
        raise HostingError(reason)

    monkeypatch.setattr(submission.workspace, "build", build)
    tree(tmp_path, {"package.xml": "<package><name>lab</name></package>", "src/server.cpp": "int main() {}"})
    if launch:
        tree(tmp_path, {"launch/robocop_goto_as.launch": "<launch/>"})
    with pytest.raises(GradingError, match=f"src/server.cpp: C.. is not graded, only a server and .*\n.*{reason}"):
        prepared(tmp_path)


def test_two_packages_of_the_same_name_may_be_a_class(tmp_path):
    for name in ("anna", "ben"):
        tree(tmp_path / name, {"package.xml": "<package><name>lab</name></package>", "robocop_goto_as.py": SERVER})
    with pytest.raises(HostingError, match="2 packages found.*; is this folder a class"):
        prepared(tmp_path)


@pytest.mark.parametrize("more, expected", [("Subscriber('/move_base_simple/goal')\n", 1), ("# move_base_simple\n", 0)])
def test_bridge_in_the_servers_script_is_not_graded_without_a_word(tmp_path, more, expected):
    (tmp_path / "lab.py").write_text(SERVER + more)
    assert sum("lab.py has a bridge, too" in note for note in prepared(tmp_path).notes) == expected
