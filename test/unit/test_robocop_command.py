"""The one command, as far as it can be watched without installing anything."""
import os
import shutil
import subprocess
import time
from pathlib import Path

import pytest

from aro_robocop_goto_as.loopback import free_port

ROOT = Path(__file__).resolve().parents[2]
COMMANDS = ("run", "goto", "test", "bench", "shell", "setup", "clean", "help")
LAUNCH = "/devel/lib/aro_robocop_goto_as/robocop_launch.py aro_robocop_goto_as"
BUILD_INPUTS = ("CMakeLists.txt", "package.xml", "setup.py", "action", "cfg", "msg", "srv", "scripts", "src")


def environment(**settings):
    """This test's environment without what the command decides by; a setting of None is taken out."""
    left_out = ("ROS_MASTER_URI", "ROS_IP", "ROS_HOSTNAME", "DISPLAY", "ROBOCOP_DRY_RUN")
    chosen = {name: value for name, value in os.environ.items() if name not in left_out}
    chosen.update(settings)
    return chosen


def robocop(*arguments, root=ROOT, timeout=240.0, **settings):
    command = [str(root / "robocop"), *arguments]
    return subprocess.run(command, env=environment(**settings), capture_output=True, text=True, timeout=timeout)


def dry_run(*arguments, **settings):
    """The last line is the command that would be started, the lines before are the ROS settings it would have."""
    done = robocop(*arguments, ROBOCOP_DRY_RUN="1", **settings)
    assert done.returncode == 0, done.stderr
    *settings, command = done.stdout.splitlines()
    return command.strip(), settings, done.stderr


def test_help_lists_every_command():
    done = robocop("help")
    assert done.returncode == 0
    for command in COMMANDS:
        assert f"\n  {command} " in done.stdout


def test_no_command_prints_the_help():
    assert robocop().stdout == robocop("help").stdout


def test_unknown_command_is_refused_with_its_name():
    done = robocop("tset")
    assert done.returncode == 2
    assert "tset" in done.stderr and "help" in done.stderr
    assert done.stdout == ""


def test_shell_passes_arguments_and_exit_status_through():
    done = robocop("shell", "bash", "-c", 'printf "[%s]" "$@"; exit 7', "_", "a b", "-0.5", "")
    assert (done.returncode, done.stdout) == (7, "[a b][-0.5][]")


def test_shell_finds_the_package():
    done = robocop("shell", "rosmsg", "show", "-r", "aro_robocop_goto_as/GoToPositionGoal")
    assert "geometry_msgs/Point position" in done.stdout, done.stderr


def test_foreign_python_is_left_out(tmp_path):
    for name in ("python", "python3", "pip", "cmake"):
        (tmp_path / name).write_text("#!/bin/sh\nexit 77\n")
        (tmp_path / name).chmod(0o755)
    (tmp_path / "rospy.py").write_text("raise ImportError('not this one')\n")
    code = "import rospy, pybullet, aro_robocop_goto_as.msg; print('right')"
    nowhere = str(tmp_path / "nowhere")
    foreign = {"PYTHONHOME": nowhere, "VIRTUAL_ENV": nowhere, "CONDA_PREFIX": nowhere, "PYTHONPATH": str(tmp_path)}
    done = robocop("shell", "python3", "-c", code, PATH=f"{tmp_path}:{os.environ['PATH']}", **foreign)
    assert done.stdout == "right\n", done.stderr


def test_ros_listens_on_loopback_by_default():
    assert dry_run("run")[1] == ["ROS_HOSTNAME=localhost"]


@pytest.mark.parametrize(
    "name, value", [("ROS_MASTER_URI", "http://robot:11311"), ("ROS_IP", "192.0.2.1"), ("ROS_HOSTNAME", "robot")]
)
def test_ros_network_setting_is_respected(name, value):
    assert dry_run("run", **{name: value})[1] == [f"{name}={value}"]


def test_without_display_rviz_stays_closed_and_it_says_so():
    command, _, said = dry_run("run", "world:=empty")
    assert command.endswith(f"{LAUNCH} robocop_goto_as.launch rviz:=false world:=empty")
    assert "display" in said


def test_dead_display_counts_as_none():
    assert "rviz:=false" in dry_run("run", DISPLAY=":4711")[0]


def test_live_display_opens_rviz():
    read, write = os.pipe()
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(write), "-screen", "0", "320x240x24"], pass_fds=[write], stderr=subprocess.DEVNULL
    )
    try:
        os.close(write)
        with open(read) as display:
            assert "rviz:=true" in dry_run("run", DISPLAY=f":{display.readline().strip()}")[0]
    finally:
        server.terminate()
        server.wait()


