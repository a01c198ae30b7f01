"""The processes that control the robots of a case; each prints "ready" and then "running", on lines of their own."""

import itertools
import sys
from typing import Any, Dict, List

import actionlib
import rospy
from aro_robocop_goto_as.msg import GoToPositionAction, GoToPositionGoal
from geometry_msgs.msg import Twist, Vector3
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan

RATE = 10  # [Hz] of simulated time
FIRST = 5  # cycles before the simulator waits for the loop
POLL = 0.05  # [s, wall]
GOALS = ((0.5, 0.5), (0.5, -0.5))  # x, y [m] in odom, between the obstacles of worlds/bench.sdf
VELOCITY = Twist(Vector3(0.1, 0.0, 0.0), Vector3(0.0, 0.0, 0.5))  # as in cases.py


def constant_velocity(namespaces: List[str]) -> None:
    """One latched velocity command for every robot."""
    publishers = [rospy.Publisher(robot + "cmd_vel", Twist, latch=True, queue_size=1) for robot in namespaces]
    for publisher in publishers:
        publisher.publish(VELOCITY)
    print("ready", flush=True)
    while not (rospy.is_shutdown() or all(publisher.get_num_connections() for publisher in publishers)):
        rospy.rostime.wallsleep(POLL)
    print("running", flush=True)
    rospy.spin()


def rospy_loop() -> None:
    """Velocity commands from a loop as in a tutorial, which knows nothing of lockstep."""
    newest: Dict[str, Any] = {}
    rospy.Subscriber("scan", LaserScan, lambda message: newest.update(scan=message), queue_size=1)
    rospy.Subscriber("odom", Odometry, lambda message: newest.update(odom=message), queue_size=1)
    publisher = rospy.Publisher("cmd_vel", Twist, queue_size=1)
    print("ready", flush=True)
    rate = rospy.Rate(RATE)
    cycles = 0
    while not rospy.is_shutdown():
        publisher.publish(VELOCITY)
        rate.sleep()
        cycles += len(newest) == 2
        if cycles == FIRST:
            print("running", flush=True)


def goal_loop() -> None:
    """One goal after another for the action server."""
    client = actionlib.SimpleActionClient("robocop_goto_as", GoToPositionAction)
    print("ready", flush=True)
    client.wait_for_server()
    goal = GoToPositionGoal()
    for goal.position.x, goal.position.y in itertools.cycle(GOALS):
        client.send_goal_and_wait(goal)
        if rospy.is_shutdown():
            return
        print("running", flush=True)


if __name__ == "__main__":
    rospy.init_node("robocop_bench_controller")
    try:
        {"rospy": rospy_loop, "server": goal_loop}.get(sys.argv[1], lambda: constant_velocity(sys.argv[1:]))()
    except rospy.ROSInterruptException:
        pass
