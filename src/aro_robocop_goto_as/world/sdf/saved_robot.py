"""Recognize the robots that were saved with a world: here the simulator's own robot takes their place."""

import re

from ...reading import Element

# TurtleBots as their packages name them; not turtlebot3_world and turtlebot3_house, which are rooms.
_NAME = re.compile(r"(turtlebot3_)?(burger|waffle|waffle_pi)(_cam)?(_\d+)?|turtlebot\d?(_\d+)?|mobile_base", re.I)
# In a plugin's name or file, without separators: libgazebo_ros_diff_drive.so, differential_drive_controller, gz-sim's
# DiffDrive, libgazebo_ros_skid_steer_drive.so, libgazebo_ros_planar_move.so, libgazebo_ros_kobuki.so, ...
_DRIVE = re.compile(r"(diff|differential|skidsteer(ing)?|ackermann|tricycle|mecanum|omni)drive|planarmove|kobuki")
_BASES = {"base_footprint", "base_link"}  # REP-105
_WHEELS = 2  # links with a wheel's name, at least


def is_robot_name(name: str) -> bool:
    """Return whether a model, or its folder, has the name of a known robot."""
    return bool(_NAME.fullmatch(name))


def is_robot(model: Element) -> bool:
    """Return whether a <model> itself has the name or the links of a known robot, or a plugin that drives it."""
    links = [str(link.get("name", "")) for link in model.iterchildren("link")]
    has_links = not _BASES.isdisjoint(links) and sum("wheel" in name for name in links) >= _WHEELS
    return is_robot_name(str(model.get("name", ""))) or has_links or any(map(_is_drive, model.iterchildren("plugin")))


def _is_drive(plugin: Element) -> bool:
    names = f"{plugin.get('name', '')} {plugin.get('filename', '')}".lower()
    return bool(_DRIVE.search(re.sub(r"[-_:.]", "", names)))
