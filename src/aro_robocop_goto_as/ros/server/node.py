"""robocop_goto_as: GoToPosition goals -> the lab's loop -> cmd_vel, feedback, result."""

import threading
import time
import traceback
from typing import Optional

import rospy
from geometry_msgs.msg import Twist
from visualization_msgs.msg import MarkerArray

from aro_robocop_goto_as.msg import GoToPositionFeedback, GoToPositionResult, TickAnswer

from ...errors import RobocopError
from ...geometry import STANDSTILL, Twist2D
from ...goto import Outcome
from ...params import GotoParams
from .. import convert, param_server, private_api
from ..node_main import node
from ..publishing import publisher
from ..ticker import Ticker
from ..timer import start_timer
from . import markers
from .goal_execution import Ending, GoalExecution
from .goal_server import GoalServer
from .inputs import Inputs
from .tuning import Tuning

MARKER_PERIOD = 0.1  # [s]
SHUTDOWN_PATIENCE = 1.0  # [s, wall] for a running goal to stop the robot and report SHUTDOWN
SEND_TIME = 0.1  # [s, wall] for rospy's sender threads to write what was just published
NOT_STARTED = Ending(Outcome.PREEMPTED, "it was cancelled or replaced before it started")


class GotoServer:
    """Executes one goal at a time, in one thread, the control loop.

    Life of a goal: _accept_goal, _advance in each control period, _end, which gives it its one terminal state.
    A request (new goal, cancel, shutdown) is served before the next control period, also while /clock is paused.
    """

    def __init__(self, p: GotoParams) -> None:
        self.p = p
        self.tuning = Tuning(p)
        self.inputs = Inputs(p)
        self.goal: Optional[GoalExecution] = None
        self.command: Optional[Twist2D] = None  # published since the last answer to a lockstep simulator
        self.state = "idle"  # for RViz
        self.shown_goal: Optional[markers.ShownGoal] = None
        self.logged_z = False
        self.stopping = threading.Event()
        self.cmd_vel = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self.answers = publisher("tick_answer", TickAnswer)  # without a thread that hands the answers on
        self.markers = rospy.Publisher("~markers", MarkerArray, queue_size=1, latch=True)
        self.server = GoalServer(GoToPositionResult(False, NOT_STARTED.message))
        self.loop = threading.Thread(target=self._control_loop, name="control loop", daemon=True)
        self.loop.start()
        rospy.on_shutdown(self._shut_down)
        self.marker_timer = start_timer(MARKER_PERIOD, self._publish_markers)
        self.server.start()

    # -- the control loop --

    def _control_loop(self) -> None:
        ticker = Ticker(1.0 / self.p.control_rate, self._has_request)
        while not self._is_finished():
            try:
                self._run_once(ticker)
            except Exception:  # the thread's outermost level: without the loop no goal would be executed again
                if not rospy.is_shutdown():
                    rospy.logerr("the control loop failed and continues:\n%s", traceback.format_exc())

    def _run_once(self, ticker: Ticker) -> None:
        """Serve a request or run one control period, whichever is due first."""
        ticked = ticker.wait()
        try:
            if ticked:
                self._adopt_parameters()
                self._advance(ticker.tick_ns)
            else:
                self._serve_request()
        except Exception as error:  # the goal's outermost level: it fails, the server does not
            self._fail(error)
        finally:
            if ticked:
                self._answer_tick(ticker.tick_ns)

    def _adopt_parameters(self) -> None:
        """Use the newest parameters from this control period on, also for the current goal."""
        self.p = self.tuning.params
        if self.goal is not None:
            self.goal.p = self.p

    def _has_request(self) -> bool:
        return (
            self.stopping.is_set()
            or self.server.is_new_goal_available()
            or (self.goal is not None and self.server.is_preempt_requested())
        )

    def _is_finished(self) -> bool:
        """On shutdown, whether every goal received so far has ended."""
        idle = self.goal is None and not self.server.is_new_goal_available()
        return rospy.is_shutdown() or (self.stopping.is_set() and idle)

    def _serve_request(self) -> None:
        """End the current goal if there is one, else accept the newest."""
        if self.goal is None:
            if self.server.is_new_goal_available():
                self._accept_goal()
        elif self.stopping.is_set():
            self._end(self.goal.stopped_early(Outcome.SHUTDOWN, "the server is shutting down"))
        elif self.server.is_new_goal_available():
            self._end(self.goal.stopped_early(Outcome.PREEMPTED, "a newer goal replaced it"))
        else:
            self._end(self.goal.stopped_early(Outcome.PREEMPTED, "it was cancelled"))

    # -- one goal --

    def _accept_goal(self) -> None:
        goal = GoalExecution(self.server.accept_new_goal(), self.p, self.inputs)
        refusal = goal.refusal()
        if refusal is not None:
            self._end(refusal)
            return
        self.goal = goal
        self.shown_goal = markers.ShownGoal(goal.goal)
        rospy.loginfo("goal accepted: x %.2f y %.2f", goal.goal.x, goal.goal.y)
        if goal.z != 0.0 and not self.logged_z:
            self.logged_z = True
            rospy.loginfo("z of goals is ignored (it is %s m here): the robot stays on the floor", goal.z)

    def _advance(self, tick_ns: int) -> None:
        """One control period of the current goal, if there is one."""
        if self.goal is None:
            return
        if self._simulator_in_lockstep():
            self.inputs.await_tick(tick_ns)
        step = self.goal.step(tick_ns)
        if step.feedback is not None:
            self._publish_feedback(step.feedback)
        if step.ending is not None:
            self._end(step.ending)
        elif step.feedback is not None:
            self._publish_command(step.twist)

    def _publish_feedback(self, feedback: GoToPositionFeedback) -> None:
        self.state = feedback.message
        self.server.publish_feedback(feedback)

    def _publish_command(self, twist: Twist2D) -> None:
        self.command = twist
        self.cmd_vel.publish(convert.to_twist_msg(twist))

    def _fail(self, error: Exception) -> None:
        """Stop the robot and end the active goal, if there is one; call while handling the error."""
        expected = isinstance(error, RobocopError)
        ending = Ending(Outcome.ERROR, str(error) if expected else f"{type(error).__name__}: {error}")
        if not expected and not rospy.is_shutdown():
            rospy.logerr("goal failed: %s\n%s", ending.message, traceback.format_exc())
        if self.server.is_active():
            self._end(ending)
            return
        if expected:  # _end, which logs it otherwise, is not called
            rospy.logerr("%s", ending.message)
        self._publish_command(STANDSTILL)

    def _end(self, ending: Ending) -> None:
        """Stop the robot and give the active goal its terminal state."""
        self._publish_command(STANDSTILL)
        if self.goal is not None:
            self.shown_goal = markers.ShownGoal(self.goal.goal, ending.outcome)
        self.goal = None
        self.state = ending.message
        result = GoToPositionResult(ending.outcome is Outcome.REACHED, ending.message)
        if ending.outcome is Outcome.REACHED:
            rospy.loginfo("%s", ending.message)
            self.server.set_succeeded(result, ending.message)
        elif ending.outcome is Outcome.PREEMPTED:
            rospy.loginfo("%s", ending.message)
            self.server.set_preempted(result, ending.message)
        else:
            rospy.logwarn("%s", ending.message)
            self.server.set_aborted(result, ending.message)

    # -- lockstep --

    def _simulator_in_lockstep(self) -> bool:
        """Whether the node that publishes odometry receives the answers; others, such as rosbag, may subscribe too."""
        odom = self.inputs.odom
        return odom is not None and private_api.is_connected_to(self.answers, private_api.sender(odom.message))

    def _answer_tick(self, tick_ns: int) -> None:
        """Tell a simulator in lockstep that this control period is complete, with the command since the last one."""
        command, self.command = self.command, None
        if self.answers.get_num_connections():
            twist = convert.to_twist_msg(command or STANDSTILL)
            self.answers.publish(TickAnswer(convert.to_time(tick_ns), command is not None, twist))

    # -- shutdown, markers --

    def _shut_down(self) -> None:
        """Before rospy closes its topics: let the control loop stop the robot and end every goal."""
        busy = self.goal is not None or self.server.is_new_goal_available()
        self.stopping.set()
        self.loop.join(SHUTDOWN_PATIENCE)
        if busy:
            self.cmd_vel.publish(convert.to_twist_msg(STANDSTILL))
            time.sleep(SEND_TIME)

    def _publish_markers(self) -> None:
        if not self.markers.get_num_connections():
            return
        odom, scan, robot = self.inputs.odom, self.inputs.scan, rospy.get_namespace().strip("/")
        self.markers.publish(
            markers.server_markers(
                self.p,
                self.shown_goal,
                self.inputs.clearance(),
                "" if scan is None else scan.message.header.frame_id,
                None if odom is None else odom.message,
                f"{robot}: {self.state}" if robot else self.state,  # its text may stand beside another robot
            )
        )


def main() -> None:
    """Run the node until it is shut down; exit status 1 when it can't start, with the reason logged."""
    with node("aro_robocop_goto_as_node"):
        GotoServer(param_server.load(GotoParams))
        rospy.spin()
