"""The private ROS parameters of this node -> its parameter dataclass."""

from typing import Type, TypeVar

import rospy

from ..param_loading import from_dict

T = TypeVar("T")


def load(cls: Type[T]) -> T:
    """All private parameters as `cls`; ParameterError names the node and each key that is wrong."""
    raw = rospy.get_param("~", {})
    return from_dict(cls, raw, f"parameters of {rospy.get_name()}")
