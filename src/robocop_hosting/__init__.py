"""Finds somebody else's package, builds it in its own workspace, reads its launch file, runs it with this simulator.

The grader and `robocop sim --with` (sim_with) share this package, which imports the lab, never the grader. They also
share what starts child processes and ends all that these leave behind, free ports, and locks of files.
"""
