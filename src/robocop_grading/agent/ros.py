"""rospy's time: /clock, and sleeps until a time on it."""

import functools
import struct
import sys
from typing import Any, Callable, List, Tuple

from . import clock
from .scheduler import NEVER, Waiter, scheduler

MESSAGES, MESSAGES_TIME = 10, 0.01  # a thread's messages at one time, and how long more take [s]: 1 ms each
CLOCK_MESSAGE = struct.Struct("<III")  # length, secs, nsecs


class RosClock:
    """What /clock shows, and who waits for it."""

    def __init__(self, now_ns: int, publish: Callable[[bytes], object]) -> None:
        """`publish` sends a message on /clock, for nodes that subscribe to it themselves."""
        self.now_ns, self._publish = now_ns, publish
        self._sleepers: List[Tuple[int, Waiter]] = []  # until when
        self._tell()

    def _tell(self) -> None:
        self._publish(CLOCK_MESSAGE.pack(8, *divmod(self.now_ns, 10**9)))

    def set(self, now_ns: int) -> bool:
        """Let rospy's time go on, if it is simulated time; return whether a thread has woken up."""
        self.now_ns, turns = now_ns, scheduler.turns
        with scheduler.work():
            if not sys.modules["rospy.rostime"].is_wallclock():
                self.show()
            self._tell()
        return scheduler.turns != turns

    def show(self) -> None:
        """Set rospy's time, and wake threads that wait in rospy.sleep() until time begins."""
        import rospy

        rospy.rostime._rostime_current = rospy.Time(0, self.now_ns)
        condition = rospy.rostime.get_rostime_cond()
        if condition.acquire(False):
            condition.notify_all()
            condition.release()

    def sleep(self, length_ns: int) -> None:
        """Have the calling thread sleep until the first tick at or after the end of its sleep."""
        import rospy

        until_ns, waiter = self.now_ns + length_ns, scheduler.new_waiter()
        with scheduler.guard:
            sleeps = until_ns > self.now_ns and not rospy.is_shutdown()
            if sleeps:
                self._sleepers.append((until_ns, waiter))
                scheduler.park(waiter)
        if sleeps:
            scheduler.wait(waiter)

    def end_sleeps(self) -> None:
        """End the sleeps by /clock whose time has come, in the order of their times."""
        import rospy

        with scheduler.guard:
            until_ns = NEVER if rospy.is_shutdown() or rospy.rostime.is_wallclock() else self.now_ns
            due = [sleeper for sleeper in self._sleepers if sleeper[0] <= until_ns]
            self._sleepers = [sleeper for sleeper in self._sleepers if sleeper[0] > until_ns]
            for _, waiter in sorted(due, key=lambda sleeper: sleeper[0]):
                scheduler.end_wait_at(scheduler.now_ns, waiter)


def install(shown: RosClock) -> None:
    """Have rospy's time be what is shown."""
    import rospy
    from rospy.impl import simtime

    simtime.init_simtime = _init_simtime(simtime, shown)
    for module in (rospy, rospy.timer):
        module.sleep = _sleeping(rospy.timer.sleep, shown)
    for module in (rospy, rospy.rostime):
        module.get_rostime = _then(rospy.rostime.get_rostime, clock.note_read)
    rospy.Publisher.publish = _then(rospy.Publisher.publish, lambda: scheduler.spend(1.0 / MESSAGES, MESSAGES_TIME))


def _init_simtime(simtime: Any, shown: RosClock) -> Callable[[], bool]:
    """rospy's function, without a subscription to /clock: RosClock.set() replaces its messages, with less work."""
    subscribe = simtime.init_simtime

    def init_simtime() -> bool:
        if not scheduler.active or not simtime._is_use_simtime():
            return bool(subscribe())
        shown.show()
        simtime.rospy.rostime.set_rostime_initialized(True)
        return True

    return init_simtime


def _sleeping(sleep: Any, shown: RosClock) -> Any:
    """rospy's function, by the clock that is shown."""

    @functools.wraps(sleep)
    def call(duration: Any) -> None:
        import genpy
        import rospy

        length = duration if isinstance(duration, genpy.Duration) else genpy.Duration.from_sec(duration)
        if scheduler.active and not rospy.rostime.is_wallclock() and shown.now_ns and length.to_nsec() > 0:
            shown.sleep(length.to_nsec())
            duration = genpy.Duration()
        sleep(duration)  # raises what it has to

    return call


def _then(function: Any, afterwards: Callable[[], None]) -> Any:
    @functools.wraps(function)
    def call(*arguments: Any, **options: Any) -> Any:
        value = function(*arguments, **options)
        afterwards()
        return value

    return call
