#!/usr/bin/env python3
"""Becomes the roslaunch of the simulator: args of it, then `--` and Gazebo's spawn_model arguments.

Somebody's package in this workspace may have the name of the simulator's own one. So where ROBOCOP_WS names the
workspace that the simulator was built in, it runs in that one's environment, and in this one's otherwise.
"""

import argparse
import os
import shlex
import sys

SHADOWING = ("PYTHONPATH", "CMAKE_PREFIX_PATH", "ROS_PACKAGE_PATH")  # what would lead to this workspace first


def spawn_from(words):
    """spawn_model's arguments -> the simulator's spawn arg: none at all means the world's own place."""
    parser = argparse.ArgumentParser(prog="aro_sim: spawn_args", allow_abbrev=False)
    for option in ("-x", "-y", "-z", "-R", "-P", "-Y"):
        parser.add_argument(option, type=float, default=0.0)
    place = parser.parse_args(words)
    return [f"spawn:={place.x} {place.y} {place.Y}"] if words else []


def main():
    """Never returns: this process becomes roslaunch, so that whoever ends it ends the simulator."""
    words = [word for word in sys.argv[1:] if not word.startswith("__")]  # rospy's own remappings
    args, spawn_args = words[:words.index("--")], words[words.index("--") + 1:]
    args += ["cmd_vel_timeout:=0.0", "odom_tf:=false", "moving:=true", "gazebo_services:=true"] + spawn_from(spawn_args)
    args += shlex.split(os.environ.get("ROBOCOP_SIM_ARGS", ""))
    workspace = os.environ.get("ROBOCOP_WS")
    # Not roslaunch itself, whose exit status says nothing of how the simulator ended.
    launch = [f"{workspace}/lib/aro_robocop_goto_as/robocop_launch.py"] if workspace else [
        "rosrun", "aro_robocop_goto_as", "robocop_launch.py"]
    command = [*launch, "--no-summary", "aro_robocop_goto_as", "robocop_sim.launch", *args]
    if not workspace:
        os.execvp(command[0], command)
    types = [path for path in os.environ.get("PYTHONPATH", "").split(":") if "/compat/" in path]  # of gazebo_msgs
    for name in SHADOWING:
        os.environ.pop(name, None)
    os.execvp("bash", ["bash", "-c", '. "$0/setup.bash"; export PYTHONPATH=$PYTHONPATH:$1; shift; exec "$@"',
                       workspace, ":".join(types), *command])


if __name__ == "__main__":
    main()
