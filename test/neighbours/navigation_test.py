#!/usr/bin/env python3
"""A navigation stack beside the simulator: a particle filter localizes, a costmap sees, a planner drives."""

import math
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "ros" / "nodes"))

import rospy
import tf2_ros
from actionlib_msgs.msg import GoalStatus, GoalStatusArray
from aro_robocop_goto_as.srv import SpawnModel
from geometry_msgs.msg import Pose, PoseStamped, PoseWithCovarianceStamped
from harness import BRIDGE, Goals, Recorder, Robot, distance, run, wait_for, wait_for_subscriber
from nav_msgs.msg import OccupancyGrid
from nav_msgs.srv import GetMap
from planar import OCCUPIED, Grid, pose_of
from std_msgs.msg import UInt32MultiArray
from tf2_msgs.msg import TFMessage

DRIVING = 150.0  # [s, wall] for one goal, on a busy machine
OFF = 0.25  # [m] that the robot may be from its goal: the planner's tolerance, and the error of the estimate
ERROR = 0.15  # [m] of the estimate, a cell and a half of the coarser map
TOLERANCE = 0.1  # [s] by which the particle filter dates map -> odom into the future
BOX = """<sdf version="1.6"><model name="box"><static>true</static><link name="link"><collision name="c"><geometry><box>
<size>0.3 0.3 0.5</size></box></geometry></collision></link></model></sdf>"""


def points(parameter):
    """The points "x y, x y" of a parameter [m]."""
    return [tuple(map(float, point.split())) for point in rospy.get_param(parameter).split(",")]


