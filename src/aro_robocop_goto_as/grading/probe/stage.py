"""The simulation that a submission meets: one robot, its topics, and what the submission sends back."""

import time
from dataclasses import replace
from typing import Any, Callable, Dict, List, Optional, Tuple

import genpy
import numpy as np
import rospkg
import rospy
from rosgraph_msgs.msg import Clock

from ...errors import CommandError
from ...geometry import Pose2D, Twist2D, compose, inverse
from ...goto import clearance_ahead
from ...params import SimParams
from ...robot.catalog import load_model
from ...robot.model import RobotSpec
from ...ros import convert
from ...ros.outbox import Outbox
from ...ros.publishing import publisher
from ...ros.sim.factory import message_config
from ...ros.sim.robot_topics import RobotTopics
from ...ros.sim.subscriptions import SubscriptionTable
from ...ros.sim.transform_topics import TransformTopics
from ...simulation.factory import make_simulator
from ...simulation.loop import SimulationLoop
from ...simulation.loop_interface import LoopInterface
from ...simulation.observations import JOINTS, ODOM, TF, Observations, Subscriptions
from .. import record as rec
from ..handout import AHEAD
from ..plan import Plan, site, world_of
from ..record import Sample
from .scenario_bag import ScenarioBag
from .watch import Watch

# cmd_vel never times out, as in the lab. 30 Hz is the cheapest clock rate that includes every 10 Hz control tick.
# A submission has to use odom, not the truth.
PARAMS = SimParams(clock_rate=30, cmd_vel_timeout=0.0, ground_truth=False)
STEPS_PER_TICK = PARAMS.physics_rate // PARAMS.control_rate
ZERO_EVERY, NAN_EVERY = 5, 7  # beams of an odd scan: lidars report no return as 0 (LDS-01), inf or NaN (REP-117)

MAX_EXCLUDED = 600.0  # [s, wall]
REPORT_EVERY = 0.5  # [s, wall]
MOST_WAITING = 20_000  # messages
MOST_LISTED = 100  # entries of a message's list


def trimmed(message: Any) -> Any:
    """Truncate a message's strings and lists; returns the message."""
    for name in message.__slots__:
        value = getattr(message, name)
        if isinstance(value, str):
            setattr(message, name, value[: rec.MOST_TEXT])
        elif isinstance(value, (list, tuple)):
            setattr(message, name, [trimmed(it) if isinstance(it, genpy.Message) else it for it in value[:MOST_LISTED]])
        elif isinstance(value, genpy.Message):
            trimmed(value)
    return message