@pytest.mark.parametrize("wish", ["rviz:=true", "rviz:=false"])
def test_explicit_rviz_wins(wish):
    command = dry_run("run", wish)[0]
    assert command.endswith(f"{LAUNCH} robocop_goto_as.launch {wish}")


@pytest.mark.parametrize("command, file", [("run", "robocop_goto_as.launch"), ("sim", "robocop_sim.launch")])
def test_what_is_started_ends_with_a_status_that_tells_how_the_simulator_ended(command, file):
    nobody = f"http://localhost:{free_port()}"
    assert f"{LAUNCH} {file}" in dry_run(command, "world:=empty", ROS_MASTER_URI=nobody)[0]


@pytest.mark.parametrize("command", ["run", "sim"])
def test_argument_that_no_launch_file_knows_is_refused_with_those_that_it_knows(command):
    done = robocop(command, "wrld:=empty", ROBOCOP_DRY_RUN="1")
    assert done.returncode == 1
    assert "there is no argument wrld; there are: " in done.stderr and " world " in done.stderr


def test_goto_passes_negative_numbers():
    assert dry_run("goto", "-0.5", "-1", "--frame", "map")[0].endswith("/robocop_goto.py -0.5 -1 --frame map")


@pytest.mark.parametrize("settings, lacks", [({}, "DISPLAY is not set"),
                                             ({"DISPLAY": ":4711"}, ":4711 (DISPLAY) does not answer")])
def test_grade_without_a_display_to_watch_on_is_refused_with_what_to_do(settings, lacks, tmp_path):
    done = robocop("grade", str(tmp_path), "--watch", **settings)
    assert (done.returncode, done.stdout) == (1, "")
    assert f"{lacks}: run it on a desktop, or grade without --watch" in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_up_to_date_set_up_adds_less_than_a_second():
    def seconds():
        start = time.monotonic()
        assert robocop("shell", "true").returncode == 0
        return time.monotonic() - start

    assert any(seconds() < 1.0 for _ in range(10))  # the quickest counts: other tests keep the machine busy


@pytest.fixture
def checkout(tmp_path):
    """A copy of the checkout at a path with a space, that needs nothing from PyPI."""
    root = tmp_path / "check out"
    root.mkdir()
    for name in ("robocop", "deb-packages", *BUILD_INPUTS):
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, root / name, ignore=shutil.ignore_patterns("__pycache__"))
        elif (ROOT / name).exists():
            shutil.copy2(ROOT / name, root / name)
    (root / "requirements.txt").write_text("")
    (root / "scripts" / "robocop_goto.py").write_text("#!/usr/bin/env python3\nprint('started')\n")
    return root


def in_copy(root, *arguments):
    return robocop(*arguments, root=root, XDG_CACHE_HOME=str(root.parent / "cache"))


def test_missing_debian_package_is_named_with_the_line_to_type(checkout):
    (checkout / "deb-packages" / "run.txt").write_text("# comment\nbash\nno-such-package # comment\n")
    done = robocop("setup", root=checkout, ROBOCOP_DRY_RUN="1")
    assert "apt-get install --no-install-recommends no-such-package\n" in done.stderr


def test_path_with_a_space_and_two_calls_at_once_then_broken_then_moved(checkout):
    """One test, as each step needs the set-up of the one before, which takes seconds."""
    cache = checkout.parent / "cache"
    show = ("shell", "python3", "-c", "import aro_robocop_goto_as.msg as m; print(m.__file__)")
    calls = [
        subprocess.Popen(
            [str(checkout / "robocop"), *show],
            env=environment(XDG_CACHE_HOME=str(cache)),
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        for _ in range(2)
    ]
    answers = [(*call.communicate(timeout=240), call.returncode) for call in calls]
    assert [status for _, _, status in answers] == [0, 0], answers
    assert all(out.startswith(f"{cache}/robocop/") and " " not in out for out, _, _ in answers)
    assert not (checkout / ".robocop").exists()
    assert in_copy(checkout, "goto", "1", "2").stdout == "started\n"
    assert in_copy(checkout, "shell", "rosrun", "aro_robocop_goto_as", "robocop_goto.py").stdout == "started\n"

    # What an interrupted build of a changed action leaves: half a workspace and no stamp.
    shutil.rmtree(next(cache.glob("robocop/*/ws/devel")))
    (checkout / "action" / "Other.action").write_text("---\n---\n")
    assert in_copy(checkout, *show).returncode == 0
    assert in_copy(checkout, *show).stderr == ""  # nothing left to do

    moved = checkout.rename(checkout.parent / "moved")
    assert in_copy(moved, *show).stdout.startswith(f"{moved}/.robocop/")
    assert in_copy(moved, "clean").returncode == 0
    assert not (moved / ".robocop").exists()
