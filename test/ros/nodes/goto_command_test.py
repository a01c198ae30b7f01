"""`./robocop goto X Y` in a running system: progress, result or the reason, and exit status."""

import signal

from dynamic_reconfigure.client import Client
from harness import SIMULATOR, SystemTest, distance, script
from systems import Process

from aro_robocop_goto_as.geometry import Pose2D


class GotoCommand(SystemTest):
    def test_goal_is_in_map_and_is_reached_with_progress_result_and_exit_status_0(self):
        target = Pose2D(-0.5, 0.2)  # the robot starts at (-0.7, 0), where odom is
        with Process(script("robocop_goto.py"), target.x, target.y) as command:
            self.assertEqual(command.wait_for_exit(), 0, command.output)
        self.assertRegex(command.output, r"(?m)^distance +0\.\d\d m +angle +[+-]0\.\d\d rad +rotating")
        self.assertRegex(command.output, r"(?m)^SUCCEEDED: REACHED: ")
        self.assertLess(distance(self.robot.wait_until_it_stands(), target), 0.12)

    def test_goal_behind_an_obstacle_is_reported_with_exit_status_1(self):
        with Process(script("robocop_goto.py"), 1.6, 0.73, "--frame", "odom") as command:  # behind pillar_1
            self.assertEqual(command.wait_for_exit(), 1, command.output)
        self.assertRegex(command.output, r"(?m)^ABORTED: OBSTACLE: obstacle ")

    def test_an_unknown_frame_is_reported_in_the_words_of_tf2_and_nothing_is_sent(self):
        with Process(script("robocop_goto.py"), "0.5", "0.0", "--frame", "base_footprnt") as command:
            self.assertEqual(command.wait_for_exit(), 1, command.output)
        self.assertIn("no transform from 'base_footprnt' to 'odom'", command.output)
        self.assertIn('"base_footprnt" passed to lookupTransform argument source_frame does not exist', command.output)
        self.assertEqual(self.goals.sent.messages, [])

    def test_interrupted_command_cancels_its_goal(self):
        client = Client(SIMULATOR[1:], timeout=60)
        client.update_configuration({"real_time_factor": 0.25})  # so that the robot still drives when it is interrupted
        self.addCleanup(client.update_configuration, {"real_time_factor": 4.0})  # of the launch file
        with Process(script("robocop_goto.py"), 2.0, 0.0) as command:
            self.robot.wait_until_it_drives()
            command.send_signal(signal.SIGINT)
            self.assertEqual(command.wait_for_exit(), 1, command.output)
        self.assertRegex(command.output, r"(?m)^PREEMPTED: goal ")
        self.robot.wait_until_it_stands()
