"""robocop_sim: what the loop of simulation.running publishes, and what reaches it from other nodes."""

import contextlib
from typing import AbstractSet, Any

import rospy

from ...errors import ParameterError
from ...names import SIMULATOR
from ...simulation.agenda import StepEvents
from ...simulation.params import SimParams, TopicParams
from ...simulation.running import RunningSimulator
from ...simulation.simulator import Change, Simulator
from ..node_main import answer_help, end_with_master, load_params, node
from ..publishing.publisher import resume
from .command_topics import CommandTopics
from .loading import load_simulator
from .services import SimulatorServices
from .status import StatusTopics
from .step_topics import StepTopics
from .world_topics import WorldTopics


class SimNode:
    """One thread runs the loop and publishes; rospy's threads only post jobs to it."""

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator
        self._running = RunningSimulator(simulator, stopped=rospy.is_shutdown)
        self._topics = StepTopics(simulator)
        self._world = WorldTopics(simulator)
        self._status = StatusTopics(self._running)
        self._commands = CommandTopics(self._running)
        self._services = SimulatorServices(self._running)
        self._gazebo: Any = None
        self._offer_gazebo(simulator.params.topics)

    def _offer_gazebo(self, topics: TopicParams) -> None:
        """Gazebo's topics and services, imported only where they are asked for."""
        if topics.gazebo_topics:
            from .gazebo_topics import GazeboTopics

            self._gazebo = GazeboTopics(self._simulator)
        if topics.gazebo_services:
            try:  # the types of services exist only where somebody has built them
                from .gazebo_services import GazeboServices
            except ImportError as error:
                advice = "link compat/gazebo_msgs into the workspace, and build"
                raise ParameterError(f"gazebo_services: {error}; {advice}") from error
            GazeboServices(self._simulator, self._running.jobs.call, self._services)

    def run(self) -> None:
        """Simulate until shutdown."""
        for now in self._running.rounds(self._topics.subscriptions, self._commands.connected):
            if now.due is not None:
                self._publish(now.due, now.more)
                continue
            self._publish_changes(now.changes)
            if now.clock:
                self._topics.publish_clock()
            if now.outcome is not None:
                self._status.warn_of(now.outcome)
            if self._status.publish_due():
                resume()

    def _publish(self, due: StepEvents, more: bool) -> None:
        """Publish what is due on this step, and warn of robots that were placed in contact with something."""
        if due.control and self._simulator.moving:
            self._world.publish_moving()
        if due.clock and self._gazebo is not None:
            self._gazebo.publish()
        self._topics.publish(due, more)
        for robot in self._simulator.newly_placed_in_contact():
            name, pose = self._simulator.robots[robot].name, self._simulator.world_from_footprint(robot)
            text = "robot %sis placed in contact with an obstacle or another robot, at x %.2f y %.2f"
            rospy.logwarn(text, name and name + " ", pose.x, pose.y)

    def _publish_changes(self, changes: AbstractSet[Change]) -> None:
        """Publish again the topics whose content has changed other than by a step."""
        if Change.FRAMES in changes:
            self._topics.publish_static()
        if Change.WORLD in changes:
            self._world.publish()
        if changes & {Change.PAUSED, Change.RESET}:
            self._status.publish()


def main() -> None:
    """Run the node until it is shut down; exit status 1 when it cannot start, with the reason logged."""
    answer_help("The simulator: a world and its robots; publishes scan, odom, tf and clock, obeys cmd_vel.")
    # This node makes simulated time, so it must not wait for it: its own rospy runs on the wall clock.
    with node(SIMULATOR, disable_rostime=True):
        with contextlib.closing(load_simulator(load_params(SimParams))) as simulator:
            end_with_master()
            SimNode(simulator).run()
