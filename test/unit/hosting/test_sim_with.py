"""Hosted packages: launched with the right arguments, and from scripts that can be started."""

import os
import shlex
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import pytest
from hosted_packages import LAB, MANIFEST, tree

from aro_robocop_goto_as.names import PACKAGE
from robocop_hosting.errors import HostingError
from robocop_hosting.launch_file import LaunchNode
from robocop_hosting.package import LaunchPlan, find_package
from robocop_hosting.scripts import Choice
from robocop_hosting.sim_with import (
    expect_startable,
    parsed,
    sort_arguments,
    write_launch_file,
)

PAIR = {"package.xml": MANIFEST.format(LAB), "a.launch": "<launch><arg name='speed'/></launch>"}


def test_arguments_go_to_the_launch_file_that_declares_them_or_to_the_simulator(tmp_path):
    package = find_package(str(tree(tmp_path, PAIR)))
    given, known = ["speed:=0.1", "seed:=7", "spawn:=1 2"], ["seed", "spawn"]
    assert sort_arguments(package, given, known) == ({"speed": "0.1"}, "seed:=7 'spawn:=1 2'")
    with pytest.raises(HostingError, match="wrold:=x: neither .* they have: speed, seed, spawn"):
        sort_arguments(package, ["wrold:=x"], known)


def test_rviz_is_left_to_aro_sim_where_the_launch_file_has_no_argument_for_it(tmp_path, monkeypatch):
    monkeypatch.setenv("ROBOCOP_RVIZ", "true")
    package = find_package(str(tree(tmp_path, PAIR)))
    assert sort_arguments(package, ["rviz:=false"], ["seed"]) == ({}, "")
    assert os.environ["ROBOCOP_RVIZ"] == "false"


@pytest.mark.parametrize("package, script", [("aro_sim", "lab_simulator.py"), (PACKAGE, "robocop_sim.py")])
def test_simulator_is_started_unless_the_package_starts_it(tmp_path, package, script):
    hosted = find_package(str(tree(tmp_path, {"package.xml": MANIFEST.format(LAB), "x.launch": "<launch/>"})))
    for others in ([], [LaunchNode(package, script, "sim", "x.launch")]):
        written = write_launch_file(hosted, tmp_path, {}, LaunchPlan({}, {}, (), others)).read_text()
        assert ("aro_sim" in written) != bool(others)


def test_launch_file_gets_its_arguments_and_scripts_without_one_are_started_as_by_rosrun(tmp_path):
    package = find_package(str(tree(tmp_path / "src" / LAB, PAIR)))
    included = ElementTree.parse(write_launch_file(package, tmp_path, {"speed": "<1"}, LaunchPlan({}, {}, ()))).findall(
        "include"
    )
    assert included[-1].attrib == {"file": str(package.launch_file)}
    assert [argument.attrib for argument in included[-1]] == [{"name": "speed", "value": "<1"}]
    scripts = {part: Choice(Path(f"{part}.py"), None, False, []) for part in ("server", "bridge")}
    written = write_launch_file(replace(package, launch_file=None), tmp_path, {}, LaunchPlan(scripts, {}, ()))
    nodes = list(ElementTree.parse(written).iter("node"))
    assert [(node.get("pkg"), node.get("type"), node.get("name")) for node in nodes] == [
        (LAB, "server.py", "aro_robocop_goto_as_node"),
        (LAB, "bridge.py", "robocop_rviz_goto_ac_node"),
    ]
    script = tree(tmp_path, {"a.py": f"#!{sys.executable}\nimport sys\nprint(sys.argv[1:])\n"}) / "a.py"
    script.chmod(0o755)
    started = [*shlex.split(nodes[0].get("launch-prefix", "")), str(script), "__name:=x", "__log:=y"]
    assert subprocess.run(started, stdout=subprocess.PIPE, text=True).stdout == "[]\n"


@pytest.mark.parametrize(
    "line", ["my_lab --launch other.launch sync:=lockstep", "--launch other.launch my_lab sync:=lockstep"]
)
def test_options_may_stand_before_or_among_the_arguments(line):
    args = parsed(line.split())
    assert (args.path, args.launch, args.arguments) == ("my_lab", "other.launch", ["sync:=lockstep"])


def test_script_that_roslaunch_can_not_start_is_refused_with_the_remedy_and_left_as_it_is(tmp_path, capsys):
    tree(
        tmp_path, {"a.py": "#!/usr/bin/env python3\n", "b.py": "\n#!/usr/bin/env python3\n", "c.py": "#!/bin/python\n"}
    )
    with pytest.raises(HostingError, match="a.py is not executable, so roslaunch can't start it: chmod .x a.py"):
        expect_startable(tmp_path / "a.py")
    assert tmp_path.joinpath("a.py").stat().st_mode & 0o111 == 0
    for name in ("b.py", "c.py"):
        (tmp_path / name).chmod(0o755)
    with pytest.raises(HostingError, match="b.py does not begin with a #! line, so roslaunch can't start it"):
        expect_startable(tmp_path / "b.py")
    expect_startable(tmp_path / "c.py")
    assert "c.py is started by '/bin/python', which the lab may not have" in capsys.readouterr().err
