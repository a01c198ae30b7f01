"""robocop_goto_as: GoToPosition goals -> the lab's loop -> cmd_vel, feedback, result."""

import threading
import time
import traceback
from typing import Optional

import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan
from visualization_msgs.msg import MarkerArray

from aro_robocop_goto_as.msg import GoToPositionResult, TickAnswer

from ...errors import RobocopError
from ...geometry import STANDSTILL, Twist2D
from ...goto import Outcome
from ...goto_params import GotoParams
from ...process.peer import await_others
from ...trail import Trail
from .. import convert
from ..names import SERVER
from ..node_main import load_params, node
from ..publishing import publisher
from ..rospy_internals import is_connected_to, sender
from ..ticker import Ticker, start_timer
from .goal_execution import Ending, GoalExecution
from .goal_server import GoalServer
from .inputs import Inputs
from .server_markers import server_markers
from .tuning import Tuning

MARKER_PERIOD = 0.1  # [s]
SHUTDOWN_PATIENCE = 1.0  # [s, wall and processor] for a running goal to stop the robot and report SHUTDOWN
SEND_TIME = 0.1  # [s, wall and processor] for rospy's sender threads to write what was just published


class GotoNode:
    """Executes one goal at a time, in one thread, the control loop.

    Life of a goal: _accept_goal, _advance in each control period, _end, which gives it its one terminal state.
    A request (new goal, cancel, shutdown) is served before the next control period, also while /clock is paused.
    """

    def __init__(self, p: GotoParams) -> None:
        self.tuning = Tuning(p)
        self.inputs = Inputs(self.tuning)
        self.execution: Optional[GoalExecution] = None  # of the current goal
        self.newest: Optional[GoalExecution] = None  # for RViz, in which it stays until the next one
        self.command: Optional[Twist2D] = None  # published since the last answer to a lockstep simulator
        self.state, self.trail = "idle", Trail()  # for RViz
        self.stopping = threading.Event()
        self.ticker = Ticker(1.0 / p.control_rate, self._has_request)
        self.cmd_vel = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self.markers = rospy.Publisher("~markers", MarkerArray, queue_size=1, latch=True)
        self.goals = GoalServer()
        # No queue size: with one, rospy drops all but the newest of a burst, which hides the topic's period.
        # Without TCP_NODELAY the kernel may hold a small message back for 40 ms: several control periods at high speed.
        rospy.Subscriber("odom", Odometry, self.inputs.on_odom, tcp_nodelay=True)
        rospy.Subscriber("scan", LaserScan, self.inputs.on_scan, tcp_nodelay=True)
        # The last of these: a simulator in lockstep waits for who answers, once all that the master knows is connected.
        self.answers = publisher("tick_answer", TickAnswer)  # without a thread that hands the answers on
        self.loop = threading.Thread(target=self._control_loop, name="control loop", daemon=True)
        self.loop.start()
        rospy.on_shutdown(self._shut_down)
        self.marker_timer = start_timer(MARKER_PERIOD, self._publish_markers)
        self.goals.start()

    # -- the control loop --

    def _control_loop(self) -> None:
        while not self._is_finished():
            try:
                self._run_once()
            except Exception:  # the thread's outermost level: without the loop no goal would be executed again
                if not rospy.is_shutdown():
                    rospy.logerr("the control loop failed and continues:\n%s", traceback.format_exc())
        if self.command is not None:  # another server of this name may answer the next tick, without a command
            self._answer_tick(self.ticker.tick_ns)

    def _run_once(self) -> None:
        """Serve a request or run one control period, whichever is due first."""
        ticked = self.ticker.wait()
        try:
            if ticked:
                self._advance(self.ticker.tick_ns)
            else:
                self._serve_request()
        except Exception as error:  # the goal's outermost level: it fails, the server does not
            self._fail(error)
        finally:
            if ticked:
                self._answer_tick(self.ticker.tick_ns)

    def _has_request(self) -> bool:
        return self.stopping.is_set() or self.goals.has_request()

    def _is_finished(self) -> bool:
        """On shutdown, whether every goal received so far has ended."""
        idle = self.execution is None and not self.goals.has_request()
        return rospy.is_shutdown() or (self.stopping.is_set() and idle)

    def _serve_request(self) -> None:
        """End the current goal if what has arrived replaces or cancels it, or on shutdown; accept the newest."""
        self.goals.receive()
        if self.execution is not None:
            if self.stopping.is_set():
                self._end(self.execution.stopped_early(Outcome.SHUTDOWN, "the server is shutting down"))
            elif self.goals.waiting is not None:
                self._end(self.execution.stopped_early(Outcome.PREEMPTED, "a newer goal replaced it"))
            elif self.goals.is_cancelled:
                self._end(self.execution.stopped_early(Outcome.PREEMPTED, "it was cancelled"))
        if self.goals.waiting is not None:
            self._accept_goal()

    # -- one goal --

    def _accept_goal(self) -> None:
        execution = GoalExecution(self.goals.accept(), self.tuning, self.inputs)
        refusal = execution.refusal()
        if refusal is not None:
            self._end(refusal)
            return
        self.execution = self.newest = execution
        rospy.loginfo("goal accepted: %s", execution.where())
        if execution.z != 0.0:
            rospy.loginfo_once("ignoring goal z = %g m", execution.z)

    def _advance(self, tick_ns: int) -> None:
        """One control period of the current goal, if there is one."""
        if self.execution is None:
            return
        if self._simulator_in_lockstep():
            self.inputs.await_tick(tick_ns)
        feedback, ending = self.execution.step(tick_ns)
        if feedback is not None:
            self.state = feedback.message
            self.goals.current.publish_feedback(feedback)
        if ending is not None:
            self._end(ending)
        elif feedback is not None:
            self._publish_command(self.execution.twist)

    def _publish_command(self, twist: Twist2D) -> None:
        self.command = twist
        self.cmd_vel.publish(convert.to_twist_msg(twist))

    def _fail(self, error: Exception) -> None:
        """Stop the robot and end the active goal, if there is one; call while handling the error."""
        expected = isinstance(error, RobocopError)
        ending = Ending(Outcome.ERROR, str(error) if expected else f"{type(error).__name__}: {error}")
        if not expected and not rospy.is_shutdown():
            rospy.logerr("goal failed: %s\n%s", ending.message, traceback.format_exc())
        if self.goals.current is not None:
            self._end(ending)
        else:  # the error is not the goal's; all that the loop itself raises is unexpected, and logged above
            self._publish_command(STANDSTILL)

    def _end(self, ending: Ending) -> None:
        """Stop the robot and give the active goal its terminal state."""
        self._publish_command(STANDSTILL)
        if self.execution is not None:
            self.execution.outcome = ending.outcome
        self.execution = None
        self.state = ending.message
        log = rospy.loginfo if ending.outcome in (Outcome.REACHED, Outcome.PREEMPTED) else rospy.logwarn
        log("%s", ending.message)
        self.goals.end(ending.outcome, GoToPositionResult(ending.outcome is Outcome.REACHED, ending.message))

    # -- lockstep --

    def _simulator_in_lockstep(self) -> bool:
        """Whether the node that publishes odometry receives the answers; others, such as rosbag, may subscribe too.

        Before the first odometry, also after the clock was set back, that node is unknown: it may be any.
        """
        odom = self.inputs.odom
        if odom is None or not self.inputs.is_of_this_run(odom):
            return bool(self.answers.get_num_connections())
        return is_connected_to(self.answers, sender(odom.message))

    def _answer_tick(self, tick_ns: int) -> None:
        """Tell a simulator in lockstep that this control period is complete, with the command since the last one."""
        command, self.command = self.command, None
        if self.answers.get_num_connections():
            twist = convert.to_twist_msg(command or STANDSTILL)
            self.answers.publish(TickAnswer(convert.to_time(tick_ns), command is not None, twist))

    # -- shutdown, markers --

    def _shut_down(self) -> None:
        """Before rospy closes its topics: let the control loop stop the robot and end every goal."""
        busy = self.execution is not None or self.goals.has_request()
        self.stopping.set()
        await_others(self._has_ended, SHUTDOWN_PATIENCE, SHUTDOWN_PATIENCE)
        if busy:
            self.cmd_vel.publish(convert.to_twist_msg(STANDSTILL))
        await_others(time.sleep, SEND_TIME, SEND_TIME)  # also for a goal that has just ended

    def _has_ended(self, timeout: float) -> bool:
        self.loop.join(timeout)
        return not self.loop.is_alive()

    def _publish_markers(self) -> None:
        odom = self.inputs.odom
        if odom is not None:
            position = odom.message.pose.pose.position
            self.trail.add(odom.stamp_ns / 1e9, position.x, position.y)
        if not self.markers.get_num_connections():
            return
        robot = rospy.get_namespace().strip("/")
        state = f"{robot}: {self.state}" if robot else self.state  # its text may stand beside another robot
        self.markers.publish(server_markers(self.tuning.params, self.inputs, self.newest, state, self.trail.points))


def main() -> None:
    """Run the node until it is shut down; exit status 1 when it can't start, with the reason logged."""
    with node(SERVER):
        GotoNode(load_params(GotoParams))
        rospy.spin()
