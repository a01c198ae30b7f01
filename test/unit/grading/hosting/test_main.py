"""Hosted packages: launched with the right arguments."""

from pathlib import Path

import pytest
from hosted_packages import LAB, MANIFEST, tree

from aro_robocop_goto_as.errors import HostingError
from robocop_grading.hosting.main import launch_file, parsed, sort_arguments
from robocop_grading.hosting.package import find_package

PAIR = {"package.xml": MANIFEST.format(LAB), "a.launch": "<launch><arg name='speed'/></launch>"}


def test_arguments_go_to_the_launch_file_that_declares_them_or_to_the_simulator(tmp_path: Path) -> None:
    package = find_package(str(tree(tmp_path, PAIR)))
    given, known = ["speed:=0.1", "seed:=7", "spawn:=1 2"], ["seed", "spawn"]
    assert sort_arguments(package, given, known) == ({"speed": "0.1"}, "seed:=7 'spawn:=1 2'")
    with pytest.raises(HostingError, match="wrold:=x: neither .* they have: speed, seed, spawn"):
        sort_arguments(package, ["wrold:=x"], known)


@pytest.mark.parametrize(
    "text, starts",
    [
        ('<launch><include file="$(find aro_sim)/launch/robocop_sim.launch"/></launch>', True),
        ("<launch/>", False),
    ],
)
def test_simulator_is_started_unless_the_package_starts_it(tmp_path: Path, text: str, starts: bool) -> None:
    package = find_package(str(tree(tmp_path, {"package.xml": MANIFEST.format(LAB), "x.launch": text})))
    assert package.starts_simulator == starts
    assert ("aro_sim" in launch_file(package, tmp_path, {}).read_text()) != starts


@pytest.mark.parametrize(
    "line", ["my_lab --launch other.launch sync:=lockstep", "--launch other.launch my_lab sync:=lockstep"]
)
def test_options_may_stand_before_or_among_the_arguments(line: str) -> None:
    args = parsed(line.split())
    assert (args.path, args.launch, args.arguments) == ("my_lab", "other.launch", ["sync:=lockstep"])


def test_only_the_chosen_launch_file_and_what_it_includes_decide_who_starts_the_simulator(tmp_path: Path) -> None:
    starts = '<launch><include file="$(find aro_sim)/launch/robocop_sim.launch"/></launch>'
    files = {
        "package.xml": MANIFEST.format(LAB),
        "launch/robocop_goto_as.launch": "<launch><!-- without robocop_sim --></launch>",
        "launch/lab.launch": f'<launch><include file="$(find {LAB})/launch/both.launch"/></launch>',
        "launch/both.launch": starts,
    }
    tree(tmp_path, files)
    assert not find_package(str(tmp_path)).starts_simulator
    assert find_package(str(tmp_path), "lab.launch").starts_simulator
    assert find_package(str(tmp_path), "both.launch").starts_simulator
