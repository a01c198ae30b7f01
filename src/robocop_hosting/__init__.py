"""Somebody else's package: found, built in a workspace of its own, its launch file read, and run with this simulator.

The grader and `robocop sim --with` (sim_with) share it. It imports the lab, never the grader.
"""
