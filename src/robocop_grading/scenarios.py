"""The scenarios of a server. Each starts with the robot at odom's origin and odometry at zero.

Poses are in [m] and [rad] in odom. A number is drawn from a range by the seed, which also draws the order, so no server
passes because it knows where the walls are; goals with and without an obstacle before them have the same ranges.
Scenarios avoid what the handout leaves open: no obstacle is close ahead while the robot has to turn; walls ahead are
wide and perpendicular to the path, and posts 6 to 12 degrees beside it at the stop distance, where the robot's body
would hit them: cones of 10 and of 30 degrees give the same distance.
"""

import math
import random
from dataclasses import dataclass, replace
from typing import Callable, Dict, Tuple, Union

from aro_robocop_goto_as.geometry import Pose2D, compose
from aro_robocop_goto_as.shapes import Box, Cylinder

HEIGHT = 0.5  # [m] of obstacles, well above the lidar
START = "start"  # the recording of the node's start; every server has one
BRIDGE_SCENARIOS = ("no_server", "click", "replace", "frame")  # of session/bridge_run.py
MIDDLE = 0  # the seed with which every range stands for its middle
MAX_SEED = 999_999
DIGITS = 3  # of a drawn number after the point: [mm], [mrad], [ms]


@dataclass(frozen=True)
class Step:
    """What is done: a goal, a cancel request, or moving the robot; then what is waited for."""

    goal: Tuple[float, ...] = ()  # x, y [m] in the frame `of`
    of: str = "odom"  # or robot: x ahead, y left
    ends: str = ""  # the terminal state to wait for, if the goal still runs
    run: float = 0.0  # [s] or the time to let pass instead
    cancel: bool = False
    place: Tuple[float, ...] = ()  # x, y [m], yaw [rad]


@dataclass(frozen=True)
class Push:
    """A push: once the robot is farther than `after` [m] from odom's origin, it is moved, whatever is commanded.

    Its wheels turn with it, so that odometry notices.
    """

    after: float
    v: float  # [m/s]
    w: float  # [rad/s]
    seconds: float


