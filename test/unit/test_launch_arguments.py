"""What is typed for a launch file."""

import pytest

from aro_robocop_goto_as.errors import ParameterError
from aro_robocop_goto_as.launch_arguments import LaunchArguments, described

FILE = """<launch>
  <!-- <arg name="commented" default=""/> -->
  <arg name="needed" doc="no default: given by whoever includes this file"/>
  <arg
      name="world"
      default=""/>
  <arg name="made" value="$(arg world)"/>
  <arg name="web" default="false"/>
</launch>"""


@pytest.fixture
def file(tmp_path):
    (tmp_path / "my.launch").write_text(FILE)
    return tmp_path / "my.launch"


def test_arguments_are_those_with_a_default_wherever_the_lines_break(file, tmp_path):
    assert described(file) == {"world": "", "web": ""}
    after = tmp_path / "next.launch"
    after.write_text('<launch><arg name="world" default="" doc="a name"/><arg name="x" default=""/></launch>')
    assert described(file, after) == {"world": "a name", "web": ""}, "what is passed on is explained"


def test_verbose_is_no_argument_of_the_file_and_remappings_of_ros_pass(file):
    given = LaunchArguments.parse(file, ["--verbose", "__name:=x", "web:=1"])
    assert (given.verbose, given.words) == (True, ("__name:=x", "web:=1"))


def test_the_last_value_counts(file):
    given = LaunchArguments.parse(file, ["web:=true", "web:=false"])
    assert (given.value("web"), given.is_true("web"), given.value("world")) == ("false", False, "")


@pytest.mark.parametrize(
    "word, message",
    [
        ("world=x", "expected NAME:=VALUE, such as world:=stage_1; got 'world=x'"),
        ("--verbos", "there is no option --verbos; there are: --verbose --with; did you mean --verbose?"),
        ("--wiht", "there is no option --wiht; there are: --verbose --with; did you mean --with?"),
        ("needed:=1", "there is no argument needed; there are: world web"),
        ("map:=x", "there is no argument map; there are: world web; did you mean world?"),
        ("speed:=3", "there is no argument speed; there are: world web"),
        ("wrold:=x", "there is no argument wrold; there are: world web; did you mean world?"),
    ],
)
def test_other_words_are_refused(file, word, message):
    with pytest.raises(ParameterError) as refused:
        LaunchArguments.parse(file, [word], "--with")
    assert str(refused.value) == message


def test_opposite_of_an_argument_is_suggested_with_its_value(tmp_path):
    (tmp_path / "my.launch").write_text('<launch><arg name="rviz" default="true"/></launch>')
    with pytest.raises(ParameterError, match="did you mean rviz:=false[?]"):
        LaunchArguments.parse(tmp_path / "my.launch", ["headless:=true"])


def test_path_of_a_file_is_made_absolute_but_not_the_name_of_a_world(file, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path))
    (tmp_path / "maze").write_text("")
    words = LaunchArguments.parse(
        file, ["world:=my.launch", "world:=maze", "world:=./maze", "world:=no.sdf", "world:=~/maze"]
    ).words
    assert words == (
        f"world:={file}",
        "world:=maze",
        f"world:={tmp_path}/maze",
        "world:=no.sdf",
        f"world:={tmp_path}/maze",
    )
