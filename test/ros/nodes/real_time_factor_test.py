#!/usr/bin/env python3
"""The simulator publishes the achieved real-time factor, and warns when it is below the requested one."""

import time
import unittest

from harness import SIMULATOR, Process, Recorder, run, script
from rosgraph_msgs.msg import Clock, Log
from std_msgs.msg import Float64


class RealTimeFactor(unittest.TestCase):
    def run_simulator(self, factor, warned=False):
        """Three published factors, the factor of /clock over the same time, and the simulator's warnings."""
        with Process(
            script("robocop_sim.py"), f"__name:={SIMULATOR[1:]}", f"_real_time_factor:={factor}", "_world:=empty"
        ):
            clock, log = Recorder("/clock", Clock), Recorder("/rosout", Log, wait=False)
            published = Recorder(f"{SIMULATOR}/real_time_factor", Float64)
            published.next()  # that of the start, or part of it
            began, simulated = time.monotonic(), clock.newest().clock
            factors = [m.data for m in published.next(3)]
            passed, simulated = time.monotonic() - began, (clock.newest().clock - simulated).to_sec()
            if warned:
                log.wait_for(lambda m: m.name == SIMULATOR and m.level == Log.WARN, "a warning")
            warnings = [m.msg for m in log.messages if m.name == SIMULATOR and m.level == Log.WARN]
            return factors, simulated / passed, warnings

    def test_achievable_factor_is_kept_and_published(self):
        # A quarter of real time costs a few percent of a core, which a busy machine has left.
        published, measured, warnings = self.run_simulator(0.25)
        for factor in (*published, measured):
            self.assertAlmostEqual(factor, 0.25, delta=0.04)
        self.assertEqual(warnings, [])

    def test_unachievable_factor_is_reported_with_the_achieved_one_and_a_warning(self):
        published, measured, warnings = self.run_simulator(1e6, warned=True)  # the highest, which no machine reaches
        self.assertTrue(min(published) * 0.7 < measured < max(published) * 1.3, (published, measured))
        self.assertLess(max(published), 0.9e6)
        self.assertRegex(
            warnings[0], r"^real-time factor \d+\.\d\d achieved, 1000000\.00 requested: this machine is too slow"
        )


if __name__ == "__main__":
    run(RealTimeFactor)