class Stage(LoopInterface):
    """One robot in the world of all scenarios. The main thread owns it; what arrives is posted to it as a job."""

    def __init__(self, plan: Plan) -> None:
        share = rospkg.RosPack().get_path("aro_robocop_goto_as")
        robot = RobotSpec("", load_model(PARAMS.model, share), Pose2D())
        self.sim = make_simulator(PARAMS, world_of(plan), [robot])
        self.loop = SimulationLoop(self.sim, PARAMS.time(), PARAMS.lockstep(), self)
        self._table = SubscriptionTable()
        frames, messages = PARAMS.frames(), message_config(PARAMS)
        self.clock = publisher("/clock", Clock, latch=True)
        self._outbox = Outbox()
        self._transforms = TransformTopics(frames, messages.topics, [""], self._table.changed)
        self.robot = RobotTopics(0, "", messages, camera=None, on_change=self._table.changed)
        self._table.set_topics([{k: topic for k, topic in self.robot.by_sensor.items() if k != JOINTS}])
        self.handlers: Dict[str, Callable[[Any], object]] = {}  # by the name under which a message is posted
        self.odd_scan = False
        self.bag = ScenarioBag(self.sim, self.robot, self._transforms, frames)
        self._site = Pose2D()  # world_from_odom at the scenario's start
        self.tick_number = 0
        self.before_tick: Callable[[], None] = lambda: None  # called before the clock reaches a control tick
        self.after_publishing: Callable[[], None] = lambda: None  # called after each step with something to publish
        self.watch: Optional[Watch] = None  # shows the run, if somebody watches it
        self._real_time = True
        self._excluded, self._unreported = 0.0, 0.0  # [s, wall] in total, and of these not yet reported to the grader

    def wall(self) -> float:
        """The wall clock [s] for deadlines, without the time spent on showing the run and what was excluded."""
        return time.monotonic() - self._excluded - (0.0 if self.watch is None else self.watch.slept)

    def exclude_from_deadlines(self, seconds: float) -> None:
        """Exclude from deadlines time [s, wall] that a node needed for its work, as on a busy machine."""
        seconds = min(seconds, MAX_EXCLUDED - self._excluded)
        self._excluded += seconds
        self._unreported += seconds
        if self._unreported > REPORT_EVERY:
            print(f"slept {self._unreported:.3f}", flush=True)  # the grader's own deadline
            self._unreported = 0.0

    @property
    def now(self) -> float:
        """Simulated time [s]."""
        return self.sim.time

    @property
    def stamp(self) -> rospy.Time:
        """Simulated time, for messages."""
        return convert.to_time(self.sim.stamp_ns)

    # -- what arrives --

    def post(self, name: str, payload: Any) -> None:
        """Have the main thread handle something; may be called from any thread."""

        def handle() -> None:
            if name in self.handlers:
                self.handlers[name](payload)

        self.loop.post(handle)

    def listen(self, topic: str, kind: Any, name: str, of: Callable[[Any], Any] = trimmed) -> rospy.Subscriber:
        """Post what arrives on a topic under a name; `of` reduces a message to what is kept of it."""

        def receive(message: Any) -> None:
            if self.loop.jobs_waiting < MOST_WAITING:  # messages of a flood beyond that are dropped
                self.post(name, of(message))

        return rospy.Subscriber(topic, kind, receive, tcp_nodelay=True)

    # -- the robot --

    def begin(self, index: int, odd_scan: bool) -> None:
        """Put the robot at the start of a scenario: at rest at its site, odometry at zero."""
        self.odd_scan = odd_scan
        self._site = site(index)
        self.loop.reset(PARAMS.seed)
        self.loop.place(site(index))
        self.bag.write_scenery(self._site)

    def teleport(self, index: int, odom_from_footprint: Pose2D) -> None:
        """Place the robot elsewhere on its site; its odometry continues as if nothing had happened."""
        self.loop.place(compose(site(index), odom_from_footprint))

    def command(self, twist: Twist2D) -> bool:
        """Set the robot's velocity command; False if it is not finite, which leaves the previous one in force."""
        try:
            self.sim.command(twist)
        except CommandError:
            return False
        return True

    # -- time --

    def tick(self, real_time: bool = True) -> Sample:
        """Advance by one control tick and publish what is due; returns the true state at its end.

        A watched run is shown at real time, unless `real_time` is False.
        """
        self.tick_number += 1
        self._real_time = real_time
        for _ in range(STEPS_PER_TICK):
            if self.loop.advance(self.subscriptions()) is not None:
                self.after_publishing()
        return self.sample()

    def sensor_topics(self) -> List[rospy.Publisher]:
        """The topics of the robot's measurements."""
        return [*self.robot.by_sensor.values(), self._transforms.tf]

    def subscriptions(self) -> Subscriptions:
        """The submission's; odometry and transforms always, for the bag; wheel angles if the run is shown."""
        always = {ODOM: [0], TF: [0]}
        return {**self._table.current(), **always, **({} if self.watch is None else {JOINTS: [0]})}

    def publish_clock(self) -> None:
        """For nodes that have just come up."""
        self.clock.publish(self.stamp)

    def publish(self, observations: Observations) -> None:
        """One step's observations to the viewer, the submission and the bag; the clock last."""
        stamp = convert.to_time(observations.stamp_ns)
        if self.watch is not None:
            self.watch.observe(observations, self._real_time)
        shown = replace(observations, joints={})
        if self.odd_scan and 0 in shown.scans:
            shown = replace(shown, scans={0: _odd(shown.scans[0])})
        self.robot.publish(shown, self._outbox)
        self._transforms.publish(shown, self._outbox)
        self._outbox.flush()
        if self.watch is not None and 0 in shown.transforms:
            self.watch.publish_transforms(self._transforms.messages(0, shown.transforms[0], stamp))
        self.bag.write_step(shown, stamp)
        if observations.clock:
            self.bag.write("/clock", Clock(stamp), stamp)
            if observations.control:
                self.before_tick()
            self.clock.publish(stamp)

    def frames_changed(self) -> None:
        """map -> odom has jumped."""
        transforms = self._transforms.publish_static(self.sim)
        if self.watch is not None:
            self.watch.publish_static(transforms)
        self.bag.write_static_frames(self._site)

    def keep(self, topic: str, message: Any, stamp: Optional[rospy.Time] = None) -> None:
        """Into the scenario's bag, and to the page where the run is shown."""
        if self.watch is not None:
            self.watch.forward(topic, message)
        self.bag.write(topic, message, stamp)

    def odom_from_footprint(self) -> Pose2D:
        """Where the robot truly is in its odom frame."""
        return compose(inverse(self.sim.map_from_odom()), self.sim.world_from_footprint())

    def sample(self) -> Sample:
        """The truth now."""
        here, world, velocity = self.odom_from_footprint(), self.sim.world_from_footprint(), self.sim.velocity()
        spec = self.sim.lidar.spec
        ahead = clearance_ahead(
            list(map(float, self.sim.exact_distances())), spec.angle_min, spec.increment, 0.0, float("inf"), AHEAD
        )
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
