"""Finds somebody else's package, builds it in its own workspace, reads its launch file, runs it with this simulator.

The grader and `robocop sim --with` (sim_with) share this package. It imports the lab, never the grader.
"""
