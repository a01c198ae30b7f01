"""The simulations to measure, each with its parameters, topics and robot positions."""

import math
from dataclasses import dataclass
from typing import Any, Dict, List, Sequence, Tuple

from ..errors import BenchError

PHYSICS_RATES = {"wheels": 240, "kinematic": 30}  # [Hz]
DEFAULT_ROBOTS = {"wheels": (1, 10), "kinematic": (1, 10, 50)}  # with 50 Bullet alone is hardly faster than real time
# [Hz], beams, [Hz]: rates used in published measurements of other simulators
SCAN_RATE, SCAN_SAMPLES, ODOM_RATE = 5, 360, 30
LINEAR, ANGULAR = 0.1, 0.5  # [m/s], [rad/s] of every robot: circles of 0.2 m radius to its left
CONTROLLERS = ("rospy", "server")  # of lockstep cases: a plain rospy loop at 10 Hz, this package's action server
WORLDS = ("moving", "map")  # other worlds than worlds/bench.sdf, see worlds.py
OBSTACLES = [(x, y) for x in (-3, 0, 3) for y in (-3, 0, 3)]  # [m] in worlds/bench.sdf
CLEAR = 0.7  # [m] between the centre of a robot's circle and that of an obstacle


@dataclass(frozen=True)
class Case:
    """A value of the parameter `drive` with a number of robots, or with one robot in a special situation."""

    drive: str
    kind: str = "1"  # a number of robots; or of CONTROLLERS, in lockstep with it; or of WORLDS

    @property
    def name(self) -> str:
        """The case as it is written on the command line."""
        return f"{self.drive}:{self.kind}"

    @property
    def robots(self) -> int:
        """Number of robots."""
        return int(self.kind) if self.kind.isdigit() else 1

    @property
    def lockstep(self) -> bool:
        """Whether it runs in lockstep with a controller; other cases have constant velocity commands."""
        return self.kind in CONTROLLERS

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

    def params(self, factor: float, world: str = "bench") -> Dict[str, Any]:
        """Parameters of robocop_sim for a real-time factor (0: as fast as possible) in a world (name or path)."""
        robots = "; ".join(f"{name.strip('/')} {x} {y} 0" for name, (x, y) in zip(self.namespaces, positions()))
        x, y = positions()[0]
        return {
            "world": world,
            "moving": self.kind == "moving",
            "drive": self.drive,
            "physics_rate": self.physics_rate,
            "real_time_factor": factor,
            **({"sync": "lockstep"} if self.lockstep else {}),
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


def positions() -> List[Tuple[float, float]]:
    """Start positions [m]: a metre apart from the middle outwards, then half a metre apart, clear of all obstacles."""
    halves = [i / 2 for i in range(-8, 9)]
    radius = LINEAR / ANGULAR  # the centre of the circle is to the left

    def free(x: float, y: float) -> bool:
        return all(math.hypot(x - a, y + radius - b) > CLEAR for a, b in OBSTACLES)

    places = [(x, y) for x in halves for y in halves if free(x, y)]
    return sorted(places, key=lambda p: (any(v % 1 for v in p), math.hypot(*p), -p[0], -p[1]))


def default_cases() -> List[Case]:
    """Both drives with each number of robots."""
    return [Case(drive, str(robots)) for drive, numbers in DEFAULT_ROBOTS.items() for robots in numbers]


def lockstep_cases() -> List[Case]:
    """Both drives with each controller."""
    return [Case(drive, controller) for drive in PHYSICS_RATES for controller in CONTROLLERS]


def parse_cases(words: Sequence[str]) -> List[Case]:
    """Cases from words such as 'wheels:10', 'kinematic' (all its numbers of robots), 'wheels:1,kinematic:rospy'.

    Without words the default cases. BenchError names a word that is not a case.
    """
    kinds = [*(str(robots) for robots in range(1, len(positions()) + 1)), *CONTROLLERS, *WORLDS]
    known = {f"{drive}:{kind}": [Case(drive, kind)] for drive in PHYSICS_RATES for kind in kinds}
    known.update({drive: [case for case in default_cases() if case.drive == drive] for drive in PHYSICS_RATES})
    chosen: List[Case] = []
    for word in filter(None, map(str.strip, ",".join(words).split(","))):
        if word not in known:
            raise BenchError(
                f"case {word!r}: expected DRIVE or DRIVE:ROBOTS with a drive of {', '.join(PHYSICS_RATES)} and 1 to "
                f"{len(positions())} robots, such as wheels:10, or DRIVE:{', DRIVE:'.join((*CONTROLLERS, *WORLDS))}"
            )
        chosen += known[word]
    return list(dict.fromkeys(chosen)) or default_cases()
