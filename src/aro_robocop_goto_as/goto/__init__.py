"""The lab's rule for driving to a goal: its parameters, what is ahead of the robot, a decision in each period."""
