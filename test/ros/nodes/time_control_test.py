"""Control of simulated time: real-time factor, steps and poses."""

import rospy
from aro_robocop_goto_as.msg import SimStatus
from aro_robocop_goto_as.srv import SetPose, SetPoseRequest, Step
from dynamic_reconfigure.client import Client
from harness import SIMULATOR, Recorder, SystemTest, call_simulator, distance, wait_for, wait_for_connection
from nav_msgs.msg import Odometry

from aro_robocop_goto_as.geometry import Pose2D
from aro_robocop_goto_as.ros.convert import to_quaternion


def service(name, kind):
    rospy.wait_for_service(f"{SIMULATOR}/{name}", 60.0)
    return rospy.ServiceProxy(f"{SIMULATOR}/{name}", kind)


class TimeControl(SystemTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.status = Recorder(f"{SIMULATOR}/status", SimStatus)
        cls.step, cls.set_pose = service("step", Step), service("set_pose", SetPose)

    def tearDown(self):
        call_simulator("unpause")
        super().tearDown()

    def test_a_step_publishes_all_messages_of_its_duration_and_then_time_stops(self):
        call_simulator("pause")
        odom = Recorder("odom", Odometry)
        wait_for_connection(SIMULATOR, "odom")
        before = self.step(0.0).stamp
        answer = self.step(2.0)
        self.assertTrue(answer.success, answer.message)
        self.assertAlmostEqual((answer.stamp - before).to_sec(), 2.0, places=6)

        def stepped():
            return [m for m in odom.messages if m.header.stamp > before]  # others may arrive after the first answer

        wait_for(lambda: len(stepped()) == 60, lambda: f"60 messages, there are {len(stepped())}")
        self.assertLessEqual(odom.messages[-1].header.stamp, answer.stamp)
        self.assertAlmostEqual((self.step(0.0).stamp - answer.stamp).to_sec(), 1.0 / 240.0, places=6)

    def test_the_real_time_factor_follows_dynamic_reconfigure(self):
        client = Client(SIMULATOR[1:], timeout=60)
        client.update_configuration({"real_time_factor": 2.0})
        self.status.wait_for(lambda m: m.factor_asked == 2.0, "factor 2")
        self.assertEqual(client.update_configuration({"real_time_factor": -3.0})["real_time_factor"], 2.0)
        self.goals.log.wait_for(lambda m: "expected a number, 0 or more, got -3; keeping 2" in m.msg, "a complaint")
        client.update_configuration({"real_time_factor": 4.0})
        self.status.wait_for(lambda m: m.factor_asked == 4.0, "factor 4", len(self.status))

    def test_set_pose_moves_the_robot_or_names_the_problem(self):
        request = SetPoseRequest()
        request.pose.header.frame_id = "map"
        request.pose.pose.position.x, request.pose.pose.position.y = 1.5, -0.4
        request.pose.pose.orientation = to_quaternion(1.0)
        answer = self.set_pose(request)
        self.assertTrue(answer.success, answer.message)
        wait_for(lambda: distance(self.robot.pose(), Pose2D(1.5, -0.4)) < 0.001, "the robot there")
        request.pose.pose.position.x = 2.3
        answer = self.set_pose(request)
        self.assertFalse(answer.success)
        self.assertIn("x 2.300 y -0.400 is 0.050 m from 'walls/link/east'", answer.message)
        request.robot = "robot_9"
        self.assertIn("robot 'robot_9' is not one of: ''", self.set_pose(request).message)
