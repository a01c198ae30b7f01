"""The simulations to measure, each with its parameters, topics and robot positions."""

import math
from dataclasses import dataclass
from typing import Any, Dict, List, Sequence

from ..errors import BenchError

PHYSICS_RATES = {"wheels": 240, "kinematic": 30}  # [Hz]
COUNTS = (1, 10, 50)  # robots
LEFT_OUT = {"wheels:50": "Bullet alone is hardly faster than real time; --cases wheels:50 measures it"}
# [Hz], beams, [Hz]: rates used in published measurements of other simulators
SCAN_RATE, SCAN_SAMPLES, ODOM_RATE = 5, 360, 30
LINEAR, ANGULAR = 0.1, 0.5  # [m/s], [rad/s] of every robot: circles of 0.2 m radius to its left
CONTROLLERS = ("rospy", "server")  # of lockstep cases: a plain rospy loop at 10 Hz, this package's action server
PITCH, EDGE = 3, 4  # [m] bench.sdf: obstacles at multiples of PITCH, robots at whole metres up to EDGE


@dataclass(frozen=True)
class Case:
    """A value of the parameter `drive` with a number of robots, or with one robot in lockstep with its controller."""

    drive: str
    robots: int
    controller: str = ""  # of CONTROLLERS; empty: constant velocity commands, no lockstep

    @property
    def name(self) -> str:
        """As on the command line."""
        return f"{self.drive}:{self.controller or self.robots}"

    @property
    def physics_rate(self) -> int:
        """Physics steps per second [Hz]."""
        return PHYSICS_RATES[self.drive]

    @property
    def namespaces(self) -> List[str]:
        """The namespace of each robot's topics; a single robot has none, as in ordinary use."""
        return ["/"] if self.robots == 1 else [f"/robot_{i}/" for i in range(1, self.robots + 1)]

    def topics(self) -> Dict[str, int]:
        """Topics of the client -> their rates [Hz]."""
        rates = {"odom": ODOM_RATE, "scan": SCAN_RATE}
        return {robot + topic: rate for robot in self.namespaces for topic, rate in rates.items()}

    def params(self, factor: float) -> Dict[str, Any]:
        """Parameters of robocop_sim for a real-time factor; 0: as fast as possible."""
        robots = "; ".join(f"{name.strip('/')} {x} {y} 0" for name, (x, y) in zip(self.namespaces, positions()))
        x, y = positions()[0]
        return {
            "world": "bench",
            "drive": self.drive,
            "physics_rate": self.physics_rate,
            "real_time_factor": factor,
            **({"sync": "lockstep"} if self.controller else {}),
            "robots": robots if self.robots > 1 else "",
            "spawn": f"{x} {y} 0",
            "cmd_vel_timeout": 0.0,
            "scan_rate": SCAN_RATE,
            "scan_samples": SCAN_SAMPLES,
            "odom_rate": ODOM_RATE,
            # Not subscribed, but they must fit the physics rate.
            "clock_rate": min(60, self.physics_rate),
            "imu_rate": min(200, self.physics_rate),
        }


def positions() -> List[Sequence[int]]:
    """Start positions [m] from the middle outwards, a metre from each other and from every obstacle's centre."""
    axis = range(-EDGE, EDGE + 1)
    free = [(x, y) for x in axis for y in axis if x % PITCH or y % PITCH]
    return sorted(free, key=lambda p: (math.hypot(*p), -p[0], -p[1]))


def default_cases() -> List[Case]:
    """Both drives with each number of robots, except LEFT_OUT."""
    every = [Case(drive, robots) for drive in PHYSICS_RATES for robots in COUNTS]
    return [case for case in every if case.name not in LEFT_OUT]


def lockstep_cases() -> List[Case]:
    """Both drives with each controller."""
    return [Case(drive, 1, controller) for drive in PHYSICS_RATES for controller in CONTROLLERS]


def parse_cases(words: Sequence[str]) -> List[Case]:
    """Cases from words such as 'wheels:10', 'kinematic' (all its numbers of robots), 'wheels:1,kinematic:rospy'.

    Without words the default cases. BenchError names a word that is not a case.
    """
    chosen: List[Case] = []
    for word in ",".join(words).split(","):
        if word.strip():
            chosen += _parse(word.strip())
    return list(dict.fromkeys(chosen)) or default_cases()


def _parse(word: str) -> List[Case]:
    drive, colon, robots = word.partition(":")
    if drive not in PHYSICS_RATES or (colon and not robots.isdigit() and robots not in CONTROLLERS):
        raise BenchError(
            f"case {word!r}: expected DRIVE or DRIVE:ROBOTS with a drive of "
            f"{', '.join(PHYSICS_RATES)}, such as wheels:10, or in lockstep DRIVE:{' or DRIVE:'.join(CONTROLLERS)}"
        )
    if robots in CONTROLLERS:
        return [Case(drive, 1, robots)]
    if not colon:
        return [case for case in default_cases() if case.drive == drive]
    if not 1 <= int(robots) <= len(positions()):
        raise BenchError(
            f"case {word!r}: expected 1 to {len(positions())} robots, as many as fit into worlds/bench.sdf"
        )
    return [Case(drive, int(robots))]
