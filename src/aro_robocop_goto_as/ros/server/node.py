"""robocop_goto_as: GoToPosition goals -> the handout's loop -> cmd_vel, feedback, result."""

import threading
import time
import traceback
from typing import Optional

import actionlib
import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan

from aro_robocop_goto_as.msg import GoToPositionAction, GoToPositionGoal, GoToPositionResult

from ...errors import ClockError, RobocopError
from ...geometry import NANOSECONDS, STANDSTILL, Twist2D
from ...goto.params import GotoParams
from ...goto.rule import Outcome
from ...names import ACTION, SERVER
from .. import convert
from ..connected_nodes import is_connected_to, sender
from ..node_main import answer_help, load_params, node
from .goal_execution import Ending, GoalExecution, feedback_of
from .inputs import Inputs
from .server_markers import Display
from .ticks import Ticks
from .tuning import Tuning

SHUTDOWN_TIMEOUT = 5.0  # [s, wall] for a running goal to stop the robot and report SHUTDOWN
SEND_TIME = 0.1  # [s, wall] for rospy to send what was just published


class GotoNode:
    """Executes one goal at a time, in the thread of actionlib's SimpleActionServer.

    A simulator in lockstep holds time at each tick until the server has answered it: the running goal after its control
    period, or an idle server at once. `execution_lock` is locked while a goal runs.
    """

    def __init__(self, p: GotoParams) -> None:
        self.tuning = Tuning(p)
        self.inputs = Inputs(self.tuning)
        self.display = Display(self.tuning, self.inputs)  # in RViz
        self.stop_reason = ""  # why the node ends, once it does
        self.clock_error = ""
        self.execution_lock = threading.Lock()
        self.cmd_vel = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        odom = rospy.Subscriber("odom", Odometry, self.inputs.on_odom, tcp_nodelay=True)
        scan = rospy.Subscriber("scan", LaserScan, self.inputs.on_scan, tcp_nodelay=True)
        self.ticks = Ticks(p.control_rate, (odom, scan), self.on_clock_set_back)
        self.server = actionlib.SimpleActionServer(ACTION, GoToPositionAction, self.execute, auto_start=False)
        self.server.register_preempt_callback(self.ticks.wake)
        rospy.on_shutdown(self.shut_down)
        self.server.start()
        rospy.loginfo("%s is ready for goals", rospy.resolve_name(ACTION))
        threading.Thread(target=self.answer_idle_ticks, daemon=True).start()

    # -- one goal --

    def execute(self, goal: GoToPositionGoal) -> None:
        """Drive to a goal, then to a goal that came meanwhile: actionlib would look for it only 0.1 s [wall] later."""
        with self.execution_lock:
            self.go_to(goal)
            while self.server.is_new_goal_available():
                self.go_to(self.server.accept_new_goal())

    def go_to(self, goal: GoToPositionGoal) -> None:
        """The handout's loop: one control period after another, until the goal gets its one terminal state."""
        execution = GoalExecution(goal, self.inputs)
        ending = execution.refusal()
        try:
            if ending is None:
                self.display.newest = execution
                rospy.loginfo("goal accepted: %s", execution.where())
            while ending is None:
                # The next tick, or the tick not yet answered when this goal came.
                tick_ns = self.ticks.wait_for_next(self.ticks.answered_ns, self.is_interrupted)
                if self.stop_reason:
                    ending = execution.stopped_early(Outcome.SHUTDOWN, self.stop_reason)
                elif self.server.is_preempt_requested():
                    replaced = self.server.is_new_goal_available()
                    reason = "a newer goal replaced it" if replaced else "it was cancelled"
                    ending = execution.stopped_early(Outcome.PREEMPTED, reason)
                else:
                    ending = self.control_period(execution, tick_ns)
                    if ending is None:
                        self.ticks.answer(tick_ns)
        except RobocopError as error:  # odometry or a scan can't be used
            ending = Ending(Outcome.ERROR, str(error))
        except Exception as error:  # a fault of this program: also then the goal ends below, once
            rospy.logerr(traceback.format_exc())
            ending = Ending(Outcome.ERROR, f"{type(error).__name__}: {error}")
        finally:
            self.drive(STANDSTILL)
        self.set_terminal_state(execution, ending)
        self.ticks.answer(self.ticks.newest_ns())

    def is_interrupted(self) -> bool:
        """Return whether the goal has to end before its next control period."""
        return bool(self.stop_reason) or self.server.is_preempt_requested()

    def control_period(self, execution: GoalExecution, tick_ns: int) -> Optional[Ending]:
        """One period of the handout's loop: compute the errors, command a rotation or a drive, publish feedback.

        Returns how the goal ends, or None to go on.
        """
        if self.is_in_lockstep():
            self.inputs.wait_for_tick(tick_ns)
        p, now = self.tuning.params, tick_ns / NANOSECONDS
        started = execution.begin_period(now)
        missing = self.inputs.missing(now, started, execution.accepted)
        if missing is not None:
            return Ending(*missing)
        inputs = self.inputs.read()
        if inputs is None:
            return None
        pose, clearance = inputs
        decision = execution.decide(pose, clearance, p)
        ending = execution.ending(decision, clearance, p)
        if ending is None:
            self.drive(execution.twist)
        feedback = feedback_of(decision)
        self.display.state = feedback.message
        self.server.publish_feedback(feedback)
        return ending

    def drive(self, twist: Twist2D) -> None:
        """Command a velocity."""
        self.ticks.command = twist
        self.cmd_vel.publish(convert.to_twist_msg(twist))

    def set_terminal_state(self, execution: GoalExecution, ending: Ending) -> None:
        """Report how the goal ended, once."""
        execution.outcome, self.display.state = ending.outcome, ending.outcome.value
        log = rospy.loginfo if ending.outcome in (Outcome.REACHED, Outcome.PREEMPTED) else rospy.logwarn
        log("%s", ending.message)
        result = GoToPositionResult(ending.outcome is Outcome.REACHED, ending.message)
        if ending.outcome is Outcome.REACHED:
            self.server.set_succeeded(result, ending.message)
        elif ending.outcome is Outcome.PREEMPTED:
            self.server.set_preempted(result, ending.message)
        else:
            self.server.set_aborted(result, ending.message)

    def is_in_lockstep(self) -> bool:
        """Return whether the node that publishes odom also subscribes to tick_answer: it is a simulator in lockstep.

        Another subscriber, such as rosbag, is none.
        """
        odom = self.inputs.odom
        return odom is not None and is_connected_to(self.ticks.answers, sender(odom.message))

    def answer_idle_ticks(self) -> None:
        """Answer the ticks at which no goal runs or is about to run; a thread of its own."""
        tick_ns = self.ticks.answered_ns
        while not self.stop_reason:
            tick_ns = self.ticks.wait_for_next(tick_ns, lambda: bool(self.stop_reason))
            with self.execution_lock:
                if not (self.stop_reason or self.server.is_new_goal_available() or self.server.is_active()):
                    self.ticks.answer(self.ticks.newest_ns())

    # -- the node --

    def on_clock_set_back(self, reason: str) -> None:
        """End the node: its action server would drop all goals, as they are stamped earlier than the last one."""
        self.clock_error = self.stop_reason = reason
        rospy.signal_shutdown(reason)

    def shut_down(self) -> None:
        """Before rospy closes its topics: let the running goal end, and stop the robot."""
        self.stop_reason = self.stop_reason or "the server is shutting down"
        self.ticks.wake()
        if self.execution_lock.acquire(timeout=SHUTDOWN_TIMEOUT):
            self.execution_lock.release()
        self.cmd_vel.publish(Twist())
        time.sleep(SEND_TIME)


def main() -> None:
    """Run the node until it is shut down; exit status 1 when it can't go on, with the reason logged."""
    answer_help("The go-to action server robocop_goto_as: turns the robot to a goal, drives there, stops at obstacles.")
    with node(SERVER):
        server = GotoNode(load_params(GotoParams))
        rospy.spin()
        if server.clock_error:
            raise ClockError(server.clock_error)
