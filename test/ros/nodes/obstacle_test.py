#!/usr/bin/env python3
"""A goal behind an obstacle is aborted before the robot touches the obstacle."""

from harness import SystemTest, distance, run

from aro_robocop_goto_as.geometry import Pose2D

PILLAR = Pose2D(0.4, 0.5)  # pillar_1 of the default world
PILLAR_RADIUS = 0.12  # [m]
ROBOT_RADIUS = 0.105  # [m]
SCANNER_BEHIND = 0.032  # [m] from base_footprint back to base_scan


class Obstacle(SystemTest):
    def send_goal_behind_the_pillar(self):
        """The result of a goal half a metre behind the pillar, seen from the spawn."""
        spawn = self.robot.pose()
        way = Pose2D(PILLAR.x - spawn.x, PILLAR.y - spawn.y)
        beyond = 1.0 + 0.5 / distance(spawn, PILLAR)
        return self.goals.send(beyond * way.x, beyond * way.y).result("OBSTACLE").result

    def test_goal_behind_a_pillar_is_aborted_before_contact(self):
        result = self.send_goal_behind_the_pillar()
        stands = distance(self.robot.wait_until_it_stands(), PILLAR) - PILLAR_RADIUS
        self.assertFalse(result.success)
        self.assertRegex(result.message, r"^OBSTACLE: obstacle 0\.(2\d\d|300) m ahead \(limit 0\.3 m\); ")
        nearest = min(distance(pose, PILLAR) for pose in self.robot.path()) - PILLAR_RADIUS
        self.assertGreater(nearest - ROBOT_RADIUS, 0.1)  # the gap between them
        self.assertGreater(nearest, stands - 0.01)
        self.assertLess(stands + SCANNER_BEHIND, 0.3 + 0.02)  # it drove up to the limit


if __name__ == "__main__":
    run(Obstacle)
