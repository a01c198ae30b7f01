#!/usr/bin/env python3
"""A node with an unknown or invalid parameter ends at once, and names the parameter and what was expected."""

import itertools
import unittest

from harness import Process, run, script

SIM, SERVER, BRIDGE = "robocop_sim.py", "robocop_goto_as.py", "robocop_rviz_goto_ac.py"


class Parameters(unittest.TestCase):
    numbers = itertools.count()

    def assert_refused(self, *cases):
        """Start all nodes (script, parameters, texts) at once; each fails with these texts."""
        names = [f"node_{next(self.numbers)}" for _ in cases]  # the master keeps parameters after a node has ended
        nodes = [
            Process(script(program), f"__name:={name}", *(f"_{p}" for p in parameters))
            for name, (program, parameters, _) in zip(names, cases)
        ]
        for node, (_, _, texts) in zip(nodes, cases):
            with node:
                self.assertEqual(node.wait_for_exit(), 1, node.output)
                for text in texts:
                    self.assertIn(text, node.output)

    def test_unknown_mistyped_and_impossible_parameters_are_all_named_at_once(self):
        self.assert_refused(
            (
                SIM,
                ["scan_rat:=20", "odom_tf:=maybe", "localization:=magic"],
                [
                    "parameters of /node_",
                    "scan_rat: unknown parameter; did you mean 'scan_rate'?",
                    "odom_tf: expected bool, got str 'maybe'",
                    "localization: expected one of static, truth, none, got 'magic'",
                ],
            ),
            (
                SERVER,
                ["obstacle_distanc:=0.3", "control_rate:=fast", "position_tolerance:=-0.1"],
                [
                    "parameters of /node_",
                    "obstacle_distanc: unknown parameter; did you mean 'obstacle_distance'?",
                    "control_rate: expected float, got str 'fast'",
                    "position_tolerance: expected at least 0.001, got -0.1",
                ],
            ),
            (
                BRIDGE,
                ["goalframe:=odom", "status_period:=true", "cancel_timeout:=-2.0"],
                [
                    "parameters of /node_",
                    "goalframe: unknown parameter; did you mean 'goal_frame'?",
                    "status_period: expected float, got bool True",
                    "cancel_timeout: expected at least 1e-09, got -2.0",
                ],
            ),
        )

    def test_parameters_that_contradict_each_other_are_named(self):
        self.assert_refused(
            (SIM, ["scan_rate:=7"], ["scan_rate: 7 Hz does not divide physics_rate 240 Hz"]),
            (
                SERVER,
                ["min_linear_velocity:=0.5"],
                ["min_linear_velocity: expected at most max_linear_velocity 0.2, got 0.5"],
            ),
        )

    def test_unknown_world_robot_or_spawn_is_named(self):
        self.assert_refused(
            (SIM, ["world:=nowhere"], ["WORLD: there is no world 'nowhere'", "stage_4"]),
            (SIM, ["model:=turtlebot9"], ["ROBOT_MODEL: ", "turtlebot9"]),
            (SIM, ["spawn:=here"], ["spawn: expected 'x y' or 'x y yaw' in metres", "got 'here'"]),
        )


if __name__ == "__main__":
    run(Parameters)
