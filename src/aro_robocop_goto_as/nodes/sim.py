"""robocop_sim: the simulator's loop, paced against the wall clock and, in lockstep, against the controllers."""

import contextlib
import queue
import time
from typing import Any, Callable, Dict, List, Set, TypeVar

import rospy
from geometry_msgs.msg import PoseWithCovarianceStamped
from rosgraph_msgs.msg import Clock
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

from aro_robocop_goto_as.msg import TickAnswer

from ..errors import CommandError, FrameError, ParameterError, RobocopError
from ..geometry import Pose2D, Twist2D, compose
from ..lockstep import Lockstep
from ..params import SimParams
from ..robot import RobotModel
from ..shapes import World
from ..simtime import NANOSECONDS
from ..simulator import Observations, Simulator
from ..spawns import FARTHEST
from . import convert, params
from .building import build_simulator
from .lifetime import node
from .map_topics import MapTopics
from .pacer import Pacer
from .publishing import publisher
from .robot_topics import RobotTopics
from .sim_control import SimControl
from .status import StatusReport
from .world_control import WorldControl
from .world_markers import CLEAR, robot_markers, world_markers

PAUSED_CLOCK_PERIOD = 0.1  # [s, wall] a paused simulator repeats its clock, so that nodes which start then have time
LONGEST_WAIT = 0.5  # [s, wall] between two looks for a parameter that was set
LOOK_PERIOD = 0.05  # [s, wall] between two looks for controllers that have disconnected, while waiting for answers

T = TypeVar("T")


