"""Words of the command line -> which simulations to measure, each with its parameters, topics and robots' places."""

import math
from dataclasses import dataclass
from typing import Any, Dict, List, Sequence

from ..errors import BenchError

PHYSICS_RATES = {"wheels": 240, "kinematic": 30}  # [Hz]
COUNTS = (1, 10, 50)  # robots
LEFT_OUT = {"wheels:50": "Bullet alone is hardly faster than real time with as many; --cases wheels:50 measures it"}
SCAN_RATE, SCAN_SAMPLES, ODOM_RATE = 5, 360, 30  # [Hz], beams, [Hz]: as the other simulators were measured
LINEAR, ANGULAR = 0.1, 0.5  # [m/s], [rad/s] of every robot, for ever: circles of 0.2 m radius, to the robot's left
PITCH, EDGE = 3, 4  # [m] bench.sdf: obstacles at multiples of the one, robots at whole metres up to the other


@dataclass(frozen=True)
class Case:
    """One drive with so many robots."""

    drive: str
    robots: int

    @property
    def name(self) -> str:
        """As on the command line."""
        return f"{self.drive}:{self.robots}"

    @property
    def physics_rate(self) -> int:
        """Steps a second [Hz]."""
        return PHYSICS_RATES[self.drive]

    @property
    def namespaces(self) -> List[str]:
        """Where each robot's topics are; a lone robot has them at the top, as users have it."""
        return ["/"] if self.robots == 1 else [f"/robot_{i}/" for i in range(1, self.robots + 1)]

    def topics(self) -> Dict[str, int]:
        """What the client subscribes to -> how often each comes [Hz]."""
        rates = {"odom": ODOM_RATE, "scan": SCAN_RATE}
        return {robot + topic: rate for robot in self.namespaces for topic, rate in rates.items()}

    def params(self, factor: float) -> Dict[str, Any]:
        """Parameters of robocop_sim, for a real-time factor; 0 = as fast as possible."""
        named = "; ".join(f"{name.strip('/')} {x} {y} 0" for name, (x, y) in zip(self.namespaces, places()))
        x, y = places()[0]
        return {
            "world": "bench", "drive": self.drive, "physics_rate": self.physics_rate, "real_time_factor": factor,
            "robots": named if self.robots > 1 else "", "spawn": f"{x} {y} 0", "cmd_vel_timeout": 0.0,
            "scan_rate": SCAN_RATE, "scan_samples": SCAN_SAMPLES, "odom_rate": ODOM_RATE,
            # Nobody listens to these; they only have to fit the physics rate.
            "clock_rate": min(60, self.physics_rate), "imu_rate": min(200, self.physics_rate)}


def places() -> List[Sequence[int]]:
    """Where robots start [m], from the middle outwards: a metre from each other and from every obstacle's centre."""
    axis = range(-EDGE, EDGE + 1)
    free = [(x, y) for x in axis for y in axis if x % PITCH or y % PITCH]
    return sorted(free, key=lambda place: (math.hypot(*place), -place[0], -place[1]))


def default_cases() -> List[Case]:
    """Both drives with each number of robots, but for what is left out."""
    every = [Case(drive, robots) for drive in PHYSICS_RATES for robots in COUNTS]
    return [case for case in every if case.name not in LEFT_OUT]


def parse_cases(words: Sequence[str]) -> List[Case]:
    """Cases from words such as 'wheels:10', 'kinematic' (all its numbers of robots), 'wheels:1,kinematic:1'.

    BenchError says what is wrong with a word; without words it is the default cases.
    """
    found: List[Case] = []
    for word in ",".join(words).split(","):
        if word.strip():
            found += _parse(word.strip())
    return list(dict.fromkeys(found)) or default_cases()


def _parse(word: str) -> List[Case]:
    drive, colon, robots = word.partition(":")
    if drive not in PHYSICS_RATES or (colon and not robots.isdigit()):
        raise BenchError(f"case {word!r}: expected DRIVE or DRIVE:ROBOTS with a drive of "
                         f"{', '.join(PHYSICS_RATES)}, such as wheels:10")
    if not colon:
        return [case for case in default_cases() if case.drive == drive]
    if not 1 <= int(robots) <= len(places()):
        raise BenchError(f"case {word!r}: expected 1 to {len(places())} robots, so many have room in worlds/bench.sdf")
    return [Case(drive, int(robots))]
