"""Transforms for tests of what tf2 is asked for."""

import rospy
from geometry_msgs.msg import TransformStamped


def transform(parent, child, x=0.0, y=0.0, stamp=0.0):
    """Where a frame is in its parent [m], at a time [s]."""
    made = TransformStamped(child_frame_id=child)
    made.header.frame_id, made.header.stamp = parent, rospy.Time(stamp)
    made.transform.translation.x, made.transform.translation.y, made.transform.rotation.w = x, y, 1.0
    return made
