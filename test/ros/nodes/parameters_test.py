#!/usr/bin/env python3
"""A node with unknown and invalid parameters ends at once, and names each of them and what was expected."""

import unittest

from harness import run, script
from systems import Process

NODES = {  # program: (parameters, what it says of them)
    "robocop_sim.py": (
        ["scan_rat:=20", "odom_tf:=maybe", "localization:=magic"],
        [
            "scan_rat: unknown parameter; did you mean 'scan_rate'?",
            "odom_tf: expected bool, got str 'maybe'",
            "localization: expected one of static, truth, none, got 'magic'",
        ],
    ),
    "robocop_goto_as.py": (
        ["obstacle_distanc:=0.3", "control_rate:=fast", "position_tolerance:=-0.1"],
        [
            "obstacle_distanc: unknown parameter; did you mean 'obstacle_distance'?",
            "control_rate: expected float, got str 'fast'",
            "position_tolerance: expected at least 0.001, got -0.1",
        ],
    ),
    "robocop_rviz_goto_ac.py": (
        ["goalframe:=odom", "status_period:=true", "cancel_timeout:=-2.0"],
        [
            "goalframe: unknown parameter; did you mean 'goal_frame'?",
            "status_period: expected float, got bool True",
            "cancel_timeout: expected at least 1e-09, got -2.0",
        ],
    ),
}


class Parameters(unittest.TestCase):
    def test_unknown_mistyped_and_impossible_parameters_are_all_named_at_once(self):
        nodes = {
            program: Process(script(program), f"__name:={program[:-3]}", *(f"_{p}" for p in parameters))
            for program, (parameters, _) in NODES.items()
        }
        for program, node in nodes.items():
            with node:
                self.assertEqual(node.wait_for_exit(), 1, node.output)
                for text in [f"parameters of /{program[:-3]}", *NODES[program][1]]:
                    self.assertIn(text, node.output)


if __name__ == "__main__":
    run(Parameters)
