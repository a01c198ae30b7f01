"""The simulations to measure, each with its parameters, topics and robot positions."""

import math
from dataclasses import dataclass
from typing import Any, Dict, List, Sequence, Tuple

from . import BenchError

PHYSICS_RATES = {"wheels": 240, "kinematic": 30}  # [Hz]
# With 50 robots Bullet alone is hardly faster than real time.
DEFAULT = ("wheels:1", "wheels:10", "kinematic:1", "kinematic:10", "kinematic:50")
# [Hz], beams, [Hz]: rates used in published measurements of other simulators
SCAN_RATE, SCAN_SAMPLES, ODOM_RATE = 5, 360, 30
RADIUS = 0.2  # [m] of the circle that each robot drives, to its left
VELOCITY = (0.1, 0.5)  # [m/s], [rad/s] on that circle
CONTROLLERS = ("rospy", "server")  # of lockstep cases: a plain rospy loop at 10 Hz, this package's action server
LOCKSTEP = tuple(f"{drive}:{controller}" for drive in PHYSICS_RATES for controller in CONTROLLERS)
OBSTACLES = [(x, y) for x in (-3, 0, 3) for y in (-3, 0, 3)]  # [m] in worlds/bench.sdf
CLEAR = 0.7  # [m] between the centre of a robot's circle and that of an obstacle


@dataclass(frozen=True)
class Case:
    """A value of the parameter `drive` with a number of robots, or with one robot in lockstep."""

    drive: str
    kind: str = "1"  # a number of robots, or one of CONTROLLERS

    @property
    def name(self) -> str:
        """The case as it is written on the command line."""
        return f"{self.drive}:{self.kind}"

    @property
    def lockstep(self) -> bool:
        """Whether it runs in lockstep with a controller; other cases have constant velocity commands."""
        return self.kind in CONTROLLERS

    @property
    def namespaces(self) -> List[str]:
        """The namespace of each robot's topics; a single robot has none, as in ordinary use."""
        return ["/"] if not self.kind.isdigit() or self.kind == "1" else [f"/r{i}/" for i in range(int(self.kind))]

    def topics(self) -> Dict[str, int]:
        """Topics of the client -> their rates [Hz]."""
        rates = {"odom": ODOM_RATE, "scan": SCAN_RATE}
        return {robot + topic: rate for robot in self.namespaces for topic, rate in rates.items()}

    def params(self, factor: float) -> Dict[str, Any]:
        """Parameters of robocop_sim for a real-time factor (0: as fast as possible)."""
        robots = [f"{name.strip('/')} {x} {y} 0" for name, (x, y) in zip(self.namespaces, positions())]
        x, y = positions()[0]
        physics_rate = PHYSICS_RATES[self.drive]
        return {
            "world": "bench",
            "drive": self.drive,
            "physics_rate": physics_rate,
            "real_time_factor": factor,
            "sync": "lockstep" if self.lockstep else "free",
            "robots": "; ".join(robots) if len(robots) > 1 else "",
            "spawn": f"{x} {y} 0",
            "cmd_vel_timeout": 0.0,
            "scan_rate": SCAN_RATE,
            "scan_samples": SCAN_SAMPLES,
            "odom_rate": ODOM_RATE,
            # Not subscribed, but they must fit the physics rate.
            "clock_rate": min(60, physics_rate),
            "imu_rate": min(200, physics_rate),
        }


def positions() -> List[Tuple[float, float]]:
    """Start positions [m]: a metre apart from the middle outwards, then half a metre apart, clear of all obstacles."""
    halves = [i / 2 for i in range(-8, 9)]
    places = [
        (x, y) for x in halves for y in halves if all(math.hypot(x - a, y + RADIUS - b) > CLEAR for a, b in OBSTACLES)
    ]
    return sorted(places, key=lambda p: (any(v % 1 for v in p), math.hypot(*p), -p[0], -p[1]))


def parse_cases(words: Sequence[str]) -> List[Case]:
    """Cases from words such as 'wheels:10' and 'kinematic' (all its default ones); BenchError for another word."""
    chosen: List[Case] = []
    for word in words:
        drive, separator, kind = word.partition(":")
        is_known = kind in CONTROLLERS or (kind.isdigit() and 1 <= int(kind) <= len(positions()))
        if drive not in PHYSICS_RATES or (separator and not is_known):
            raise BenchError(
                f"case {word!r}: expected DRIVE or DRIVE:ROBOTS with a drive of {', '.join(PHYSICS_RATES)} and 1 to "
                f"{len(positions())} robots, such as wheels:10, or DRIVE:{', DRIVE:'.join(CONTROLLERS)}"
            )
        names = [word] if separator else [name for name in DEFAULT if name.startswith(f"{drive}:")]
        chosen += [Case(*name.split(":")) for name in names]
    return list(dict.fromkeys(chosen))
