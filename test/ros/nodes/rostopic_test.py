"""As in the handout, `rostopic pub` sends a goal, and `rostopic echo` shows its feedback and result."""

import xmlrpc.client

import rosgraph
import rospy
from harness import ACTION, SERVER, SystemTest, wait_for
from systems import Process


def rostopic_subscribes(topic):
    """Whether the server is connected to a rostopic process, /rostopic_PID_TIME, on a topic."""
    server = xmlrpc.client.ServerProxy(rosgraph.Master(rospy.get_name()).lookupNode(SERVER))
    _, _, connections = server.getBusInfo(rospy.get_name())
    return any(
        direction == "o" and name == topic and str(node).startswith("/rostopic_")
        for _, node, direction, _, name, *_ in connections
    )


class Rostopic(SystemTest):
    def test_goal_of_rostopic_pub_is_reached_and_rostopic_echo_shows_feedback_and_result(self):
        with Process("rostopic", "echo", "-n", "1", f"/{ACTION}/result") as result, Process(
            "rostopic", "echo", "-n", "1", f"/{ACTION}/feedback"
        ) as feedback:
            for topic in ("result", "feedback"):
                wait_for(
                    lambda name=topic: rostopic_subscribes(f"/{ACTION}/{name}"),
                    f"rostopic echo is connected to the {topic}",
                )
            with Process(
                "rostopic",
                "pub",
                f"/{ACTION}/goal",
                "aro_robocop_goto_as/GoToPositionActionGoal",
                "{goal: {position: {x: 0.3, y: 0.1, z: 0.0}}}",
            ):
                self.assertEqual(feedback.wait_for_exit(), 0)
                self.assertEqual(result.wait_for_exit(), 0)
        self.assertRegex(feedback.output, r"(?m)^  position_error: 0\.\d+$")
        self.assertRegex(feedback.output, r"(?m)^  angle_error: -?0\.\d+$")
        self.assertRegex(result.output, r"(?m)^  status: 3$")
        self.assertRegex(result.output, r"(?m)^  success: True$")
        self.assertRegex(
            result.output, r'(?m)^  message: "REACHED: 0\.(0..|100) m from the goal x 0\.30 y 0\.10 in odom '
        )
        self.robot.wait_until_it_stands()
