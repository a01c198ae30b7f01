"""The simulation for a submission: one robot, its topics, and the messages that the submission sends back."""

import math
from functools import partial
from typing import Callable, Dict, List, Optional, Sequence

import numpy as np
import rospy
from geometry_msgs.msg import TransformStamped
from rosgraph_msgs.msg import Clock
from tf2_msgs.msg import TFMessage

from aro_robocop_goto_as.geometry import NANOSECONDS, STANDSTILL, Pose2D, Twist2D, compose, inverse
from aro_robocop_goto_as.goto.obstacle_ahead import beams_ahead
from aro_robocop_goto_as.names import IMU_FRAME, MAP_FRAME, SCAN_FRAME, WORLD_FRAME
from aro_robocop_goto_as.robot.catalog import load_model
from aro_robocop_goto_as.robot.model import RobotSpec
from aro_robocop_goto_as.ros import convert
from aro_robocop_goto_as.ros.share import share
from aro_robocop_goto_as.ros.sim.step_topics import StepTopics
from aro_robocop_goto_as.sensors.lidar import SCAN
from aro_robocop_goto_as.sensors.odometry import ODOM
from aro_robocop_goto_as.simulation.agenda import StepEvents, Subscriptions
from aro_robocop_goto_as.simulation.factory import make_simulator
from aro_robocop_goto_as.simulation.params import SimParams

from ..handout import AHEAD
from ..record import Sample
from ..scenarios import Block
from ..sites import ORIGIN, world_of
from .node import Node
from .scenario_bag import ScenarioBag
from .step_messages import StepMessages
from .topics import Topics

# cmd_vel never times out, as in the lab. 30 Hz is the cheapest clock rate that includes every 10 Hz control tick.
# A submission has to use odom, not the truth.
PARAMS = SimParams.of(clock_rate=30, cmd_vel_timeout=0.0, ground_truth=False)
STEPS_PER_TICK = PARAMS.rates.physics_rate // PARAMS.rates.control_rate
BASE_LINK = "base_link"
ZERO_EVERY, NAN_EVERY = 5, 7  # beams of an odd scan: lidars report no return as 0 (LDS-01), inf or NaN (REP-117)


