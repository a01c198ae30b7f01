"""The page's requests as messages and service calls, made by one thread, so that no caller waits for a service."""

import queue
import threading
import time
from typing import Any, Callable, Dict, Tuple

import rospy
from actionlib_msgs.msg import GoalID
from dynamic_reconfigure.msg import Config, DoubleParameter
from dynamic_reconfigure.srv import Reconfigure
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped, Twist
from std_srvs.srv import Trigger

from aro_robocop_goto_as.srv import Reset, SetPose, Step

from ...geometry import Twist2D
from ...web.dead_man import DeadMan
from .. import convert
from ..action import ACTION
from ..ticker import wait_until
from .topics import SIMULATOR, absolute

SERVICE_PATIENCE, CONNECT_PATIENCE = 2.0, 2.0  # [s, wall] for a service to appear, for a subscriber to connect
END_PATIENCE = 0.5  # [s, wall]
STEP = 0.1  # [s] of simulated time: one control tick
MOST_WAITING = 8  # requests
DRIVE_PERIOD = 0.1  # [s, wall]
DRIVE_LINGER = 3.0  # [s, wall] without driving until cmd_vel is given up
POSITION_VARIANCE, YAW_VARIANCE = 0.25, 0.0685  # of RViz's 2D Pose Estimate: 0.5 m and 15 degrees, squared


class Commands:
    """Carries out one request after the other; `answer` holds the outcome of the last one."""

    def __init__(self) -> None:
        self.answer = ""
        self._jobs: queue.Queue[Tuple[str, Callable[[], str]]] = queue.Queue(MOST_WAITING)
        self._waiting = ""
        self._publishers: Dict[str, rospy.Publisher] = {}
        threading.Thread(target=self._work, daemon=True, name="commands").start()

    def _post(self, what: str, job: Callable[[], str]) -> None:
        try:
            self._jobs.put_nowait((what, job))
        except queue.Full:
            self.answer = f"{what}: ignored, because {self._waiting} is still waiting for its answer"

    def _work(self) -> None:
        while True:
            what, job = self._jobs.get()
            self._waiting = what
            try:
                self.answer = f"{what}: {job()}"
            except (rospy.ROSException, rospy.ServiceException, OSError) as error:
                self.answer = f"{what}: {error}"
            self._waiting = ""

    def _publisher(self, topic: str, kind: Any) -> rospy.Publisher:
        if topic not in self._publishers:
            self._publishers[topic] = rospy.Publisher(topic, kind, queue_size=1)
        return self._publishers[topic]

    def _publish(self, topic: str, message: Any) -> bool:
        """Whether there was a subscriber; a new publisher is given some time to be found."""
        publisher = self._publisher(topic, type(message))
        connected = wait_until(lambda: publisher.get_num_connections() > 0, CONNECT_PATIENCE)
        publisher.publish(message)
        return connected

    # -- goals and poses --

    def send_goal(self, robot: str, frame: str, x: float, y: float) -> None:
        """A 2D Nav Goal, which the bridge makes a goal of; time zero means the newest transforms."""
        topic, message = absolute(robot, "move_base_simple/goal"), PoseStamped()
        message.header.frame_id = frame
        message.pose.position.x, message.pose.position.y, message.pose.orientation.w = x, y, 1.0
        done = f"sent to {topic}"
        nobody = f"nobody subscribes to {topic}: is the bridge running?"
        self._post(f"goal ({x:.2f}, {y:.2f}) in {frame}", lambda: done if self._publish(topic, message) else nobody)

    def place(self, robot: str, frame: str, x: float, y: float, yaw: float, simulated: bool) -> None:
        """Put a simulated robot there; tell a real one's localization that it is there."""
        what = f"pose ({x:.2f}, {y:.2f}) in {frame}"
        pose = PoseStamped()
        pose.header.frame_id = frame
        pose.pose.position.x, pose.pose.position.y = x, y
        pose.pose.orientation = convert.to_quaternion(yaw)
        if simulated:
            self._post(what, lambda: self._call("set_pose", SetPose, robot, pose))
            return
        estimate = PoseWithCovarianceStamped(header=pose.header)
        estimate.pose.pose = pose.pose
        variances = (POSITION_VARIANCE, POSITION_VARIANCE, 0.0, 0.0, 0.0, YAW_VARIANCE)
        estimate.pose.covariance = convert.diagonal(variances)
        topic = absolute(robot, "initialpose")
        nobody = f"nobody subscribes to {topic}"
        self._post(what, lambda: f"sent to {topic}" if self._publish(topic, estimate) else nobody)

    def cancel(self, robot: str) -> None:
        """Cancel all goals of a robot's server."""
        topic = absolute(robot, f"{ACTION}/cancel")
        nobody = f"nobody subscribes to {topic}: is the server running?"
        self._post("cancel", lambda: f"sent to {topic}" if self._publish(topic, GoalID()) else nobody)

    # -- simulated time --

    def _call(self, service: str, kind: Any, *arguments: Any) -> str:
        name = f"{SIMULATOR}/{service}"
        rospy.wait_for_service(name, SERVICE_PATIENCE)
        answer = rospy.ServiceProxy(name, kind)(*arguments)
        return str(answer.message)

    def pause(self, paused: bool) -> None:
        """Stop simulated time, or let it run."""
        self._post("pause" if paused else "continue", lambda: self._call("pause" if paused else "unpause", Trigger))

    def step(self) -> None:
        """Simulate one control tick, then pause."""
        self._post("step", lambda: self._call("step", Step, STEP))

    def reset(self) -> None:
        """All robots at their spawn poses, with the same seed."""
        self._post("reset", lambda: self._call("reset", Reset, 0))

    def set_factor(self, factor: float) -> None:
        """Set the real-time factor."""

        def reconfigure() -> str:
            name = f"{SIMULATOR}/set_parameters"
            rospy.wait_for_service(name, SERVICE_PATIENCE)
            config = Config(doubles=[DoubleParameter("real_time_factor", factor)])
            rospy.ServiceProxy(name, Reconfigure)(config)
            return "set"

        self._post(f"factor {factor:g}", reconfigure)