@dataclass(frozen=True)
class Block:
    """An obstacle that stands on the floor."""

    pose: Pose2D  # odom_from_block
    geometry: Union[Box, Cylinder]

    @property
    def outline(self) -> Tuple[float, ...]:
        """The block's outline from above, in odom: x, y, x, y, ... [m]."""
        if isinstance(self.geometry, Box):
            length, width = self.geometry.size[:2]
            corners = [(sx * length / 2, sy * width / 2) for sx, sy in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
        else:
            radius = self.geometry.radius
            corners = [(radius * math.cos(n * math.pi / 8), radius * math.sin(n * math.pi / 8)) for n in range(17)]
        return tuple(round(it, 4) for corner in corners for it in compose(self.pose, Pose2D(*corner))[:2])


def _wall(x: float, y: float, yaw: float, length: float, width: float) -> Block:
    return Block(Pose2D(x, y, yaw), Box((length, width, HEIGHT)))


def _post(x: float, y: float, radius: float) -> Block:
    return Block(Pose2D(x, y), Cylinder(radius, HEIGHT))


@dataclass(frozen=True)
class Scenario:
    """What happens, in this order, among these obstacles."""

    steps: Tuple[Step, ...]
    obstacles: Tuple[Block, ...] = ()
    odd_scan: bool = False  # with ranges of 0 and NaN
    pushes: Tuple[Push, ...] = ()
    name: str = ""
    about: str = ""


Draw = Callable[[float, float], float]  # a number from this range
Script = Callable[[Draw], Scenario]
SCRIPTS: Dict[str, Script] = {}


def scenario(script: Script) -> Script:
    """Have a function make the scenario of its name; its docstring says what the scenario is about."""
    SCRIPTS[script.__name__] = script
    return script


def drawn(seed: int) -> Tuple[Scenario, ...]:
    """All scenarios with the numbers of this seed, in its order; the seed 0 takes the middles and the order below."""
    found = []
    for name, script in SCRIPTS.items():
        numbers = random.Random(f"{seed}/{name}")

        def draw(low: float, high: float, numbers: random.Random = numbers) -> float:
            return round((low + high) / 2.0 if seed == MIDDLE else numbers.uniform(low, high), DIGITS)

        found.append(replace(script(draw), name=name, about=script.__doc__ or ""))
    if seed != MIDDLE:  # the node was started elsewhere only before the first scenario
        found[1:] = random.Random(seed).sample(found[1:], len(found[1:]))
    return tuple(found)


def _goal(x: float, y: float, ends: str = "SUCCEEDED", of: str = "odom") -> Step:
    return Step((x, y), of, ends)


def _second_goal(draw: Draw) -> Step:
    return _goal(draw(0.4, 0.6), draw(0.4, 0.6), of="robot")


@scenario
def left(draw: Draw) -> Scenario:
    """A goal ahead to the left, no obstacles"""
    return Scenario((_goal(draw(0.5, 0.9), draw(0.5, 0.9)),))


@scenario
def right(draw: Draw) -> Scenario:
    """A goal to the right"""
    return Scenario((_goal(draw(0.1, 0.3), draw(-0.9, -0.7)),))


@scenario
def behind(draw: Draw) -> Scenario:
    """A goal behind, then one for which the heading has to pass from pi to -pi, and one for the way back"""
    first = _goal(draw(-0.9, -0.7), draw(0.15, 0.25))
    second = _goal(draw(-1.2, -1.1), draw(-0.9, -0.8))
    return Scenario((first, second, _goal(draw(-1.5, -1.4), draw(0.1, 0.2))))


@scenario
def already_there(draw: Draw) -> Scenario:
    """A goal nearer than 0.1 m, behind the robot"""
    return Scenario((_goal(draw(-0.05, -0.02), draw(0.02, 0.04)),))


@scenario
def far(draw: Draw) -> Scenario:
    """A goal far away; on its way the robot is pushed aside twice, first far, then a little"""
    goal = _goal(draw(2.7, 3.3), draw(0.7, 1.3))
    pushes = Push(draw(0.6, 0.8), 0.2, draw(0.7, 0.9), 2.0), Push(draw(1.6, 1.8), 0.2, -0.35, 1.0)
    return Scenario((goal,), pushes=pushes)


@scenario
def obstacle(draw: Draw) -> Scenario:
    """A wall across the way to a goal ahead to the left; then the robot is placed in the open with a second goal"""
    wall = _wall(draw(0.9, 1.5), 0.3, 0.29, 0.1, 2.4)
    behind_it = _goal(draw(2.0, 2.4), draw(0.62, 0.7), "ABORTED")  # nearly along the wall's normal
    place = Step(place=(draw(-2.2, -1.8), draw(-0.2, 0.2), draw(-0.5, 0.5)))
    return Scenario((behind_it, place, _second_goal(draw)), (wall,))


@scenario
def near_wall(draw: Draw) -> Scenario:
    """From the start a wall ahead is nearer than 0.3 m; the goal is soon behind it"""
    wall = _wall(draw(0.277, 0.28), 0.0, 0.0, 0.1, 2.4)  # 0.26 m from the lidar
    return Scenario((_goal(draw(0.6, 0.9), 0.0, "ABORTED"),), (wall,))


@scenario
def beside(draw: Draw) -> Scenario:
    """Walls close on both sides, a pillar close behind"""
    around = _wall(0.6, 0.29, 0.0, 3.0, 0.1), _wall(0.6, -0.29, 0.0, 3.0, 0.1), _post(-0.28, 0.0, 0.06)
    return Scenario((_goal(draw(1.1, 1.3), 0.0),), around)


@scenario
def odd_scan(draw: Draw) -> Scenario:
    """In the open, with ranges of 0 and NaN among those of inf"""
    return Scenario((_goal(draw(0.6, 0.9), 0.0),), odd_scan=True)


@scenario
def odd_scan_wall(draw: Draw) -> Scenario:
    """A wall in front of the goal, with ranges of 0, NaN and inf among valid ones"""
    wall = _wall(draw(0.8, 1.2), 0.0, 0.0, 0.1, 2.4)
    return Scenario((_goal(draw(1.8, 2.2), 0.0, "ABORTED"),), (wall,), odd_scan=True)


@scenario
def cancel(draw: Draw) -> Scenario:
    """The goal is cancelled while the robot drives, and again after its end, then a second one is sent"""
    goal = Step((draw(1.8, 2.2), 0.0), run=draw(2.5, 3.5))
    return Scenario((goal, Step(cancel=True, ends="PREEMPTED"), Step(cancel=True), _second_goal(draw)))


@scenario
def cancel_turning(draw: Draw) -> Scenario:
    """The goal is cancelled while the robot turns"""
    goal = Step((draw(-2.2, -1.8), draw(0.1, 0.3)), run=draw(0.5, 0.7))
    return Scenario((goal, Step(cancel=True, ends="PREEMPTED")))


def _pillar(draw: Draw, low: float, high: float) -> Scenario:
    blocks = _post(draw(1.0, 1.4), draw(low, high), 0.015), _wall(draw(3.2, 3.6), 0.0, 0.0, 0.1, 4.0)
    return Scenario((_goal(draw(1.8, 2.2), 0.0, "ABORTED"),), blocks)


@scenario
def pillar_left(draw: Draw) -> Scenario:
    """A post in front of the goal, a little to the left; a wall behind the goal"""
    return _pillar(draw, 0.045, 0.05)


@scenario
def pillar_right(draw: Draw) -> Scenario:
    """A post in front of the goal, a little to the right; a wall behind the goal"""
    return _pillar(draw, -0.05, -0.045)


@scenario
def newer_goal(draw: Draw) -> Scenario:
    """A newer goal replaces the active one"""
    goal = Step((draw(1.8, 2.2), 0.0), run=draw(2.5, 3.5))
    return Scenario((goal, _goal(draw(0.5, 0.7), draw(-0.7, -0.5), of="robot")))