class Stage:
    """One robot, and the world of the present scenario."""

    def __init__(self) -> None:
        robot = RobotSpec("", load_model(PARAMS.robots.model, share()), Pose2D())
        self.sim = make_simulator(PARAMS, world_of(ORIGIN), [robot])
        published = StepTopics(self.sim)
        self.robot = published.robots[0]
        self._messages = StepMessages(self.sim, published)
        self._sensors: Dict[str, str] = {}  # by topic
        self.topics = Topics()
        advertised = [(sensor, topic) for sensor, (topics,) in published.topics.items() for topic, _ in topics]
        for sensor, topic in [*advertised, (ODOM, published.tf)]:
            self._sensors[topic.name] = sensor
            self.topics.advertise(topic.name, topic.data_class)
        self.topics.advertise("/tf_static", TFMessage, latch=True)
        self.topics.advertise("/clock", Clock, latch=True)  # the agent sends it
        self.odd_scan = False
        lidar = self.sim.sensors.lidar.profile
        self._ahead = beams_ahead(lidar.samples, lidar.angle_min, lidar.increment, AHEAD)
        self.bag = ScenarioBag(self.sim, WORLD_FRAME)
        self.clock_ns = 0  # [ns] as on /clock
        self._site = ORIGIN  # world_from_odom at the scenario's start
        self.node: Optional[Node] = None  # that is graded
        self._commanded, self._pushed = STANDSTILL, None  # type: Twist2D, Optional[Twist2D]

    @property
    def now(self) -> float:
        """Simulated time [s]."""
        return self.sim.time

    @property
    def stamp(self) -> rospy.Time:
        """Simulated time, for messages."""
        return convert.to_time(self.sim.stamp_ns)

    # -- the robot --

    def begin(self, site: Pose2D, blocks: Sequence[Block], odd_scan: bool) -> None:
        """Put the robot at the start of a scenario: at rest at its site among these blocks, odometry at zero."""
        self.odd_scan = odd_scan
        self.push(None)
        self._site = site
        self.sim.change_world(world_of(site, blocks))
        self.sim.reset(PARAMS.world.seed)
        self.sim.place(site)
        self._publish_frames()
        self.bag.write_scenery()

    def teleport(self, odom_from_footprint: Pose2D) -> None:
        """Place the robot elsewhere on its site; its odometry continues as if nothing had happened."""
        self.sim.place(compose(self._site, odom_from_footprint))
        self._publish_frames()

    def command(self, twist: Twist2D) -> None:
        """Set the robot's velocity command; a command that is not finite leaves the previous command in force."""
        if math.isfinite(twist.v) and math.isfinite(twist.w):
            self._commanded = twist
            if self._pushed is None:
                self.sim.command(twist)

    def push(self, twist: Optional[Twist2D]) -> None:
        """Move the robot and its wheels by hand, whatever is commanded; None lets go of it."""
        if twist != self._pushed:
            self._pushed = twist
            self.sim.command(self._commanded if twist is None else twist)

    # -- time --

    def tick(self) -> Sample:
        """Advance by one control tick and publish what is due; return the true state at the tick's end."""
        end = self.sim.steps + STEPS_PER_TICK
        while self.sim.steps < end:
            # Up to the first step at or after the time at which the node does something by itself.
            until = end if self.node is None else min(end, -(-self.node.next_ns * self.sim.rate // NANOSECONDS))
            due = self.sim.advance(self._subscriptions(), max(1, until - self.sim.steps))
            if due is not None:
                self._publish(due)
            if self.node is not None and self.node.next_ns <= self.sim.stamp_ns:
                self.run_node()
        return self.sample()

    def advance_between_transforms(self) -> None:
        """Let half an odometry period pass, so that the robot's newest transform is older than now."""
        self.sim.advance({}, self.sim.rate // PARAMS.sensors.odometry.odom_rate // 2)
        self.clock_ns = self.sim.stamp_ns

    def run_node(self, meanwhile: Callable[[], object] = lambda: None) -> None:
        """Let the node process everything up to the present simulated time; `meanwhile` is called meanwhile, once."""
        if self.node is not None:
            self.node.run_until(self.sim.stamp_ns, self.clock_ns, meanwhile)
        else:
            meanwhile()

    def _subscriptions(self) -> Subscriptions:
        """The node's; odometry always, for the bag."""
        wanted = {sensor for topic, sensor in self._sensors.items() if self.topics.node_subscribes_to(topic)}
        return {sensor: [0] for sensor in sorted({ODOM, *wanted})}

    def _publish(self, due: StepEvents) -> None:
        """Send what is due on a step to the submission, and write it to the bag."""
        if self.odd_scan and due.of(SCAN):
            ranges = self.sim.sensors.lidar.ranges
            ranges[0, ::ZERO_EVERY], ranges[0, ::NAN_EVERY] = 0.0, np.nan
        messages = self._messages.of(due)
        for topic, _, data in messages:
            if topic in self._sensors:  # the agent sends /clock when its callbacks may see it
                self.topics.send(topic, data)
        if due.clock:
            self.clock_ns = self.sim.stamp_ns
        self.run_node(partial(self.bag.write_step, self.sim.stamp_ns, messages))

    def _publish_frames(self) -> None:
        """Publish the static frames anew, as map -> odom has jumped."""
        frames = self._static_frames(Pose2D())
        frames.transforms += self._links()
        self.topics.publish("/tf_static", frames)
        # In a replay, map is odom at the scenario's start; in the submission's map that is many metres away.
        self.bag.write("/tf_static", self._static_frames(self._site))

    def _static_frames(self, world_from_map: Pose2D) -> TFMessage:
        map_from_odom = compose(inverse(world_from_map), self.sim.map_from_odom())
        return TFMessage(
            [
                convert.to_transform(WORLD_FRAME, MAP_FRAME, world_from_map, self.stamp),
                convert.to_transform(MAP_FRAME, self.robot.odom, map_from_odom, self.stamp),
            ]
        )

    def _links(self) -> List[TransformStamped]:
        """The transforms that robot_state_publisher sends in the lab for the robot's links, except the wheels."""
        model = self.sim.robots[0].model
        return [
            convert.to_transform_3d(self.robot.footprint, BASE_LINK, model.footprint_from_base, self.stamp),
            convert.to_transform_3d(BASE_LINK, SCAN_FRAME, model.base_from_scan, self.stamp),
            convert.to_transform_3d(BASE_LINK, IMU_FRAME, model.base_from_imu, self.stamp),
        ]

    def odom_from_footprint(self) -> Pose2D:
        """Where the robot truly is in its odom frame."""
        return compose(inverse(self.sim.map_from_odom()), self.sim.world_from_footprint())

    def sample(self) -> Sample:
        """The truth now."""
        here, world, velocity = self.odom_from_footprint(), self.sim.world_from_footprint(), self.sim.velocity()
        nearest = float(self.sim.exact_distances()[self._ahead].min())
        return Sample(self.now, *here, *world, *velocity, nearest, bool(self.sim.touching()))
