#!/usr/bin/env python3
"""A simulator that never waits accepts subscribers: its loop lets rospy's threads have the interpreter."""

import unittest

from harness import SIMULATOR, Recorder, run, script
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan
from systems import Process

ROUNDS = 10


class FullSpeed(unittest.TestCase):
    def test_each_of_many_subscribers_gets_messages(self):
        arguments = ("_real_time_factor:=0", "_sync:=lockstep", "_drive:=wheels", "_world:=empty")
        with Process(script("robocop_sim.py"), f"__name:={SIMULATOR[1:]}", *arguments):
            for _ in range(ROUNDS):
                recorders = [Recorder("odom", Odometry), Recorder("scan", LaserScan), Recorder("/clock", Clock)]
                for recorder in recorders:
                    recorder.next()
                for recorder in recorders:
                    recorder.close()


if __name__ == "__main__":
    run(FullSpeed)
