#!/usr/bin/env python3
"""As costmap_2d: the latched map, and scans through a tf message filter -> an OccupancyGrid with what stands there now.

Publishes costmap, and on costmap/scans how many scans were used and dropped.
"""

import threading

import numpy as np
import rospy
import tf2_ros
from nav_msgs.msg import OccupancyGrid
from planar import OCCUPIED, Grid, TransformedScans, compose, returns_of
from std_msgs.msg import UInt32MultiArray

PERIOD = 0.5  # [s] between two published grids
RAY_STEPS = 40  # points on each beam at which its way is cleared
REACH = 2.5  # [m] up to which obstacles are marked


class Costmap:
    """The map's obstacles stay; others come and go with the scans."""

    def __init__(self):
        self._grid, self._lock = Grid(rospy.wait_for_message("map", OccupancyGrid)), threading.Lock()
        self._seen = np.zeros(self._grid.cells.shape, bool)
        self._published = rospy.Time(0)
        self._topic = rospy.Publisher("costmap", OccupancyGrid, queue_size=1, latch=True)
        self._counts = rospy.Publisher("costmap/scans", UInt32MultiArray, queue_size=1, latch=True)
        self._buffer = tf2_ros.Buffer()
        self._listener = tf2_ros.TransformListener(self._buffer)
        self._scans = TransformedScans(self._buffer, "scan", "map", self._on_scan)

    def _on_scan(self, scan, map_from_scan):
        hit, x, y = returns_of(scan)
        fractions = np.linspace(0.0, 1.0, RAY_STEPS, endpoint=False)[:, None]
        way = compose(map_from_scan, ((x * fractions).ravel(), (y * fractions).ravel(), 0.0))
        hit &= np.hypot(x, y) < REACH
        ends = compose(map_from_scan, (x[hit], y[hit], 0.0))
        self._seen[self._grid.cells_at(way[0], way[1])] = False
        self._seen[self._grid.cells_at(ends[0], ends[1])] = True
        if abs((scan.header.stamp - self._published).to_sec()) >= PERIOD:
            self._published = scan.header.stamp
            self._publish(scan.header.stamp)

    def _publish(self, stamp):
        message = OccupancyGrid(info=self._grid.info)
        message.header.frame_id, message.header.stamp = "map", stamp
        message.data = np.where(self._seen | (self._grid.cells >= OCCUPIED), 100, 0).astype(np.int8).ravel().tolist()
        self._topic.publish(message)
        self._counts.publish(UInt32MultiArray(data=[self._scans.used, self._scans.dropped]))


if __name__ == "__main__":
    rospy.init_node("costmap")
    Costmap()
    rospy.spin()