class Driver:
    """Publishes cmd_vel while somebody drives, from a thread of its own, so that nothing else can delay a stop.

    Otherwise there is no publisher: a simulator in lockstep treats every publisher of cmd_vel as a controller.
    """

    def __init__(self, dead_man: DeadMan, linear: float, angular: float) -> None:
        self._dead_man = dead_man
        self._full = (linear, angular)  # [m/s], [rad/s]
        self._wake = threading.Condition()
        self._publishers: Dict[str, rospy.Publisher] = {}  # by robot
        threading.Thread(target=self._work, daemon=True, name="driver").start()

    def drive(self, page: int, robot: str, share: Twist2D) -> bool:
        """A page's request, a share of the full speed; whether nobody was driving this robot before."""
        twist = Twist2D(share.v * self._full[0], share.w * self._full[1])
        with self._wake:
            begins = self._dead_man.request(page, robot, twist, time.monotonic())
            if begins:
                self._wake.notify()
        return begins

    def release(self, page: int) -> None:
        """A page has released its button, or has gone."""
        with self._wake:
            self._dead_man.release(page)
            self._wake.notify()

    def stop(self) -> None:
        """Stop now, whichever page is driving."""
        with self._wake:
            self._dead_man.stop()
            self._wake.notify()

    def end(self) -> None:
        """Before topics are closed: stop the robot that is being driven, and wait until that has been sent."""
        self.stop()
        wait_until(lambda: not self._dead_man.active, END_PATIENCE)

    def _work(self) -> None:
        used = time.monotonic()
        while True:
            with self._wake:
                self._wake.wait(DRIVE_PERIOD if self._dead_man.active else DRIVE_LINGER if self._publishers else None)
                command = self._dead_man.command(time.monotonic())
            if command is not None:
                self._publish(command.robot, command.twist)
                used = time.monotonic()
            elif time.monotonic() - used >= DRIVE_LINGER:
                while self._publishers:
                    self._publishers.popitem()[1].unregister()

    def _publish(self, robot: str, twist: Twist2D) -> None:
        if robot not in self._publishers:
            self._publishers[robot] = rospy.Publisher(absolute(robot, "cmd_vel"), Twist, queue_size=1)
        try:
            self._publishers[robot].publish(convert.to_twist_msg(twist))
        except rospy.ROSException as error:  # the node is shutting down
            rospy.logdebug("cmd_vel: %s", error)
