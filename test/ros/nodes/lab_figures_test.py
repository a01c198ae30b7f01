"""The figures that docs/lab.md prints for drives and for its tuning experiments are those of such runs."""

import re

from documentation import ROOT
from dynamic_reconfigure.client import Client
from harness import DEADLINE, SERVER, SystemTest

from aro_robocop_goto_as.goto.params import GotoParams

LAB = " ".join((ROOT / "docs" / "lab.md").read_text(encoding="utf-8").split())
DEFAULTS = {name: getattr(GotoParams(), name) for name in ("angular_gain", "max_angular_velocity")}
TO_THE_RIGHT = (0.0, -0.6)  # the goal of section 10 in odom: map (-0.7, -0.6)


def printed(pattern):
    """The numbers in a sentence of docs/lab.md."""
    found = re.search(pattern, LAB)
    assert found, f"docs/lab.md does not say {pattern!r}"
    return [float(number) for number in found.groups()]


class LabFigures(SystemTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.tuning = Client(SERVER, timeout=DEADLINE)
        cls.addClassCleanup(cls.tuning.update_configuration, DEFAULTS)

    def drive(self, x, y, **values):
        """Drive to a point in odom: seconds it takes, seconds until it drives, angle errors [rad], message."""
        self.tuning.update_configuration({**DEFAULTS, **values})
        goal = self.goals.send(x, y)
        message = goal.result().result.message
        feedback = goal.feedback()
        stamps = [m.header.stamp.to_sec() - feedback[0].header.stamp.to_sec() for m in feedback]
        driving = [stamp for stamp, m in zip(stamps, feedback) if m.feedback.message.startswith("driving")]
        took = re.search(r"after ([\d.]+) s", message)
        self.assertTrue(took, message)
        return float(took[1]), driving[0], [m.feedback.angle_error for m in feedback], message

    def test_the_first_drive(self):
        took, _, _, message = self.drive(1.0, 0.0)
        line = r"REACHED: 0\.098 m from the goal x 1\.00 y 0\.00 in odom after ([\d.]+) s"
        for figure in printed(f"SUCCEEDED: {line} .*{line}"):
            self.assertAlmostEqual(took, figure, delta=0.15)
        self.assertTrue(message.startswith("REACHED: 0.098 m from the goal"), message)

    def test_tuning_as_it_is(self):
        turn, reached = printed(r"turns within ([\d.]+) s and reports REACHED after about (\d+) s")
        took, turned, _, _ = self.drive(*TO_THE_RIGHT)
        self.assertLessEqual(turned, turn)
        self.assertAlmostEqual(took, reached, delta=0.7)

    def test_tuning_with_a_low_gain(self):
        turn, reached = printed(r"the turn takes nearly (\d+) s, .*?REACHED comes after about (\d+) s")
        took, turned, angles, _ = self.drive(*TO_THE_RIGHT, angular_gain=1.0)
        self.assertTrue(turn - 0.5 < turned < turn, turned)
        self.assertAlmostEqual(took, reached, delta=0.7)
        self.assertLess(max(angles), GotoParams().angle_tolerance, "it passes the goal's direction")

    def test_tuning_with_a_high_speed(self):
        (reached,) = printed(r"turns back, and needs about (\d+) s")
        took, _, angles, _ = self.drive(*TO_THE_RIGHT, angular_gain=5.0, max_angular_velocity=2.8)
        self.assertAlmostEqual(took, reached, delta=0.7)
        self.assertGreater(max(angles), 0.5)

    def test_tuning_with_a_high_gain(self):
        (reached,) = printed(
            r"by more than a radian, then to and fro, each time by a little less, and needs about (\d+) s"
        )
        took, _, angles, message = self.drive(*TO_THE_RIGHT, angular_gain=20.0, max_angular_velocity=2.8)
        self.assertTrue(message.startswith("REACHED"), message)
        self.assertAlmostEqual(took, reached, delta=0.7)
        self.assertGreater(max(angles), 1.0)
        self.assertTrue(-max(angles) < min(angles[angles.index(max(angles)) :]) < -0.8, angles)
