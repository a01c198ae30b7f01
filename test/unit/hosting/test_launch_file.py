"""Launch files, read by roslaunch's own loader."""

import os

import pytest
from hosted_packages import tree

from robocop_hosting.errors import HostingError
from robocop_hosting.launch_file import read

NODE = '<node pkg="lab" type="a.py" name="a"'


def loaded(top, *arguments):
    return read(top / "launch" / "x.launch", top, dict(os.environ), arguments)


def written(top, text):
    return tree(top, {"launch/x.launch": f"<launch>\n{text}\n</launch>"})


def test_node_has_all_that_roslaunch_resolves(tmp_path):
    inner = """<launch><arg name="speed"/>
      <node pkg="lab" type="a.py" name="a" args="--speed $(arg speed) 'two words'" cwd="node">
      <remap from="odom_in" to="/odom"/><param name="gain" value="2.5"/><env name="LEVEL" value="3"/></node></launch>"""
    outer = """<arg name="fast" default="true"/><remap from="old" to="new"/>
      <group ns="robot" unless="false"><param name="list" type="yaml" value="[1, 2]"/>
      <include file="$(dirname)/inner.xml"><arg name="speed" value="0.1" unless="$(arg fast)"/>
      <arg name="speed" value="0.2" if="$(arg fast)"/></include></group>
      <node pkg="lab" type="b.py" name="b" if="false"/>"""
    tree(written(tmp_path, outer), {"launch/inner.xml": inner})
    file = loaded(tmp_path)
    (node,) = file.nodes
    assert node.arguments == ["--speed", "0.2", "two words", "old:=new", "odom_in:=/odom"]
    assert node.variables == {"LEVEL": "3", "ROS_NAMESPACE": "/robot"}
    assert (node.location, node.not_done) == ("launch/inner.xml, line 2", ["cwd='node'"])
    assert file.parameters == {"/robot/list": [1, 2], "/robot/a/gain": 2.5}
    assert loaded(tmp_path, "fast:=false").nodes[0].arguments[1] == "0.1"


@pytest.mark.parametrize(
    "text, reason",
    [
        ('<param name="q" value="$(arg nope)"/>', "launch/x.launch, line 2: .* requires the 'nope' arg to be set"),
        ('\n<include file="$(find no_such)/a"/>', "launch/x.launch, line 3: .* package no_such not found"),
        (f'{NODE} respawn="maybe"/>', "launch/x.launch, line 2: .*: invalid bool value for respawn: maybe"),
        (f'{NODE} args="it\'s"/>', "launch/x.launch, line 2: .* No closing quotation"),
        (f'{NODE}>\n<param name="x" value="$(eval 1/0)"/></node>', "line 3: .*: ZeroDivisionError: division by zero"),
        (f'{NODE}><env name="-S" value="x"/></node>', "line 2: <env name='-S'>: expected the name of a variable"),
        ("<nod>", "launch/x.launch: .*: mismatched tag: line 3"),
        ('<param name="day" type="yaml" value="2024-01-31"/>', "/day: 2024-01-31 can't be a parameter"),
        ('<param name="a" type="yaml" value="[12345678901234]"/>', r"/a: \[12345678901234\] can't be a parameter"),
        ('<param name="a" type="yaml" value="{1: 2}"/>', "/a: {1: 2} can't be a parameter"),
        ('<include file="$(dirname)/none.launch"/>', "line 2: .*No such file or directory.* .in launch/none.launch"),
    ],
)
def test_mistake_is_named_with_its_file_and_line(tmp_path, text, reason):
    written(tmp_path, text)
    with pytest.raises(HostingError, match=reason):
        loaded(tmp_path)


def test_parameters_of_a_file_may_refer_to_one_another(tmp_path):
    text = "<rosparam>\na: &amp;gains [1.5, 2.0]\nb: *gains\n</rosparam>"
    assert loaded(written(tmp_path, text)).parameters == {"/a": [1.5, 2.0], "/b": [1.5, 2.0]}


def test_tag_that_roslaunch_does_not_know_is_named(tmp_path):
    assert loaded(written(tmp_path, "<nod/>")).warnings == ["launch/x.launch: unrecognized tag nod"]
