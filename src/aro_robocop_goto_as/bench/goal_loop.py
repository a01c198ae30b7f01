"""A client of the action server that sends it one goal after another."""

import itertools

import actionlib
import rospy

from aro_robocop_goto_as.msg import GoToPositionAction, GoToPositionGoal

GOALS = ((0.5, 0.5), (0.5, -0.5))  # x, y [m] in odom, between the obstacles of worlds/bench.sdf


def main() -> None:
    """Send goals until the node is shut down; the line on the standard output says that the server is driving."""
    client = actionlib.SimpleActionClient("robocop_goto_as", GoToPositionAction)
    client.wait_for_server()
    for number, (x, y) in enumerate(itertools.cycle(GOALS)):
        goal = GoToPositionGoal()
        goal.position.x, goal.position.y = x, y
        client.send_goal(goal)
        client.wait_for_result()
        if rospy.is_shutdown():
            return
        if number == 0:
            print("running", flush=True)


if __name__ == "__main__":
    rospy.init_node("goal_loop")
    try:
        main()
    except rospy.ROSInterruptException:
        pass
