"""robocop_sim: connects the simulation loop to topics and services."""

import contextlib
from typing import AbstractSet, Optional, Sequence

import rospy
from rosgraph_msgs.msg import Clock

from ...component_params import LockstepParams, TimeParams
from ...errors import CommandError, ParameterError
from ...geometry import Twist2D
from ...params import SimParams
from ...simulation.factory import footprint_radius
from ...simulation.lockstep import Controller
from ...simulation.loop import LoopInterface, SimulationLoop
from ...simulation.observations import TF, Observations, Subscriptions
from ...simulation.simulator import Simulator
from .. import convert, param_server
from ..node_main import node
from ..outbox import Outbox
from ..packed import PackedClock, stamp_of
from ..private_api import set_latched
from ..publishing import publisher, send
from .factory import build_simulator, message_config
from .gazebo_topics import GazeboTopics
from .pose_inputs import PoseInputs
from .robot_inputs import RobotInputs
from .robot_topics import MessageConfig, RobotTopics
from .status import StatusTopics, controller_name
from .subscriptions import SubscriptionTable
from .time_services import TimeServices
from .transform_topics import TransformTopics
from .world_services import WorldServices
from .world_topics import NamedRobot, WorldTopics


class SimNode(LoopInterface):
    """The loop's thread publishes; rospy's threads only post jobs to the loop."""

    def __init__(
        self,
        simulator: Simulator,
        messages: MessageConfig,
        time: TimeParams,
        lockstep: LockstepParams,
        engine_kind: str,
        radii: Sequence[float],
    ) -> None:
        """`radii` [m] of the robots, as RViz shows them."""
        self.simulator = simulator
        self.loop = SimulationLoop(simulator, time, lockstep, self)
        names = [robot.name for robot in simulator.robots]
        table = self._table = SubscriptionTable()
        self._clock = publisher("/clock", Clock, latch=True)
        self._clock_message = PackedClock()
        self._outbox = Outbox()
        self._transforms = TransformTopics(messages.frames, messages.topics, names, table.changed)
        self._robots = [
            RobotTopics(index, robot.name, messages, simulator.camera_of(index), table.changed)
            for index, robot in enumerate(simulator.robots)
        ]
        table.set_topics([{**robot.by_sensor, TF: self._transforms.tf} for robot in self._robots])
        markers: Sequence[NamedRobot] = [
            (robot.name, robot.footprint_frame, radius) for robot, radius in zip(self._robots, radii) if robot.name
        ]
        publish_map = messages.topics.publish_map or simulator.world.occupancy is not None
        self._world = WorldTopics(messages.frames, publish_map, markers)
        self._status = StatusTopics(self.loop, engine_kind)
        self._inputs = [self._connect_inputs(index, name, lockstep) for index, name in enumerate(names)]
        self._poses = PoseInputs(self.loop, messages.frames, messages.topics.initialpose)
        self._time_services = TimeServices(self.loop)
        self._world_services = WorldServices(self.loop)
        self._gazebo = GazeboTopics(names) if messages.topics.gazebo_topics else None
        if messages.topics.gazebo_services:
            _serve_gazebo(self.loop, self._world_services)

    def _connect_inputs(self, robot: int, name: str, lockstep: LockstepParams) -> RobotInputs:
        def on_command(sender: str, twist: Twist2D) -> None:
            self.loop.post(lambda: self.loop.command(Controller(robot, sender), twist))

        def on_answer(sender: str, tick_ns: int, twist: Optional[Twist2D]) -> None:
            self.loop.post(lambda: self.loop.answer(Controller(robot, sender), tick_ns, twist))

        return RobotInputs(name, lockstep.enabled, on_command, on_answer)

    def run(self) -> None:
        """Simulate until shutdown."""
        self.frames_changed()
        self.world_changed()
        self.loop.run()

    # -- called by the loop --

    def stopped(self) -> bool:
        """Whether the node is shut down."""
        return bool(rospy.is_shutdown())

    def subscriptions(self) -> Subscriptions:
        """The sensors that somebody subscribes to."""
        return self._table.current()

    def publish(self, observations: Observations) -> None:
        """All of one step with its stamp; the clock last, so that the data of a tick is there when the clock ticks."""
        if observations.measured:
            for robot in self._robots:
                robot.publish(observations, self._outbox)
        self._transforms.publish(observations, self._outbox)
        self._outbox.flush()
        if observations.control and self.simulator.moving:
            self._world.publish_moving(self.simulator)
        if observations.clock:
            if self._gazebo is not None:
                self._gazebo.publish(self.simulator)
            self.publish_clock()

    def publish_clock(self) -> None:
        """Publish simulated time, latched."""
        set_latched(self._clock, Clock(convert.to_time(self.simulator.stamp_ns)))
        send(self._clock, self._clock_message.update(stamp_of(self.simulator.stamp_ns)))

    def report(self) -> None:
        """Publish the status when it is due."""
        self._status.report()

    def status_changed(self) -> None:
        """Publish the status now."""
        self._status.publish()

    def frames_changed(self) -> None:
        """Publish the static transforms anew."""
        self._transforms.publish_static(self.simulator)

    def world_changed(self) -> None:
        """Show the whole world anew."""
        self._world.publish(self.simulator)

    def connected(self, robot: int) -> AbstractSet[str]:
        """Names of the nodes that are connected to a robot's inputs."""
        return self._inputs[robot].connected()

    def answering(self, robot: int) -> AbstractSet[str]:
        """Names of the nodes that are connected to answer a robot's ticks."""
        return self._inputs[robot].answering()

    def command_refused(self, error: CommandError) -> None:
        """Warn, not more than every 5 s."""
        rospy.logwarn_throttle(5.0, "%s", error)

    def controllers_late(self, controllers: Sequence[Controller]) -> None:
        """Warn that simulated time continues without these."""
        names = ", ".join(controller_name(controller, self.simulator.robots) for controller in controllers)
        timeout = self.loop.lockstep_timeout
        rospy.logwarn("lockstep: no answer from %s within %g s; simulated time continues without it", names, timeout)

    def controller_gone(self, controller: Controller) -> None:
        """Warn that a controller disconnected."""
        name = controller_name(controller, self.simulator.robots)
        rospy.logwarn("lockstep: %s disconnected; the robot is stopped", name)

    def placed_in_contact(self, robot: int) -> None:
        """Warn that a robot was placed in contact with something."""
        name, pose = self.simulator.robots[robot].name, self.simulator.world_from_footprint(robot)
        rospy.logwarn(
            "robot %sis placed in contact with an obstacle or another robot, at x %.2f y %.2f",
            name and name + " ",
            pose.x,
            pose.y,
        )


def _serve_gazebo(loop: SimulationLoop, world_services: WorldServices) -> None:
    """Gazebo's services; their types exist only where somebody has built them."""
    try:
        from .gazebo_services import GazeboControl, GazeboServices
    except ImportError as error:
        advice = "link compat/gazebo_msgs into the workspace, and build"
        raise ParameterError(f"gazebo_services: {error}; {advice}") from error
    GazeboServices(loop, GazeboControl(loop, world_services))


def main() -> None:
    """Run the node until it is shut down; exit status 1 when it cannot start, with the reason logged."""
    # This node makes simulated time, so it must not wait for it: its own rospy runs on the wall clock.
    with node("robocop_sim", disable_rostime=True):
        p = param_server.load(SimParams)
        with contextlib.closing(build_simulator(p)) as simulator:
            radii = [footprint_radius(p, robot.model) for robot in simulator.robots]
            SimNode(simulator, message_config(p), p.time(), p.lockstep(), p.drive, radii).run()
