"""RViz's 2D Pose Estimate moves the robot; odometry continues, so map -> odom changes by the jump."""

import math

import rospy
import tf2_ros
from geometry_msgs.msg import PoseWithCovarianceStamped
from harness import SIMULATOR, SystemTest, distance, wait_for, wait_for_subscriber

from aro_robocop_goto_as.geometry import Pose2D, compose
from aro_robocop_goto_as.ros.convert import to_quaternion

SPAWN = Pose2D(-0.7, 0.2, 0.5)  # of the launch file


class Initialpose(SystemTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.buffer = tf2_ros.Buffer()
        cls.listener = tf2_ros.TransformListener(cls.buffer)
        cls.topic = rospy.Publisher("/initialpose", PoseWithCovarianceStamped, queue_size=1)
        wait_for_subscriber(cls.topic, SIMULATOR)

    def send(self, pose, frame="map"):
        """Publish a 2D Pose Estimate."""
        message = PoseWithCovarianceStamped()
        message.header.frame_id = frame
        message.pose.pose.position.x, message.pose.pose.position.y = pose.x, pose.y
        message.pose.pose.orientation = to_quaternion(pose.yaw)
        self.topic.publish(message)

    def wait_until_it_is_at(self, pose):
        """Wait until the robot is at a pose."""
        wait_for(lambda: distance(self.robot.pose(), pose) < 0.005, f"the robot at {pose}")
        self.assertAlmostEqual(self.robot.pose().yaw, pose.yaw, delta=0.01)

    def map_from_base(self):
        """The pose of base_footprint in map, by TF."""
        t = self.buffer.lookup_transform("map", "base_footprint", rospy.Time(0)).transform
        return Pose2D(t.translation.x, t.translation.y, 2.0 * math.atan2(t.rotation.z, t.rotation.w))

    def test_robot_is_moved_and_map_to_odom_changes_by_the_jump(self):
        self.goals.send(0.3, 0.0).result("REACHED")
        self.robot.wait_until_it_stands()
        odom = self.robot.odom_pose()
        there = Pose2D(1.8, 0.0, 2.0)
        self.send(there)
        self.wait_until_it_is_at(there)
        self.assertLess(distance(self.robot.odom_pose(), odom), 0.005)
        wait_for(lambda: distance(self.map_from_base(), there) < 0.005, "TF at the new pose")
        self.assertAlmostEqual(self.map_from_base().yaw, there.yaw, delta=0.01)

    def test_pose_in_odom_is_transformed(self):
        self.send(Pose2D(0.2, 0.0), "odom")
        self.wait_until_it_is_at(compose(SPAWN, Pose2D(0.2, 0.0)))

    def test_pose_in_another_frame_is_refused_and_the_robot_does_not_move(self):
        here = self.robot.pose()
        self.send(Pose2D(1.0, 0.0), "base_scan")
        refusal = "its frame is 'base_scan'; expected 'map'"
        self.goals.log.wait_for(lambda m: "initialpose refused" in m.msg and refusal in m.msg, "a refusal")
        self.assertLess(distance(self.robot.pose(), here), 0.001)
