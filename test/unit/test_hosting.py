"""Hosted packages: found at a path, launched with the right arguments; their builds leave nothing in TMPDIR."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Dict, Optional

import pytest
from processes import busy_processes, processes_mentioning
from support import ROOT

from aro_robocop_goto_as.errors import HostingError
from aro_robocop_goto_as.hosting.main import launch_file, parsed, sort_arguments
from aro_robocop_goto_as.hosting.package import find_package

LAB = "aro_robocop_goto_as"
MANIFEST = "<package><name> {} </name></package>"


def _tree(top: Path, files: Dict[str, str]) -> Path:
    for name, text in files.items():
        (top / name).parent.mkdir(parents=True, exist_ok=True)
        (top / name).write_text(text)
    return top


def test_package_is_found_from_its_folder_or_its_workspace(tmp_path: Path) -> None:
    _tree(tmp_path, {f"src/{name}/package.xml": MANIFEST.format(name) for name in (LAB, "tools")})
    _tree(tmp_path, {f"src/{LAB}/scripts/robocop_goto_as.py": "", "build/x/package.xml": "<package/>"})
    for path in ("", "src", f"src/{LAB}"):
        package = find_package(str(tmp_path / path))
        assert (package.name, package.path) == (LAB, tmp_path / "src" / LAB)
        assert package.nodes == (("robocop_goto_as.py", "aro_robocop_goto_as_node"),)


@pytest.mark.parametrize(
    "files, expected",
    [
        ({}, "no package.xml in it or below it"),
        ({"package.xml": "<package>"}, "package.xml: not XML that can be read: no element found"),
        ({"package.xml": "<package/>"}, "package.xml: expected a <name>"),
        (
            {"a/package.xml": MANIFEST.format("a"), "b/package.xml": MANIFEST.format("b")},
            "2 packages found, give the",
        ),
        ({"package.xml": MANIFEST.format(LAB)}, "nothing to start: expected launch/robocop_goto_as.launch, or scripts"),
    ],
)
def test_folder_without_a_package_to_start_is_refused(tmp_path: Path, files: Dict[str, str], expected: str) -> None:
    with pytest.raises(HostingError, match=expected):
        find_package(str(_tree(tmp_path, files)))


def test_missing_path_is_refused() -> None:
    with pytest.raises(HostingError, match="/no/such/place: expected the folder of a catkin package"):
        find_package("/no/such/place")


PAIR = {"package.xml": MANIFEST.format(LAB), "a.launch": "<launch><arg name='speed'/></launch>"}


def test_launch_file_is_the_named_one_else_the_labs_else_the_only_one(tmp_path: Path) -> None:
    _tree(tmp_path, PAIR)
    assert find_package(str(tmp_path)).launch_file == tmp_path / "a.launch"
    _tree(tmp_path, {"launch/robocop_goto_as.launch": "<launch/>"})
    assert find_package(str(tmp_path)).launch_file == tmp_path / "launch" / "robocop_goto_as.launch"
    assert find_package(str(tmp_path), "a.launch").launch_file == tmp_path / "a.launch"
    with pytest.raises(HostingError, match="no launch file 'b.launch'; available: a.launch, robocop_goto_as.launch"):
        find_package(str(tmp_path), "b.launch")


def test_arguments_go_to_the_launch_file_that_declares_them_or_to_the_simulator(tmp_path: Path) -> None:
    package = find_package(str(_tree(tmp_path, PAIR)))
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
    package = find_package(str(_tree(tmp_path, {"package.xml": MANIFEST.format(LAB), "x.launch": text})))
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
    _tree(tmp_path, files)
    assert not find_package(str(tmp_path)).starts_simulator
    assert find_package(str(tmp_path), "lab.launch").starts_simulator
    assert find_package(str(tmp_path), "both.launch").starts_simulator


def _md5sums() -> Dict[str, str]:
    """Type definition file -> md5sum, as computed by ROS's tools."""
    from genmsg import MsgContext, gentools, msg_loader

    share = Path(ROOT, "compat", "gazebo_msgs")
    search = {
        "gazebo_msgs": [str(share / "msg")],
        **{name: [f"/usr/share/{name}/msg"] for name in ("geometry_msgs", "std_msgs")},
    }
    md5sums = {}
    for path in sorted(share.glob("*/*.[ms][sr][gv]")):
        context = MsgContext.create_default()
        load = msg_loader.load_msg_from_file if path.suffix == ".msg" else msg_loader.load_srv_from_file
        spec = load(context, str(path), f"gazebo_msgs/{path.stem}")
        msg_loader.load_depends(context, spec, search)
        md5sums[path.name] = gentools.compute_md5(context, spec)
    return md5sums


def test_gazebo_types_have_the_md5sums_of_the_originals() -> None:
    assert _md5sums() == {
        "ContactState.msg": "48c0ffb054b8c444f870cecea1ee50d9",
        "ContactsState.msg": "acbcb1601a8e525bf72509f18e6f668d",
        "DeleteLight.srv": "ae11ea8100d536d5b92c2b5917abf912",
        "DeleteModel.srv": "9ce56b4e9e54616de25d796dc972a262",
        "GetModelState.srv": "4c515e936d3319c9610c559c60bfc3d4",
        "GetWorldProperties.srv": "36bb0f2eccf4d8be971410c22818ba3f",
        "LinkStates.msg": "48c080191eb15c41858319b4d8a609c2",
        "ModelState.msg": "9330fd35f2fcd82d457e54bd54e10593",
        "ModelStates.msg": "48c080191eb15c41858319b4d8a609c2",
        "SetModelState.srv": "5b3ab0281d4f5445def017e3a2e4a07b",
        "SpawnModel.srv": "9ed9c82c96abe1a00c3e8cdaeee24413",
    }


# Its child starts a process in a session of its own that keeps creating files in TMPDIR.
SCRATCH_PROGRAM = """
import subprocess, sys, time
from aro_robocop_goto_as.hosting.scratch import scratch_folder
from aro_robocop_goto_as.process.signals import interrupt_on_signal

interrupt_on_signal()
try:
    with scratch_folder():
        subprocess.Popen(["sh", "-c", "setsid sh -c 'while mktemp >/dev/null; do sleep 0.01; done' & sleep 600"])
        time.sleep(600.0 if sys.argv[1] == "sleep" else 1.0)
except KeyboardInterrupt:
    sys.exit(130)
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, None])
def test_a_program_and_its_children_leave_no_temporary_files(number: Optional[int], tmp_path: Path) -> None:
    command = [sys.executable, "-c", SCRATCH_PROGRAM, "end" if number is None else "sleep"]
    program = subprocess.Popen(command, env={**os.environ, "TMPDIR": str(tmp_path)})
    try:
        if number is not None:
            deadline = time.monotonic() + 60.0
            while not list(tmp_path.glob("*/tmp.*")):
                assert program.poll() is None and time.monotonic() < deadline
                time.sleep(0.01)
            with busy_processes():
                program.send_signal(number)
                program.wait(60.0)
        assert program.wait(60.0) == (0 if number is None else 130)
    finally:
        program.kill()
    assert list(tmp_path.iterdir()) == []
    assert processes_mentioning(tmp_path) == []
