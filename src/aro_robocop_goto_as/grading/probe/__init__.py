"""The only part of the grader that uses ROS: the simulator, in lockstep with a submission, and the scenarios.

Simulated time advances tick by tick, each time after the submission has answered, so that neither its speed nor the
machine's load affects the points. The ROS master is the probe's own.
"""
