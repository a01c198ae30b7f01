"""Teleoperation with a dead-man's switch: the robot moves only while somebody keeps asking for it."""

from dataclasses import dataclass
from typing import Optional

from ..geometry import STANDSTILL, Twist2D

RATE = 10.0  # [Hz] at which a page renews its request
TIMEOUT = 3.5 / RATE  # [s, wall] without a renewed request until the robot is stopped


@dataclass(frozen=True)
class _Hold:
    page: int
    robot: str
    twist: Twist2D
    until: float  # [s, wall]


@dataclass(frozen=True)
class Drive:
    """A velocity for a robot."""

    robot: str
    twist: Twist2D


class DeadMan:
    """Who drives which robot; the newest request wins. All times in seconds of one monotonic clock."""

    def __init__(self, timeout: float = TIMEOUT) -> None:
        self._timeout = timeout
        self._hold: Optional[_Hold] = None
        self._moving = ""
        self._is_moving = False

    def request(self, page: int, robot: str, twist: Twist2D, now: float) -> bool:
        """A page requests that the robot drive; returns whether nobody was driving it before."""
        begins = self._hold is None or self._hold.robot != robot or now >= self._hold.until
        self._hold = _Hold(page, robot, twist, now + self._timeout)
        return begins

    def release(self, page: int) -> None:
        """The page's button was released, or the page has gone."""
        if self._hold is not None and self._hold.page == page:
            self._hold = None

    def stop(self) -> None:
        """Stop, whichever page is driving."""
        self._hold = None

    @property
    def active(self) -> bool:
        """Return whether `command` has something to send, now or once the current request has run out."""
        return self._hold is not None or self._is_moving

    def command(self, now: float) -> Optional[Drive]:
        """What to send now: the velocity while it is asked for, once a zero when that ends, then None."""
        if self._hold is not None and now >= self._hold.until:
            self._hold = None
        hold = self._hold
        if self._is_moving and (hold is None or hold.robot != self._moving):
            self._is_moving = False
            return Drive(self._moving, STANDSTILL)
        if hold is None:
            return None
        self._moving, self._is_moving = hold.robot, True
        return Drive(hold.robot, hold.twist)
