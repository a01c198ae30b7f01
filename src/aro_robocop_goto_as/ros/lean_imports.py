"""What ROS' own modules import and hardly ever use; it is left out or put off. This module imports nothing of ROS."""

import importlib
import sys
from types import ModuleType
from typing import Any, Callable

# Module -> the function for which it is imported.
PUT_OFF = {
    # By roslib, and so by rospy, to find the programs of packages: catkin_pkg and pyparsing, a tenth of a node's start.
    "catkin.find_in_workspaces": "find_in_workspaces",
    # By roslaunch, for its check of the logs' size: distutils, in whose place a virtual environment has setuptools.
    "rosclean": "get_disk_usage",
}


def prepare() -> None:
    """Call before rospy and roslaunch are imported: what PUT_OFF names is imported when its function is called."""
    for name, function in PUT_OFF.items():
        if name not in sys.modules:
            stand_in = ModuleType(name)
            vars(stand_in)[function] = _importing(stand_in, function)
            sys.modules[name] = stand_in


def _importing(stand_in: ModuleType, function: str) -> Callable[..., Any]:
    def call(*arguments: Any, **options: Any) -> Any:
        name = stand_in.__name__
        if sys.modules.get(name) is stand_in:
            del sys.modules[name]
        return getattr(importlib.import_module(name), function)(*arguments, **options)

    return call


def skip_manifests() -> None:
    """Call before dynamic_reconfigure is imported: it has roslib look for its manifest among all packages, in vain.

    For packages of catkin, which is what it is, roslib.load_manifest ends there; for those of rosbuild, ROS's older
    build tool, it would extend sys.path.
    """
    roslib = importlib.import_module("roslib")
    vars(roslib)["load_manifest"] = lambda package: None
