"""robocop teleop: drive a robot with the keyboard; it moves while a key is held, and stops when the key is released."""

import argparse
import contextlib
import os
import re
import select
import sys
import termios
import time
import tty
from typing import Iterator, List

import rosgraph
import rospy
from geometry_msgs.msg import Twist, Vector3

from ...errors import RobocopError, TeleopError
from ...geometry import STANDSTILL, Twist2D
from ...names import absolute, robocop
from ...process import signals
from ...process.start import typed
from .. import graph
from ..publishing.publisher import publisher
from ..waiting import wait_until

LINEAR, ANGULAR = 0.15, 1.0  # [m/s], [rad/s] below the limits of all models
PERIOD = 0.1  # [s, wall] between two commands, well below the simulator's command timeout
CONNECT_TIMEOUT = 5.0  # [s, wall]
RELEASE_TIMEOUT = 0.5  # [s] without a repetition of the key: terminals report presses, but no releases
MAX_READ = 4096  # [byte] so that a read never ends within a key's escape sequence
# Factors of the linear and angular speed.
KEYS = {
    "w": (1.0, 0.0),
    "x": (-1.0, 0.0),
    "a": (0.0, 1.0),
    "d": (0.0, -1.0),
    "q": (1.0, 1.0),
    "e": (1.0, -1.0),
}
ARROWS = {"A": "w", "B": "x", "C": "d", "D": "a"}  # after ESC [, or ESC O in the terminal's application mode
HELP = """\
  q  w  e       forward, and turning left or right
  a     d       turn left, turn right            (arrow keys work as well)
     x          backward
The robot stops half a second after the key is released. Ctrl-C quits.
"""


def command(key: str, linear: float, angular: float) -> Twist2D:
    """The velocity for a key, given the speeds [m/s], [rad/s]; zero for no key and for one without a meaning."""
    forward, left = KEYS.get(ARROWS.get(key[2:], key), (0.0, 0.0))
    return Twist2D(forward * linear, left * angular)


def keys_of(text: str) -> List[str]:
    """The keys in what a terminal has sent: single characters and escape sequences of three, such as an arrow's."""
    return re.findall(r"\x1b[\[O].|.", text, re.DOTALL)


@contextlib.contextmanager
def _raw_keys(terminal: int) -> Iterator[None]:
    """Keys arrive at once and are not shown; Ctrl-C remains a signal."""
    before = termios.tcgetattr(terminal)
    tty.setcbreak(terminal, termios.TCSANOW)
    try:
        yield
    finally:
        with contextlib.suppress(termios.error):  # the terminal is gone
            termios.tcsetattr(terminal, termios.TCSANOW, before)


class KeyboardTeleop:
    """Publishes a key's velocity while it repeats, then zero once, so that goals are not disturbed."""

    def __init__(self, topic: str, linear: float, angular: float) -> None:
        self._publisher = publisher(topic, Twist)
        self._speeds = linear, angular
        self._moving = False
        if not wait_until(lambda: self._publisher.get_num_connections() > 0, CONNECT_TIMEOUT):
            advice = "is the simulator running? With several robots, --robot NAME says which one"
            raise TeleopError(f"nobody subscribes to {self._publisher.resolved_name}: {advice}")

    def run(self, terminal: int) -> None:
        """Follow the keys until the terminal is closed or the node is shut down."""
        key, released = "", 0.0
        while not rospy.is_shutdown():
            ready, _, _ = select.select([terminal], [], [], PERIOD)
            if ready:
                read = b""
                with contextlib.suppress(OSError):  # the terminal is gone
                    read = os.read(terminal, MAX_READ)
                if not read:
                    return
                key, released = keys_of(read.decode(errors="replace"))[-1], time.monotonic() + RELEASE_TIMEOUT
            self.send(command(key if time.monotonic() < released else "", *self._speeds))

    def send(self, twist: Twist2D) -> None:
        """Publish a velocity, and zero only if the robot was commanded to move."""
        if twist == STANDSTILL and not self._moving:
            return
        self._moving = twist != STANDSTILL
        with contextlib.suppress(rospy.ROSException):  # shut down meanwhile
            self._publisher.publish(Twist(Vector3(twist.v, 0.0, 0.0), Vector3(0.0, 0.0, twist.w)))


def _parse(argv: List[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog=typed("teleop"),
        description="Drive a robot with the keyboard; it stops when the key is released.",
        epilog="Exit status 0 when it was ended, 1 when it could not start.",
    )
    parser.add_argument("--robot", default="", help="name of one of several robots")
    parser.add_argument(
        "--linear", type=_speed, default=LINEAR, help="forward and backward [m/s] (default %(default)s)"
    )
    parser.add_argument("--angular", type=_speed, default=ANGULAR, help="turning [rad/s] (default %(default)s)")
    return parser.parse_args(argv)


def _speed(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0.0 < value < 100.0:
        raise argparse.ArgumentTypeError(f"expected a number above 0 and below 100, got {text!r}")
    return value


def main() -> None:
    """Entry point; exit status 0 when it was ended by a key or signal, 1 when it could not start."""
    args = _parse(rospy.myargv()[1:])
    signals.interrupt_on_signal()
    terminal = sys.stdin.fileno()
    teleop = None
    try:
        if not os.isatty(terminal):
            raise TeleopError("the keyboard is read from the terminal, but standard input is not one")
        if not graph.master_answers():
            uri = rosgraph.get_master_uri()
            raise TeleopError(f"no ROS master answers at {uri}; start the system there, by {robocop()} run")
        # Wall time: a paused simulator must not keep keys from being read.
        rospy.init_node("robocop_teleop", anonymous=True, disable_signals=True, disable_rostime=True)
        teleop = KeyboardTeleop(absolute(args.robot, "cmd_vel"), args.linear, args.angular)
        with _raw_keys(terminal):
            print(HELP, flush=True)
            teleop.run(terminal)
    except KeyboardInterrupt:
        pass
    except RobocopError as error:
        sys.exit(f"robocop teleop: {error}")
    finally:
        signals.begin_cleanup()
        if teleop is not None:
            teleop.send(STANDSTILL)
        rospy.signal_shutdown("ended")
