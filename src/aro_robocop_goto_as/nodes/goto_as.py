"""robocop_goto_as: GoToPosition goals -> the lab's loop -> cmd_vel, feedback, result."""

import threading
import time
import traceback
from typing import Optional

import rospy
from geometry_msgs.msg import Twist
from visualization_msgs.msg import MarkerArray

from aro_robocop_goto_as.msg import GoToPositionGoal, GoToPositionResult, TickAnswer

from ..geometry import STANDSTILL, Twist2D
from ..goto import Outcome
from ..params import GotoParams
from . import convert, markers, params
from .goal_server import GoalServer
from .lifetime import node
from .pursuit import Ending, Pursuit
from .senses import Senses
from .ticker import Ticker
from .timer import start_timer

ACTION = "robocop_goto_as"  # fixed by the handout
MARKER_PERIOD = 0.1  # [s]
HANDOVER_POLL = 0.5  # [s, wall] between two looks whether the control loop is alive
REPORT_PATIENCE = 1.0  # [s, wall] for a goal's result to be sent before the loop goes on
SHUTDOWN_PATIENCE = 1.0  # [s, wall] for a running goal to stop the robot and report SHUTDOWN


class GotoServer:
    """One goal at a time: actionlib's thread hands a goal to the control loop and reports its ending, the control
    loop does the rest, tick by tick.

    On a simulator in lockstep the loop answers every tick, with or without a goal, from that tick's own data.
    """

    def __init__(self, p: GotoParams) -> None:
        self.p = p
        self.senses = Senses(p)
        self.pursuit: Optional[Pursuit] = None
        self.state = "idle"
        self.said_z = False
        self.stop_at_next_tick = False
        self.stopping = threading.Event()
        self.cmd_vel = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        self.answers = rospy.Publisher("tick_answer", TickAnswer, queue_size=10, tcp_nodelay=True)
        self.markers = rospy.Publisher("~markers", MarkerArray, queue_size=1, latch=True)
        self.server = GoalServer(ACTION, self._execute, _bumped_result)
        rospy.on_shutdown(self._shut_down)
        self.server.start()
        self.marker_timer = start_timer(MARKER_PERIOD, self._publish_markers)
        self.loop = threading.Thread(target=self._control_loop, name="control loop", daemon=True)
        self.loop.start()

    # -- one goal, in SimpleActionServer's execute thread --

    def _execute(self, message: GoToPositionGoal) -> None:
        """Have the control loop pursue a goal, and give it its one terminal state."""
        pursuit = Pursuit(message, self.p, self.senses)
        refusal = pursuit.refusal()
        if refusal is not None:
            self.cmd_vel.publish(convert.to_twist_msg(STANDSTILL))
            self._end(refusal)
            return
        self._announce(pursuit)
        self.pursuit = pursuit
        while not pursuit.ended.wait(HANDOVER_POLL):
            if not self.loop.is_alive():
                self.cmd_vel.publish(convert.to_twist_msg(STANDSTILL))
                pursuit.ending = Ending(Outcome.ERROR, "the control loop has ended")
                break
        self._end(pursuit.ending or Ending(Outcome.ERROR, "the goal was left without an outcome"))
        self.pursuit = None
        pursuit.reported.set()

    def _announce(self, pursuit: Pursuit) -> None:
        rospy.loginfo("goal accepted: x %.2f y %.2f", pursuit.goal.x, pursuit.goal.y)
        if pursuit.z != 0.0 and not self.said_z:
            self.said_z = True
            rospy.loginfo("the goal's z (%s m) is ignored, now and later: the robot stays on the floor", pursuit.z)

    def _end(self, ending: Ending) -> None:
        result = GoToPositionResult(ending.outcome is Outcome.REACHED, ending.message)
        self.state = ending.message
        if ending.outcome is Outcome.REACHED:
            rospy.loginfo("%s", ending.message)
            self.server.set_succeeded(result, ending.message)
        elif ending.outcome is Outcome.PREEMPTED:
            rospy.loginfo("%s", ending.message)
            self.server.set_preempted(result, ending.message)
        else:
            rospy.logwarn("%s", ending.message)
            self.server.set_aborted(result, ending.message)

    # -- the control loop, in a thread of its own --

    def _control_loop(self) -> None:
        """Tick until shutdown; whatever happens to a goal, the robot stands afterwards and the loop goes on."""
        ticker = Ticker(1.0 / self.p.control_rate, self._interrupted)
        while not (self.stopping.is_set() and self.pursuit is None):
            try:
                self._tick(ticker)
            except Exception:  # the loop's "main": without it no goal would ever be pursued again
                if not rospy.is_shutdown():
                    rospy.logerr("the control loop failed and goes on:\n%s", traceback.format_exc())
                    self.cmd_vel.publish(convert.to_twist_msg(STANDSTILL))

    def _tick(self, ticker: Ticker) -> None:
        ticked = ticker.wait()
        pursuit = self._current_pursuit()
        command: Optional[Twist2D] = None
        if pursuit is not None:
            command = self._advance(pursuit, ticker.tick_ns if ticked else None)
        if ticked:
            self._answer(ticker.tick_ns, command)

    def _interrupted(self) -> bool:
        """Whether a goal has to end now and not at the next tick, which a paused simulator never reaches."""
        if self.stopping.is_set() or rospy.is_shutdown():
            return True
        pursuit = self.pursuit
        return pursuit is not None and not pursuit.ended.is_set() and bool(self.server.is_preempt_requested())

    def _current_pursuit(self) -> Optional[Pursuit]:
        """The goal in hand; one that actionlib has accepted but not handed over yet is waited for."""
        while self.server.is_active() and self.pursuit is None and not rospy.is_shutdown():
            time.sleep(0.001)
        pursuit = self.pursuit
        return None if pursuit is None or pursuit.ended.is_set() else pursuit

    def _advance(self, pursuit: Pursuit, tick_ns: Optional[int]) -> Twist2D:
        """One tick of a goal, or None for an interruption; returns the velocity that was commanded."""
        try:
            ending = self._interruption(pursuit)
            if ending is None and tick_ns is not None:
                if self.answers.get_num_connections():
                    self.senses.await_tick(tick_ns)
                ending = pursuit.step(tick_ns)
                self._feed_back(pursuit)
        except Exception as error:  # this goal's "main": the client is told, the loop lives on
            ending = Ending(Outcome.ERROR, f"{type(error).__name__}: {error}")
            rospy.logerr("goal failed: %s\n%s", ending.message, traceback.format_exc())
        velocity = pursuit.twist if ending is None else STANDSTILL
        decided = pursuit.feedback is not None and tick_ns is not None  # not while the first data is waited for
        if ending is not None or decided:
            self.cmd_vel.publish(convert.to_twist_msg(velocity))
        if ending is not None:
            self.stop_at_next_tick = tick_ns is None
            pursuit.ending = ending
            pursuit.ended.set()
            pursuit.reported.wait(REPORT_PATIENCE)
        return velocity

    def _feed_back(self, pursuit: Pursuit) -> None:
        if pursuit.feedback is not None:
            self.state = pursuit.feedback.message
            self.server.publish_feedback(pursuit.feedback)

    def _interruption(self, pursuit: Pursuit) -> Optional[Ending]:
        if self.stopping.is_set() or rospy.is_shutdown():
            return pursuit.given_up(Outcome.SHUTDOWN, "the server is shutting down")
        if not self.server.is_preempt_requested():
            return None
        reason = "a newer goal came" if self.server.is_new_goal_available() else "it was cancelled"
        return pursuit.given_up(Outcome.PREEMPTED, reason)

    def _answer(self, tick_ns: int, command: Optional[Twist2D]) -> None:
        """Tell a simulator in lockstep that this tick is done."""
        if command is None and self.stop_at_next_tick:
            command = STANDSTILL
        self.stop_at_next_tick = False
        if self.answers.get_num_connections():
            self.answers.publish(TickAnswer(convert.to_time(tick_ns), command is not None,
                                            convert.to_twist_msg(command or STANDSTILL)))

    # -- around the goals --

    def _shut_down(self) -> None:
        """Before rospy closes its topics: let a running goal stop the robot and report."""
        pursuit = self.pursuit
        self.stopping.set()
        if pursuit is not None:
            pursuit.reported.wait(SHUTDOWN_PATIENCE)
            self.cmd_vel.publish(convert.to_twist_msg(STANDSTILL))
            time.sleep(0.1)  # rospy's sender threads write what was just published

    def _publish_markers(self) -> None:
        if self.markers.get_num_connections():
            odom, scan, pursuit = self.senses.odom, self.senses.scan, self.pursuit
            goal = None if pursuit is None else pursuit.goal
            scan_frame = "" if scan is None else scan.message.header.frame_id
            self.markers.publish(markers.server_markers(self.p, goal, self.senses.clearance(), scan_frame,
                                                        None if odom is None else odom.message, self.state))


def _bumped_result() -> GoToPositionResult:
    ending = Ending(Outcome.PREEMPTED, "it was cancelled, or a newer goal came, before it began")
    return GoToPositionResult(False, ending.message)


def main() -> None:
    """Run the node until it is shut down; exit status 1 when it can't start, with the reason logged."""
    with node("aro_robocop_goto_as_node"):
        GotoServer(params.load(GotoParams))
        rospy.spin()
