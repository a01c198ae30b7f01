"""The simulator in this very process, with its topics, and one inbox for all that comes back."""

import queue
import time
from dataclasses import replace
from typing import Any, Callable, Optional, Tuple

import genpy
import numpy as np
import rosbag
import rospkg
import rospy
from rosgraph_msgs.msg import Clock
from tf2_msgs.msg import TFMessage

from ...errors import CommandError, WorldError
from ...geometry import Pose2D, Twist2D, compose, inverse
from ...goto import clearance_ahead
from ...models import load_model
from ...nodes import convert
from ...nodes.publishing import publisher
from ...nodes.robot_topics import RobotTopics
from ...params import SimParams
from ...simulator import JOINTS, Observations, RobotSpec, Simulator
from .. import record as rec
from ..plan import Plan, site, world_of
from ..record import Sample
from .watch import Watch

AHEAD = np.radians(30.0)
# /cmd_vel is held for ever, as in the lab. A clock of 30 Hz costs less than one of 60, and each tick is one of its own.
PARAMS = SimParams(clock_rate=30, cmd_vel_timeout=0.0)
STEPS_PER_TICK = PARAMS.physics_rate // PARAMS.control_rate
# [s, wall] between a control tick's data and its clock: on a robot, too, odometry is there well before a 10 Hz loop
# wakes up, but here a node's threads would race for which is first.
DIGEST = 0.003
ZERO_EVERY, NAN_EVERY = 5, 7  # beams of an odd scan: lidars report no return as 0 (LDS-01), inf or NaN (REP-117)

MOST_WAITING = 20_000  # messages
MOST_BAG = 32 * 1024 ** 2  # bytes
MOST_LISTED = 100  # entries of a message's list

Event = Tuple[str, Any]


def trimmed(message: Any) -> Any:
    """The message, its texts and lists cut to what is of use to anybody."""
    for name in message.__slots__:
        value = getattr(message, name)
        if isinstance(value, str):
            setattr(message, name, value[:rec.MOST_TEXT])
        elif isinstance(value, (list, tuple)):
            setattr(message, name, [trimmed(it) if isinstance(it, genpy.Message) else it for it in value[:MOST_LISTED]])
        elif isinstance(value, genpy.Message):
            trimmed(value)
    return message


