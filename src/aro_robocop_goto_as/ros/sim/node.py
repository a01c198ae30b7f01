"""robocop_sim: the loop that steps the simulation, and publishes and receives all of its topics."""

import contextlib
from time import sleep
from typing import AbstractSet, Any, Callable

import rospy

from ...errors import ParameterError
from ...names import SIMULATOR
from ...sim_params import SimParams, TopicParams
from ...simulation.running import Change, Simulation
from ...simulation.simulator import Simulator
from ..node_main import answer_help, end_with_master, load_params, node
from ..publishing.publisher import resume
from .command_topics import CommandTopics
from .loading import load_simulator
from .services import Services
from .status import StatusTopics
from .step_topics import StepTopics
from .world_topics import WorldTopics

MAX_SLEEP = 0.05  # [s, wall] a sleep during which jobs may wait; waiting for jobs costs four times the processor time


class SimNode:
    """One thread runs the loop and publishes; rospy's threads only post jobs to it."""

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator
        self._simulation = Simulation(simulator, stopped=rospy.is_shutdown)
        self._topics = StepTopics(simulator)
        self._world = WorldTopics(simulator)
        self._status = StatusTopics(self._simulation)
        self._commands = CommandTopics(self._simulation)
        self._services = Services(self._simulation)
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
            GazeboServices(self._simulation, self._services)

    # -- the loop --

    def run(self) -> None:
        """Simulate until shutdown: clock ticks wait for the wall clock, lockstep control ticks for the controllers."""
        simulator, time, controllers = self._simulator, self._simulation.time_control, self._simulation.controllers
        time.pacer.restart(simulator.steps)
        self._publish(set(Change))
        self._pace()
        subscriptions = self._topics.subscriptions()
        while not rospy.is_shutdown():
            due = simulator.advance(subscriptions, time.steps_left(simulator.steps))
            if due is not None:
                if due.control and simulator.moving:
                    self._world.publish_moving()
                if due.clock and self._gazebo is not None:
                    self._gazebo.publish()
                self._topics.publish(due, more=time.unbounded and not due.control)
                if due.control and controllers.in_lockstep:
                    self._await_controllers()
            if time.end_span(simulator.steps) or (due is not None and due.clock):
                self._warn()
                self._pace()
                self._report()
                subscriptions = self._topics.subscriptions()

    def _pace(self) -> None:
        """Run the jobs that have come, and hold simulated time until the wall clock has reached it."""
        time, simulator = self._simulation.time_control, self._simulator
        self._run_jobs()
        wait = time.hold(simulator.steps)
        if 0.0 < wait < MAX_SLEEP:  # jobs that come meanwhile take effect from the next step on, as if they ran at once
            sleep(wait)
            time.pacer.waited(wait)
            self._run_jobs()
            wait = time.hold(simulator.steps)
        if wait > 0.0:
            self._hold(lambda: time.hold(simulator.steps))

    def _run_jobs(self) -> None:
        """Run the jobs that have come, and publish what they have changed."""
        self._simulation.jobs.run_queued()
        self._publish(self._simulation.take_changes())

    def _await_controllers(self) -> None:
        """Hold simulated time until the controllers have answered this tick, and apply their commands."""
        controllers, commands = self._simulation.controllers, self._commands
        controllers.begin_tick(commands.connected)
        self._hold(lambda: controllers.hold(commands.connected))
        self._status.warn_of(controllers.end_tick())

    def _hold(self, hold: Callable[[], float]) -> None:
        """Run the jobs of other threads for as long as `hold` says that simulated time has to wait [s, wall]."""
        jobs, time = self._simulation.jobs, self._simulation.time_control
        started = time.pacer.now()
        wait = hold()
        while wait > 0.0 and not rospy.is_shutdown():
            jobs.run_next(wait)
            self._publish(self._simulation.take_changes())
            if time.repetition_due():  # for nodes that start while simulated time stands still
                self._topics.publish_clock()
            self._report()
            wait = hold()
        time.pacer.waited(time.pacer.now() - started)

    def _report(self) -> None:
        """Publish what is due by the wall clock."""
        if self._status.report():
            self._status.warn_of_full_speed(self._commands.connected)
            resume()

    def _publish(self, changes: AbstractSet[Change]) -> None:
        """Publish again the topics whose content has changed other than by a step."""
        if not changes:  # in nearly all rounds of the loop
            return
        if Change.FRAMES in changes:
            self._topics.publish_static()
        if Change.WORLD in changes:
            self._world.publish()
        if Change.STATUS in changes:
            self._status.publish()

    def _warn(self) -> None:
        """Warn of robots that were placed in contact with something."""
        for robot in self._simulator.newly_placed_in_contact():
            name, pose = self._simulator.robots[robot].name, self._simulator.world_from_footprint(robot)
            text = "robot %sis placed in contact with an obstacle or another robot, at x %.2f y %.2f"
            rospy.logwarn(text, name and name + " ", pose.x, pose.y)


def main() -> None:
    """Run the node until it is shut down; exit status 1 when it cannot start, with the reason logged."""
    answer_help("The simulator: a world and its robots; publishes scan, odom, tf and clock, obeys cmd_vel.")
    # This node makes simulated time, so it must not wait for it: its own rospy runs on the wall clock.
    with node(SIMULATOR, disable_rostime=True):
        with contextlib.closing(load_simulator(load_params(SimParams))) as simulator:
            end_with_master()
            SimNode(simulator).run()
