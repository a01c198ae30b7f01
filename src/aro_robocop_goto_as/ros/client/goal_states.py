"""The states of a goal, by actionlib's numbers."""

from actionlib_msgs.msg import GoalStatus

# Not GoalStatus.to_string: for PENDING, which is 0, it returns the first name whose value equals False.
STATES = {value: name for name, value in vars(GoalStatus).items() if name.isupper() and type(value) is int}
UNFINISHED = ("PENDING", "ACTIVE", "PREEMPTING", "RECALLING")