class Stage:
    """One robot in the world of all scenarios; only the main thread touches it."""

    def __init__(self, plan: Plan) -> None:
        share = rospkg.RosPack().get_path("aro_robocop_goto_as")
        model = load_model(PARAMS.model, share)
        self.sim = Simulator(PARAMS, world_of(plan), [RobotSpec("", model, Pose2D())])
        self.clock = publisher("/clock", Clock, latch=True)
        self.tf = publisher("/tf", TFMessage)
        self.tf_static = publisher("/tf_static", TFMessage, latch=True)
        self.robot = RobotTopics(0, "", PARAMS, self.sim.lidar.spec, has_camera=False)
        self.inbox: queue.Queue[Event] = queue.Queue()
        self.odd_scan = False
        self.bag: Optional[rosbag.Bag] = None
        self.tick_number = 0
        self.p = PARAMS  # this and the controls for GazeboServices
        self.control = self.world_control = _Untouched()
        self.watch: Optional[Watch] = None  # who is to be shown the run

    def wall(self) -> float:
        """The wall clock [s], without what went by for the sake of whoever watches: what deadlines go by."""
        return time.monotonic() - (0.0 if self.watch is None else self.watch.slept)

    @property
    def now(self) -> float:
        """Simulated time [s]."""
        return self.sim.time

    @property
    def stamp(self) -> rospy.Time:
        """Simulated time, for messages."""
        return convert.to_time(self.sim.stamp_ns)

    def listen(self, topic: str, kind: Any, name: str, of: Callable[[Any], Any] = trimmed) -> rospy.Subscriber:
        """Put what comes on a topic into the inbox, under a name; `of` makes of a message what is kept of it."""

        def take(message: Any) -> None:
            if self.inbox.qsize() < MOST_WAITING:  # who floods us is heard as far as we can follow
                self.inbox.put((name, of(message)))

        return rospy.Subscriber(topic, kind, take, tcp_nodelay=True)

    def begin(self, index: int, odd_scan: bool) -> None:
        """The robot to the start of a scenario: standing at its site, odometry at zero."""
        self.odd_scan = odd_scan
        self.sim.reset(PARAMS.seed)
        self.sim.place(site(index))
        self._send_static()

    def set_down(self, index: int, odom_from_base: Pose2D) -> None:
        """Set the robot down elsewhere on its site; its odometry goes on as if nothing had happened."""
        self.sim.place(compose(site(index), odom_from_base))
        self._send_static()

    def command(self, twist: Twist2D) -> bool:
        """A velocity for the robot from now on; False for one with NaN or infinity in it, which is left out."""
        try:
            self.sim.command(twist)
        except CommandError:
            return False
        return True

    def tick(self, real_time: bool = True) -> Sample:
        """Move time on by one control tick and publish what it brings; the truth at its end.

        Somebody who watches sees it at real time, unless that is of no use.
        """
        self.tick_number += 1
        sent = {sensor for sensor in self.robot.wanted() if sensor != JOINTS}
        wanted = {sensor: [0] for sensor in (sent if self.watch is None else {*sent, JOINTS})}
        for _ in range(STEPS_PER_TICK):
            seen = self.sim.step(wanted)
            if seen is not None:
                if self.watch is not None:
                    self.watch.saw(seen, real_time)
                self._publish(seen, sent)
        return self.sample()

    def repeat_clock(self) -> None:
        """For nodes that have just come up."""
        self.clock.publish(self.stamp)

    def _publish(self, seen: Observations, wanted: "set[str]") -> None:
        stamp = convert.to_time(seen.stamp_ns)
        if self.odd_scan and 0 in seen.scans:
            seen = replace(seen, scans={0: _odd(seen.scans[0])})
        self.robot.publish(seen, stamp, wanted)
        if seen.odometry is not None:
            transforms = self.robot.transforms(seen, self.sim.map_from_odom(), stamp)
            self.tf.publish(transforms)
            if self.watch is not None:
                self.watch.moves(transforms)
        if self.bag is not None:
            self._write(seen, stamp)
        if seen.clock:
            if seen.control:
                time.sleep(DIGEST)
            self.clock.publish(stamp)

    def _write(self, seen: Observations, stamp: rospy.Time) -> None:
        if 0 in seen.scans:
            self.keep(
                "/scan",
                convert.to_scan(seen.scans[0].tolist(), self.sim.lidar.spec, stamp, self.robot.scan_frame),
                stamp,
            )
        if seen.odometry is not None:
            odometry, truth = seen.odometry[0], self.sim.world_from_base()
            zeros = [0.0] * 36
            self.keep(
                "/odom",
                convert.to_odometry(
                    odometry.odom_from_base, odometry.twist, stamp, self.robot.odom_frame, self.robot.base_frame, zeros
                ),
                stamp,
            )
            self.keep(
                "/ground_truth_odom",
                convert.to_odometry(
                    truth, self.sim.velocity(), stamp, PARAMS.world_frame, self.robot.base_frame, zeros
                ),
                stamp,
            )

    def keep(self, topic: str, message: Any, stamp: Optional[rospy.Time] = None) -> None:
        """Into the scenario's bag."""
        if self.bag is not None and self.bag.size < MOST_BAG:
            self.bag.write(topic, message, stamp or max(self.stamp, rospy.Time(0, 1)))

    def _send_static(self) -> None:
        transforms = [
            convert.to_transform(PARAMS.world_frame, PARAMS.map_frame, Pose2D(), self.stamp),
            convert.to_transform(PARAMS.map_frame, PARAMS.odom_frame, self.sim.map_from_odom(), self.stamp),
        ]
        self.tf_static.publish(transforms)
        if self.watch is not None:
            self.watch.stands(transforms)

    def odom_from_base(self) -> Pose2D:
        """Where the robot truly is in its odom frame."""
        return compose(inverse(self.sim.map_from_odom()), self.sim.world_from_base())

    def sample(self) -> Sample:
        """The truth now."""
        here, world, velocity = self.odom_from_base(), self.sim.world_from_base(), self.sim.velocity()
        spec = self.sim.lidar.spec
        ahead = clearance_ahead(self.sim.exact_distances(), spec.angle_min, spec.increment, 0.0, float("inf"), AHEAD)
        return Sample(
            self.now,
            here.x,
            here.y,
            here.yaw,
            world.x,
            world.y,
            world.yaw,
            velocity.v,
            velocity.w,
            float("inf") if ahead is None else ahead,
            bool(self.sim.touching()),
        )

    # -- for GazeboServices, which takes its node to be a SimNode --

    def place(self, *what: Any) -> None:
        """Nobody but the grader sets the robot down."""
        self.control.refuse(*what)

    def in_loop(self, action: Callable[[], Any]) -> Any:
        """Have the main thread do something, and wait for what it returns."""
        answer: queue.Queue[Tuple[Any, Optional[Exception]]] = queue.Queue()

        def job() -> None:
            try:
                answer.put((action(), None))
            except Exception as error:  # handed over to the service's thread, whose it is
                answer.put((None, error))

        self.inbox.put(("job", job))
        value, error = answer.get()
        if error is not None:
            raise error
        return value


class _Untouched:
    """Time is the grader's: what else would change it does nothing."""

    def set_paused(self, _paused: bool) -> str:
        """Gazebo's pause_physics and unpause_physics."""
        return "time goes on: this is a grader"

    reset = set_paused

    def refuse(self, *_what: Any) -> str:
        """Gazebo's ways to move, make and remove models."""
        raise WorldError("the world and the robot's place in it are the grader's")

    set_down = spawn = delete = refuse


def _odd(ranges: np.ndarray) -> np.ndarray:
    """A scan (n,) [m] with no-return values of all kinds among its beams."""
    odd = np.array(ranges)
    odd[::ZERO_EVERY] = 0.0
    odd[::NAN_EVERY] = np.nan
    return odd


def outlines(plan: Plan, name: str) -> Tuple[Tuple[float, ...], ...]:
    """A scenario's obstacles seen from above, in odom: x, y, x, y, ... [m]."""
    found = []
    for scenario in plan.scenarios:
        for kind, values in scenario.obstacles if scenario.name == name else ():
            if kind == "box":
                x, y, yaw, length, width = values
                corners = [
                    compose(Pose2D(x, y, yaw), Pose2D(sx * length / 2, sy * width / 2))
                    for sx, sy in ((1, 1), (-1, 1), (-1, -1), (1, -1))
                ]
            else:
                x, y, radius = values
                corners = [
                    Pose2D(x + radius * np.cos(a), y + radius * np.sin(a)) for a in np.linspace(0, 2 * np.pi, 17)
                ]
            found.append(tuple(round(float(n), 4) for corner in corners for n in (corner.x, corner.y)))
    return tuple(found)
