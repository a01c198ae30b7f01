#!/usr/bin/env python3
"""The tests of several modules in one test node, as each start of a node takes 2 s: run_tests.py MODULE..."""

import unittest

import rospy
import rostest
from harness import PACKAGE


def suite():
    """All tests of the modules on the command line."""
    modules = [word for word in rospy.myargv()[1:] if not word.startswith("--")]
    return unittest.defaultTestLoader.loadTestsFromNames(modules)


if __name__ == "__main__":
    rospy.init_node("run_tests")
    rostest.rosrun(PACKAGE, "run_tests", "__main__.suite")
