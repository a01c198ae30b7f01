"""The grader's only ROS part: a simulator that waits for somebody's nodes, and scenarios driven against them.

It is the simulator itself, on a master of its own: it moves time on tick by tick, and at each one until the submission
has answered, so that neither its speed nor the machine's load decides about points.
"""
