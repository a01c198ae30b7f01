#!/usr/bin/env python3
"""Replaces itself by a program of the simulator's package: its roslaunch, its RViz, or its web page.

Arguments: `robocop_launch.py`, arguments of the simulator's launch file, `--`, arguments of Gazebo's spawn_model;
or `robocop_rviz.py` or `robocop_web.py` and its arguments.

A package in this workspace may have the same name as the simulator's package. If ROBOCOP_WS names the workspace in
which the simulator was built, the program runs in that workspace's environment, otherwise in this one's.
"""

import argparse
import os
import shlex
import sys

LAUNCH = "robocop_launch.py"
SHADOWING = ("PYTHONPATH", "CMAKE_PREFIX_PATH", "ROS_PACKAGE_PATH")  # would resolve to this workspace first
SERVICES = "gazebo_services:=true"
LAB = ["cmd_vel_timeout:=0.0", "odom_tf:=false"]  # unless a profile says what is simulated
LACKING = """aro_sim: as in the original lab, nobody publishes the transform odom -> base_footprint. In base_footprint,
aro_sim: RViz can show the robot and its scan, but not the room, the odometry and the map. A bridge that transforms
aro_sim: goals to odom gets tf2's ConnectivityException. odom_tf:=true adds the transform."""


def spawn_from(words):
    """spawn_model's arguments -> the simulator's spawn argument; without any, the world's own spawn pose."""
    parser = argparse.ArgumentParser(prog="aro_sim: spawn_args", allow_abbrev=False)
    for option in ("-x", "-y", "-z", "-R", "-P", "-Y"):
        parser.add_argument(option, type=float, default=0.0)
    pose = parser.parse_args(words)
    return [f"spawn:={pose.x} {pose.y} {pose.Y}"] if words else []


def simulator_from(words):
    """Arguments of the lab's launch file -> those of robocop_launch.py, with the lab's behaviour."""
    words = [word for word in words if not word.startswith("__")]  # ROS's own remappings
    args, spawn_args = words[: words.index("--")], words[words.index("--") + 1 :]
    given = shlex.split(os.environ.get("ROBOCOP_SIM_ARGS", ""))
    has_profile = any(word.startswith("profile:=") and word != "profile:=" for word in given)
    args += [SERVICES, *([] if has_profile else LAB), *spawn_from(spawn_args), *given]
    if [arg for arg in args if arg.startswith("odom_tf:=")][-1:] == ["odom_tf:=false"]:
        print(LACKING, flush=True)
    return ["--no-summary", "aro_robocop_goto_as", "robocop_sim.launch", *args]


def main():
    """Never returns: the process becomes the program, so that ending this node ends the program."""
    program, *words = sys.argv[1:]
    start = 'exec rosrun aro_robocop_goto_as "$@"'
    if program == LAUNCH:  # not plain roslaunch, whose exit status does not report how the simulator ended
        words = simulator_from(words)
        start = 'exec python3 "$(rospack find aro_robocop_goto_as)/launch/$@"'
    workspace = os.environ.get("ROBOCOP_WS")
    if workspace:
        types = [path for path in os.environ.get("PYTHONPATH", "").split(":") if "/compat/" in path]  # gazebo_msgs
        for name in SHADOWING:
            os.environ.pop(name, None)
        sourced = [shlex.quote(word) for word in (f"{workspace}/setup.bash", ":".join(types))]
        start = ". {}; export PYTHONPATH=$PYTHONPATH:{}; ".format(*sourced) + start
    os.execvp("bash", ["bash", "-c", start, "aro_sim", program, *words])


if __name__ == "__main__":
    main()
