"""rospy's time: /clock, sleeps until a time on it, and waits for a message."""

import contextlib
import functools
import math
import queue
import struct
import sys
import time
from typing import Any, Callable, Dict, List, Tuple

from . import clock
from .scheduler import NEVER, Waiter, scheduler

KEPT = {("/odom", "nav_msgs/Odometry"), ("/scan", "sensor_msgs/LaserScan")}
LOOK_NS = 10_000_000  # [ns] from one look of rospy.wait_for_message() to the next
SHUTDOWN_LOOK = 1.0  # [s] from one look at whether rospy has been shut down to the next
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
    for module in (rospy, rospy.client):
        module.wait_for_message = wait_for_message
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


class _Subscription:
    """A subscription that calls of wait_for_message() share."""

    def __init__(self, topic: str, topic_type: Any) -> None:
        self._topic, self._type = topic, topic_type
        self._waiting: List[Tuple[int, queue.Queue[Any]]] = []  # for messages of a later turn than this
        self.subscriber: Any = None

    def _receive(self, message: Any) -> None:
        for waiting in list(self._waiting):
            if waiting[0] < scheduler.requests:
                self._waiting.remove(waiting)
                waiting[1].put(message)

    def next_message(self, end_ns: int) -> Any:
        """The next message, at the time of rospy's look for it; None if rospy is shut down, or at `end_ns` [ns]."""
        import rospy

        started_ns, messages = scheduler.now_ns, queue.Queue()  # type: int, queue.Queue[Any]
        # A subscription made only now would miss the messages that are already on their way.
        self._waiting.append((-1 if self.subscriber is None else scheduler.requests, messages))
        if self.subscriber is None:
            self.subscriber = rospy.Subscriber(self._topic, self._type, self._receive)
        while not rospy.is_shutdown() and scheduler.now_ns < end_ns:
            with contextlib.suppress(queue.Empty):
                message = messages.get(timeout=min(SHUTDOWN_LOOK, (end_ns - scheduler.now_ns) / 1e9))
                time.sleep((LOOK_NS - (scheduler.now_ns - started_ns) % LOOK_NS) / 1e9)
                return message
        return None


_kept: Dict[Tuple[str, Any], _Subscription] = {}


def wait_for_message(topic: str, topic_type: Any, timeout: Any = None) -> Any:
    """rospy's function, but it is woken up by the message, and stays subscribed to what the robot always sends.

    rospy registers with the master and connects for each message, and looks for it every LOOK_NS.
    """
    import rospy

    key = rospy.resolve_name(topic), topic_type
    subscription = _kept.get(key) or _Subscription(topic, topic_type)
    # Only of the lab's type: a subscription of another one would decide the type of the node's later ones.
    if (key[0], getattr(topic_type, "_type", None)) in KEPT:
        _kept[key] = subscription
    if isinstance(timeout, rospy.Duration):
        timeout = timeout.to_sec()
    if timeout is not None:  # rospy sleeps before it looks at the time
        timeout = max(1, math.ceil(timeout * 1e9 / LOOK_NS)) * LOOK_NS / 1e9
    try:
        message = subscription.next_message(scheduler.deadline(timeout))
    finally:
        if key not in _kept and subscription.subscriber is not None:
            subscription.subscriber.unregister()
    if rospy.is_shutdown():
        raise rospy.ROSInterruptException("rospy shutdown")
    if message is None:
        raise rospy.ROSException(f"timeout exceeded while waiting for message on topic {topic}")
    return message
