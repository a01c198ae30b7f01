#!/usr/bin/env python3
"""`./robocop goto X Y` in a running system: progress, result and exit status."""

from harness import Process, SystemTest, distance, run, script

from aro_robocop_goto_as.geometry import Pose2D


class GotoCommand(SystemTest):
    def test_goal_is_in_map_and_is_reached_with_progress_result_and_exit_status_0(self):
        target = Pose2D(-0.5, 0.2)  # the robot starts at (-0.7, 0), where odom is
        with Process(script("robocop_goto.py"), target.x, target.y) as command:
            self.assertEqual(command.wait_for_exit(), 0, command.output)
        self.assertRegex(command.output, r"(?m)^distance +0\.\d\d m +angle +[+-]0\.\d\d rad +rotating")
        self.assertRegex(command.output, r"(?m)^SUCCEEDED: REACHED: ")
        self.assertLess(distance(self.robot.wait_until_it_stands(), target), 0.12)


if __name__ == "__main__":
    run(GotoCommand)