class Navigation(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.in_lockstep = rospy.get_param("/robocop_sim/sync", "free") == "lockstep"
        cls.robot, cls.tf = Robot(), Recorder("/tf", TFMessage)
        cls.status = Recorder("planner/status", GoalStatusArray, wait=False)
        cls.costmap, cls.scans = Recorder("costmap", OccupancyGrid), Recorder("costmap/scans", UInt32MultiArray)
        cls.goal = rospy.Publisher("planner/goal", PoseStamped, queue_size=1)
        wait_for_subscriber(cls.goal, "/planner")
        cls.buffer = tf2_ros.Buffer()
        cls.listener = tf2_ros.TransformListener(cls.buffer)

    def assert_figure(self, value, low, high, what):
        """A figure is within these bounds in lockstep; in free time it depends on how far the nodes fall behind."""
        if self.in_lockstep:
            self.assertTrue(low < value < high, f"{what}: {value}, expected {low} to {high}")

    def drive_to(self, x, y):
        """Have the planner drive to a point in map [m]."""
        start = len(self.status)
        self.goal.publish(stamped(x, y))
        wait_for(lambda: self.ended(start), lambda: f"({x}, {y}) reached; the robot is at {self.robot.pose()}", DRIVING)
        self.assert_it_stands_at(x, y)

    def assert_it_stands_at(self, x, y):
        """The robot stands, near a point [m]."""
        at = self.robot.wait_until_it_stands()
        self.assert_figure(math.hypot(at.x - x, at.y - y), -math.inf, OFF, "distance from the goal [m]")

    def ended(self, start):
        states = [status.status for message in self.status.messages[start:] for status in message.status_list]
        return states[-1:] == [GoalStatus.SUCCEEDED]

    def error_of_estimate(self):
        """How far map -> base is from the truth [m], for a robot that stands."""
        truth = self.robot.wait_for_standstill()
        stamp = self.robot.truth.newest().header.stamp
        wait_for(lambda: self.buffer.can_transform("map", "base_footprint", stamp), "an estimate of now")
        x, y, _ = pose_of(self.buffer.lookup_transform("map", "base_footprint", stamp))
        return math.hypot(x - truth.x, y - truth.y)

    def test_1_map_of_the_topic_is_the_services_and_shows_the_free_spawn(self):
        grid = Recorder("map", OccupancyGrid).newest()
        rospy.wait_for_service("static_map", 60.0)
        self.assertEqual(rospy.ServiceProxy("static_map", GetMap)().map.data, grid.data)
        at = self.robot.pose()
        row, column = Grid(grid).cells_at([at.x], [at.y])
        self.assertEqual(Grid(grid).cells[row[0], column[0]], 0)

    def test_2_transform_of_the_future_leaves_truth_and_odometry_alone(self):
        start = len(self.tf)
        message = self.tf.wait_for(lambda m: m.transforms[0].child_frame_id == "odom", "map -> odom", start)
        odometry = self.robot.odom.wait_for(
            lambda m: m.header.stamp >= message.transforms[0].header.stamp - rospy.Duration.from_sec(TOLERANCE),
            "odometry",
        )
        self.assertEqual(odometry.header.frame_id, "odom")
        senders = {
            m._connection_header["callerid"] for m in self.tf.messages if m.transforms[0].child_frame_id == "odom"
        }
        self.assertEqual(senders, {"/particle_filter"})

    def test_3_initial_pose_moves_the_estimate_and_not_the_robot(self):
        before = self.robot.wait_for_standstill()
        estimates = Recorder("amcl_pose", PoseWithCovarianceStamped)
        topic = rospy.Publisher("initialpose", PoseWithCovarianceStamped, queue_size=1)
        wait_for_subscriber(topic, "/particle_filter")
        start = len(estimates)
        topic.publish(initial_pose(before.x + 0.1, before.y - 0.1, before.yaw))
        estimates.wait_for(lambda m: m.pose.covariance[0] > 0.0, "an estimate with a covariance", start)
        wait_for(lambda: self.error_of_estimate() < 0.3, lambda: f"error {self.error_of_estimate():.2f} m")
        self.assertLess(distance(self.robot.wait_for_standstill(), before), 0.002)

    def test_4_planner_reaches_its_goals_and_the_estimate_stays_true(self):
        for x, y in points("~goals"):
            self.drive_to(x, y)
            self.assert_figure(self.error_of_estimate(), -math.inf, ERROR, "error of the estimate [m]")

    def test_5_obstacle_that_is_not_in_the_map_is_seen_and_avoided(self):
        (x, y), behind = points("~obstacle")
        rospy.wait_for_service("/robocop_sim/spawn_model", 60.0)
        pose = Pose()
        pose.position.x, pose.position.y, pose.orientation.w = x, y, 1.0
        answer = rospy.ServiceProxy("/robocop_sim/spawn_model", SpawnModel)("box", BOX, "", pose)
        self.assertTrue(answer.success, answer.message)
        self.robot.clear()
        self.drive_to(*behind)
        self.costmap.wait_for(lambda m: occupied_near(Grid(m), x, y), "the box in the costmap")
        nearest = min(max(abs(at.x - x), abs(at.y - y)) for at in self.robot.path())
        self.assert_figure(nearest, 0.15 + 0.1, math.inf, "the robot's middle from the box, whose half is 0.15 m")

    def test_6_click_in_map_is_driven_to_by_way_of_the_filters_transform(self):
        goals = Goals()
        click = rospy.Publisher("move_base_simple/goal", PoseStamped, queue_size=1)
        wait_for_subscriber(click, BRIDGE)
        at = self.robot.wait_for_standstill()
        x, y = at.x + 0.4 * math.cos(at.yaw + math.pi), at.y + 0.4 * math.sin(at.yaw + math.pi)  # where it came from
        click.publish(stamped(x, y))
        (goal,) = wait_for(goals.of_others, "the bridge's goal")
        goal.result("REACHED")
        self.assert_it_stands_at(x, y)

    def test_7_costmap_could_use_the_scans(self):
        used, dropped = self.scans.newest().data
        self.assertGreater(used, 0)
        self.assert_figure(used, 100, math.inf, "scans that were used")
        self.assert_figure(dropped, -math.inf, 0.1 * used, "scans that were dropped")

    def test_8_scan_older_than_the_buffer_is_dropped_and_the_next_one_used(self):
        from sensor_msgs.msg import LaserScan

        topic = rospy.Publisher("scan", LaserScan, queue_size=1)
        wait_for_subscriber(topic, "/costmap")
        used, dropped = self.scans.newest().data
        scan = Recorder("scan", LaserScan).newest()
        scan.header.stamp = rospy.Time(1)
        topic.publish(scan)
        self.scans.wait_for(lambda m: m.data[1] > dropped, "a scan that is dropped")
        self.scans.wait_for(lambda m: m.data[0] > used + 10, "scans that are used after it")
        topic.unregister()


def occupied_near(grid, x, y):
    """Whether a cell within 0.2 m of a point is an obstacle."""
    (top, bottom), (left, right) = grid.cells_at([x - 0.2, x + 0.2], [y - 0.2, y + 0.2])
    return (grid.cells[top : bottom + 1, left : right + 1] >= OCCUPIED).any()


def stamped(x, y):
    """A pose in map of now."""
    pose = PoseStamped()
    pose.header.frame_id, pose.header.stamp = "map", rospy.Time.now()
    pose.pose.position.x, pose.pose.position.y, pose.pose.orientation.w = x, y, 1.0
    return pose


def initial_pose(x, y, yaw):
    """As RViz's 2D Pose Estimate."""
    message = PoseWithCovarianceStamped()
    message.header.frame_id, message.header.stamp = "map", rospy.Time.now()
    message.pose.pose = stamped(x, y).pose
    message.pose.pose.orientation.z, message.pose.pose.orientation.w = math.sin(yaw / 2.0), math.cos(yaw / 2.0)
    message.pose.covariance[0] = message.pose.covariance[7] = 0.04
    message.pose.covariance[35] = 0.03
    return message


if __name__ == "__main__":
    run(Navigation)