class SimNode:
    """Owns the simulator: only the thread in `run` touches it; callbacks leave jobs for that thread."""

    def __init__(self, p: SimParams, sim: Simulator) -> None:
        self.p = p
        self.sim = sim
        self.pacer = Pacer(p.real_time_factor)
        self.lockstep = Lockstep()
        self.paused = p.start_paused
        self.run_until = 0  # step at which a ~step request ends; 0 = none
        self.on_span_end: Callable[[], None] = lambda: None
        # Not SimpleQueue: before Python 3.12 its get(timeout) waits for ever when a signal outlasts the timeout.
        self.jobs: queue.Queue[Callable[[], Any]] = queue.Queue()
        self.placed = set(range(len(sim.robots)))  # robots set down since the last clock tick
        self.held: Dict[int, Twist2D] = {}  # lockstep: commands that wait for the tick's end, newest of each robot

        self.clock = publisher("/clock", Clock, latch=True)
        self.tf = publisher("/tf", TFMessage)
        self.tf_static = publisher("/tf_static", TFMessage, latch=True)
        self.shapes = publisher("~world", MarkerArray, latch=True)
        self.maps = MapTopics() if p.publish_map or sim.world.occupancy is not None else None
        self.robots = [RobotTopics(index, robot.name, p, sim.lidar.spec, robot.model.base_from_camera is not None)
                       for index, robot in enumerate(sim.robots)]
        self.listeners: List[Set[str]] = [set() for _ in self.robots]
        self.status = StatusReport(self)
        for robot in self.robots:
            robot.listen(self._on_command, self._on_answer, self._on_place)
        self.control = SimControl(self)
        self.world_control = WorldControl(self)
        if p.gazebo_services:
            _serve_gazebo(self)

    # -- handed over from rospy's threads --

    def _on_command(self, robot: int, sender: str, twist: Twist2D) -> None:
        self.jobs.put(lambda: self._take_command(robot, sender, twist))

    def _on_answer(self, robot: int, sender: str, answer: TickAnswer) -> None:
        self.jobs.put(lambda: self._take_answer(robot, sender, answer))

    def _on_place(self, robot: int, message: PoseWithCovarianceStamped) -> None:
        def place() -> None:
            try:
                self.place(robot, message.header.frame_id, message.pose.pose)
            except FrameError as error:
                rospy.logerr("initialpose refused: %s", error)

        self.jobs.put(place)

    def in_loop(self, action: Callable[[], T]) -> T:
        """Have the loop's thread do something, and wait for what it returns or raises."""
        done: queue.Queue[Any] = queue.Queue()

        def job() -> None:
            try:
                done.put((action(), None))
            except RobocopError as error:
                done.put((None, error))

        self.jobs.put(job)
        while not rospy.is_shutdown():
            try:
                value, error = done.get(timeout=0.1)
            except queue.Empty:
                continue
            if error is not None:
                raise error
            return value  # type: ignore[no-any-return]
        raise rospy.ServiceException("the simulator is shutting down")

    # -- jobs, in the loop's thread --

    def _take_command(self, robot: int, sender: str, twist: Twist2D) -> None:
        name = self._controller(robot, sender)
        if self.lockstep.is_stamped(name):
            return
        if self.p.sync == "lockstep":
            self.lockstep.tick = self.tick()
            self.lockstep.commanded(name)
            self.held[robot] = twist
        else:
            self._command(robot, twist)

    def _take_answer(self, robot: int, sender: str, answer: TickAnswer) -> None:
        tick = int(round(convert.to_ns(answer.tick) * self.p.control_rate / NANOSECONDS))
        self.lockstep.answered(self._controller(robot, sender), tick)
        if answer.has_command:
            self.held[robot] = convert.from_twist_msg(answer.command)

    def _controller(self, robot: int, sender: str) -> str:
        return f"{sender} driving {self.robots[robot].name}" if len(self.robots) > 1 else sender

    def _command(self, robot: int, twist: Twist2D) -> None:
        try:
            self.sim.command(twist, robot)
        except CommandError as error:
            rospy.logwarn_throttle(5.0, "%s", error)

    def place(self, robot: int, frame: str, pose: Any) -> Pose2D:
        """Set a robot down at a geometry_msgs/Pose in world, map or its odom; FrameError for any other frame."""
        q = pose.orientation
        if not all(abs(value) <= 2.0 for value in (q.x, q.y, q.z, q.w)):
            raise FrameError(f"expected a quaternion of length 1, got x {q.x} y {q.y} z {q.z} w {q.w}")
        target = self._in_world(robot, frame.lstrip("/"), convert.from_pose_msg(pose))
        self.sim.place(target, robot)
        self.held.pop(robot, None)
        self.placed.add(robot)
        self.send_static_transforms()
        return target

    def _in_world(self, robot: int, frame: str, pose: Pose2D) -> Pose2D:
        if not all(abs(value) <= FARTHEST for value in (pose.x, pose.y, pose.yaw)):  # not so for NaN
            raise FrameError(f"expected finite numbers within +-{FARTHEST:g}, got x {pose.x} y {pose.y} yaw {pose.yaw}")
        odom_frame = self.robots[robot].odom_frame
        if frame in (self.p.world_frame, self.p.map_frame):
            return pose
        if frame == odom_frame:
            return compose(self.sim.map_from_odom(robot), pose)
        known = f"{self.p.map_frame!r}, {odom_frame!r} or {self.p.world_frame!r}"
        raise FrameError(f"its frame is {frame!r}; expected {known}")

    # -- the loop --

    def run(self) -> None:
        """Step until shutdown; clock ticks wait for the wall clock, in lockstep control ticks for the controllers."""
        self.send_static_transforms()
        self._report_world()
        self.pacer.restart(self.sim.time)
        self._serve()
        wanted = self._wanted()
        while not rospy.is_shutdown():
            seen = self.sim.step(wanted)
            if seen is not None:
                self._publish(seen)
                if seen.control and self.p.sync == "lockstep":
                    self._wait_for_answers()
            if self.run_until and self.sim.steps >= self.run_until:
                self._end_span()
                self._serve()
                wanted = self._wanted()
            elif seen is not None and seen.clock:
                self._look_at_placed()
                self._serve()
                self.status.tick()
                wanted = self._wanted()

    def _look_at_placed(self) -> None:
        """Say it where a robot was set down in something: physics pushes it out, or it can't move."""
        for robot in sorted(self.placed):
            if self.sim.touching(robot):
                name, pose = self.sim.robots[robot].name, self.sim.world_from_base(robot)
                rospy.logwarn("robot %sis set down in contact with an obstacle or another robot, at x %.2f y %.2f",
                              name and name + " ", pose.x, pose.y)
        self.placed.clear()

    def _report_world(self) -> None:
        world = self.sim.world
        rospy.loginfo("world %s from %s", world.name, world.path)
        for robot in self.sim.robots:
            rospy.loginfo("robot %sat x %.2f y %.2f yaw %.2f", robot.name and robot.name + " ", robot.spawn.x,
                          robot.spawn.y, robot.spawn.yaw)
        given = self.p.given_scan()
        if given:
            rospy.loginfo("scan_profile %s, but as given: %s", self.p.scan_profile,
                          ", ".join(f"{name} {value:g}" for name, value in given.items()))
        if world.ignored:
            rospy.loginfo("not simulated from that file: %s", ", ".join(world.ignored))
        self.show_world()

    def change_world(self, world: World) -> None:
        """Another world from now on, shown as well."""
        self.sim.change_world(world)
        self.placed.update(range(len(self.robots)))
        self.show_world()

    def show_world(self) -> None:
        """The obstacles for RViz; where a map is published, that too."""
        world = self.sim.world
        if self.maps is not None:
            self.maps.publish(self.sim.occupancy(), convert.to_time(self.sim.stamp_ns), self.p.map_frame)
        shapes = world_markers(world, self.p.world_frame, self.sim.world_time)
        if self.robots[0].name:
            shapes += robot_markers([(robot.name, topics.base_frame, self._radius(robot.model))
                                     for robot, topics in zip(self.sim.robots, self.robots)])
        self.shapes.publish([CLEAR, *shapes])

    def _radius(self, model: RobotModel) -> float:
        return self.p.footprint_radius or model.figures.footprint_radius

    def _end_span(self) -> None:
        """A ~step request has run its course."""
        self.run_until, self.paused = 0, True
        self.on_span_end()

    def _serve(self) -> None:
        """Do jobs until the wall clock reaches simulated time; while paused, until somebody lets time go on."""
        repeat_clock = time.monotonic() + PAUSED_CLOCK_PERIOD
        while not rospy.is_shutdown():
            standing = self.paused and not self.run_until
            wait = PAUSED_CLOCK_PERIOD if standing else min(LONGEST_WAIT, self.pacer.ahead(self.sim.time))
            if wait <= 0.0 and self.jobs.empty():
                return
            if standing and time.monotonic() >= repeat_clock:
                repeat_clock = time.monotonic() + PAUSED_CLOCK_PERIOD
                self.clock.publish(convert.to_time(self.sim.stamp_ns))
                self._enroll_connected()
                self.status.tick()
            started = time.monotonic()
            try:
                job = self.jobs.get(timeout=wait) if wait > 0.0 else self.jobs.get_nowait()
            except queue.Empty:
                if not standing and wait < LONGEST_WAIT:
                    return
                self.status.tick()  # time passes slowly, or not at all: somebody may want it to be otherwise
                continue
            finally:
                self.pacer.waited(time.monotonic() - started)
            job()

    def _wait_for_answers(self) -> None:
        """Let simulated time stand until every controller has answered this tick, or the time-out is over."""
        self._enroll_connected()
        self.lockstep.tick = self.tick()
        started = time.monotonic()
        while self.lockstep.missing() and not rospy.is_shutdown():
            remaining = started + self.lockstep.patience() * self.p.lockstep_timeout - time.monotonic()
            if remaining <= 0.0:
                late = self.lockstep.give_up()
                if late:
                    rospy.logwarn("lockstep: no answer within %g s from %s; simulated time goes on without",
                                  self.p.lockstep_timeout, ", ".join(late))
                break
            try:
                self.jobs.get(timeout=min(remaining, LOOK_PERIOD))()
            except queue.Empty:
                self._forget_disconnected()
        held, self.held = self.held, {}
        for robot, twist in held.items():
            self._command(robot, twist)

    def tick(self) -> int:
        """Number of the control tick that simulated time stands at or runs towards."""
        return -(-self.sim.steps * self.p.control_rate // self.p.physics_rate)

    def _enroll_connected(self) -> None:
        """Whoever has the means to answer ticks is waited for from the first one on."""
        if self.p.sync == "lockstep":
            for robot in self.robots:
                for node in robot.answering():
                    self.lockstep.enroll(self._controller(robot.index, node))

    def _forget_disconnected(self) -> None:
        """A controller whose connections are gone is not waited for, and its robot is stopped."""
        for robot in self.robots:
            connected = robot.connected()
            for name in self.lockstep.missing():
                node, _, driven = name.partition(" driving ")
                if driven == (robot.name if len(self.robots) > 1 else "") and node not in connected:
                    rospy.logwarn("lockstep: %s is gone; the robot is stopped", name)
                    self.lockstep.gone(name)
                    self.held[robot.index] = Twist2D()

    def _wanted(self) -> Dict[str, List[int]]:
        """Sensor -> robots of which somebody listens to it; nothing else is computed."""
        self.listeners = [robot.wanted() for robot in self.robots]
        wanted: Dict[str, List[int]] = {}
        for index, sensors in enumerate(self.listeners):
            for sensor in sensors:
                wanted.setdefault(sensor, []).append(index)
        return wanted

    # -- publishing --

    def _publish(self, seen: Observations) -> None:
        """Send what one step brought, all with its stamp; the clock last, so that its data is there when it ticks."""
        stamp = convert.to_time(seen.stamp_ns)
        for robot, sensors in zip(self.robots, self.listeners):
            if sensors:
                robot.publish(seen, stamp, sensors)
        if seen.odometry is not None and self.tf.get_num_connections():
            transforms = [transform for index, robot in enumerate(self.robots)
                          for transform in robot.transforms(seen, self.sim.map_from_odom(index), stamp)]
            if transforms:
                self.tf.publish(transforms)
        if seen.control and self.sim.moving:
            self.shapes.publish(world_markers(self.sim.world, self.p.world_frame, self.sim.world_time, moving=True))
        if seen.clock:
            self.clock.publish(stamp)

    def send_static_transforms(self) -> None:
        """world -> map, and map -> odom of each robot unless ground truth keeps correcting it."""
        p, stamp = self.p, convert.to_time(self.sim.stamp_ns)
        transforms = [convert.to_transform(p.world_frame, p.map_frame, Pose2D(), stamp)]
        if p.localization == "static":
            transforms += [convert.to_transform(p.map_frame, robot.odom_frame, self.sim.map_from_odom(index), stamp)
                           for index, robot in enumerate(self.robots)]
        self.tf_static.publish(transforms)


def _serve_gazebo(node: SimNode) -> None:
    """Gazebo's services, whose types are there only where somebody has built them."""
    try:
        from .gazebo import GazeboServices
    except ImportError as error:
        advice = "link compat/gazebo_msgs into the workspace, and build"
        raise ParameterError(f"gazebo_services: {error}; {advice}") from error
    GazeboServices(node)


def main() -> None:
    """Run the node until it is shut down; exit status 1 when it can't start, with the reason logged."""
    # This node makes simulated time, so it must not wait for it: rospy runs on the wall clock here.
    with node("robocop_sim", disable_rostime=True):
        p = params.load(SimParams)
        with contextlib.closing(build_simulator(p)) as sim:
            SimNode(p, sim).run()
