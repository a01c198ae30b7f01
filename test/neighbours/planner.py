#!/usr/bin/env python3
"""As move_base: planner/goal and costmap -> a way, followed by commands at 20 Hz while map -> base is recent.

Its state is on planner/status: ACTIVE, SUCCEEDED or ABORTED, with the goal's number as id.
"""

import contextlib
import heapq
import math

import numpy as np
import rospy
import tf2_geometry_msgs
import tf2_ros
from actionlib_msgs.msg import GoalID, GoalStatus, GoalStatusArray
from geometry_msgs.msg import PoseStamped, Twist
from nav_msgs.msg import OccupancyGrid
from planar import OCCUPIED, Grid, pose_of, rings, wrap

RATE = 20.0  # [Hz] move_base's controller_frequency
TRANSFORM_TOLERANCE = 0.5  # [s] age of map -> base up to which it may be used
CLEARANCE, COMFORT = 0.17, 0.35  # [m] from obstacles: the least, and from where on it costs nothing
REPLAN = 1.0  # [s]
AHEAD = 0.25  # [m] on the way, of the point that is steered to
REACHED = 0.08  # [m]
V, W = 0.2, 1.0  # [m/s], [rad/s] at most
NEIGHBOURS = [(r, c, math.hypot(r, c)) for r in (-1, 0, 1) for c in (-1, 0, 1) if r or c]


class Planner:
    """Callbacks store; the loop plans and drives."""

    def __init__(self):
        self._grid = self._goal = None
        self._number, self._state, self._way, self._planned = 0, GoalStatus.SUCCEEDED, [], None
        self._command = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self._status = rospy.Publisher("planner/status", GoalStatusArray, queue_size=10, latch=True)
        self._buffer = tf2_ros.Buffer()
        self._listener = tf2_ros.TransformListener(self._buffer)
        rospy.Subscriber("costmap", OccupancyGrid, self._on_costmap)
        rospy.Subscriber("planner/goal", PoseStamped, self._on_goal)

    def _on_costmap(self, message):
        self._grid = Grid(message)

    def _on_goal(self, message):
        self._goal = message

    def run(self):
        """One command in each period while a goal is active; without one, none."""
        rate = rospy.Rate(RATE, reset=True)
        while not rospy.is_shutdown():
            if self._goal is not None:
                self._accept()
            if self._state == GoalStatus.ACTIVE:
                self._command.publish(self._drive())
            rate.sleep()

    def _accept(self):
        goal, self._goal = self._goal, None
        try:
            at = self._buffer.transform(goal, "map", rospy.Duration(1.0)).pose.position
        except tf2_ros.TransformException as error:
            rospy.logwarn("the goal can't be transformed: %s", error)
            return
        self._target, self._planned = (at.x, at.y), None
        self._number += 1
        self._set(GoalStatus.ACTIVE)

    def _set(self, state):
        self._state = state
        self._status.publish(GoalStatusArray(status_list=[GoalStatus(GoalID(id=str(self._number)), state, "")]))

    def _drive(self):
        """The command of this period; stands while the pose is too old."""
        now = rospy.Time.now()
        try:
            found = self._buffer.lookup_transform("map", "base_footprint", rospy.Time(0))
        except tf2_ros.TransformException:
            return Twist()
        if abs((now - found.header.stamp).to_sec()) > TRANSFORM_TOLERANCE or self._grid is None:
            return Twist()
        pose = pose_of(found)
        if math.hypot(self._target[0] - pose[0], self._target[1] - pose[1]) < REACHED:
            self._set(GoalStatus.SUCCEEDED)
            return Twist()
        if self._planned is None or not 0.0 <= (now - self._planned).to_sec() < REPLAN:
            self._planned, self._way = now, plan(self._grid, pose, self._target)
        if not self._way:
            return Twist()  # until the next plan
        return follow(pose, self._way)


def plan(grid, start, target):
    """Points from the start to the target [m], away from obstacles; empty if there is no way."""
    distance = rings(grid.cells >= OCCUPIED, round(COMFORT / grid.resolution) + 1) * grid.resolution
    closed = distance < CLEARANCE
    cost = 1.0 + 8.0 * np.clip((COMFORT - distance) / COMFORT, 0.0, 1.0)
    begin, end = (tuple(int(index) for index in grid.cells_at(x, y)) for x, y in (start[:2], target))
    closed[begin] = False
    closed, cost = closed.tolist(), cost.tolist()  # whose elements are faster to get than an array's
    rows, columns = len(closed), len(closed[0])
    known, came, queue = {begin: 0.0}, {}, [(0.0, begin)]
    while queue:
        _, cell = heapq.heappop(queue)
        if cell == end:
            way = [target]
            while cell in came:
                cell = came[cell]
                way.append(grid.point_at(*cell))
            return way[::-1]
        for row, column, length in NEIGHBOURS:
            there = cell[0] + row, cell[1] + column
            if not (0 <= there[0] < rows and 0 <= there[1] < columns) or closed[there[0]][there[1]]:
                continue
            through = known[cell] + length * cost[there[0]][there[1]]
            if through < known.get(there, math.inf):
                known[there], came[there] = through, cell
                heapq.heappush(queue, (through + math.hypot(there[0] - end[0], there[1] - end[1]), there))
    return []


def follow(pose, way):
    """The command that steers to the point on the way that is AHEAD of its nearest point."""
    distances = [math.hypot(x - pose[0], y - pose[1]) for x, y in way]
    nearest = distances.index(min(distances))
    x, y = next((point for point, far in zip(way[nearest:], distances[nearest:]) if far > AHEAD), way[-1])
    error = wrap(math.atan2(y - pose[1], x - pose[0]) - pose[2])
    twist = Twist()
    twist.angular.z = max(-W, min(W, 2.0 * error))
    if abs(error) < 0.7:
        twist.linear.x = V * math.cos(error) * min(1.0, 0.3 + distances[-1])
    return twist


if __name__ == "__main__":
    rospy.init_node("planner")
    assert tf2_geometry_msgs  # registers the types that the buffer can transform
    with contextlib.suppress(rospy.ROSInterruptException):
        Planner().run()
