"""Teleoperation with a dead-man's switch: the robot moves only while somebody keeps asking for it."""

from dataclasses import dataclass
from typing import Optional

from ..geometry import STANDSTILL, Twist2D

RATE = 10.0  # [Hz] at which a page renews its request
TIMEOUT = 3.5 / RATE  # [s, wall] without a renewed request until the robot is stopped


@dataclass(frozen=True)
class Drive:
    """A velocity for a robot."""

    robot: str
    twist: Twist2D


class DeadMan:
    """Who drives which robot; the newest request wins. All times in seconds of one monotonic clock."""

    def __init__(self) -> None:
        self._wanted: Optional[Drive] = None
        self._page, self._until = 0, 0.0  # which page wants it, and until when
        self._moving: Optional[str] = None  # the robot whose last command was not the stop

    def request(self, page: int, robot: str, twist: Twist2D, now: float) -> bool:
        """A page requests that the robot drive; returns whether nobody was driving it before."""
        begins = self._wanted is None or self._wanted.robot != robot or now >= self._until
        self._wanted, self._page, self._until = Drive(robot, twist), page, now + TIMEOUT
        return begins

    def release(self, page: int) -> None:
        """The page's button was released, or the page has gone."""
        if page == self._page:
            self._wanted = None

    def stop(self) -> None:
        """Stop, whichever page is driving."""
        self._wanted = None

    @property
    def active(self) -> bool:
        """Return whether `command` has something to send, now or once the current request has run out."""
        return self._wanted is not None or self._moving is not None

    def command(self, now: float) -> Optional[Drive]:
        """What to send now: the velocity while it is asked for, once a zero when that ends, then None."""
        if now >= self._until:
            self._wanted = None
        wanted, moving = self._wanted, self._moving
        self._moving = None if wanted is None else wanted.robot
        if moving is not None and moving != self._moving:
            self._moving = None
            return Drive(moving, STANDSTILL)
        return wanted
