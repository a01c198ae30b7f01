"""rospy's time, and its calls to the grader (its master, its topics, its services): answered without simulated time."""

import _thread
import contextlib
import functools
import heapq
import itertools
import math
import queue
import sys
import threading
import time
import xmlrpc.client
from typing import Any, Callable, Dict, List, Set, Tuple

from . import clock, scheduler

KEPT = {("/odom", "nav_msgs/Odometry"), ("/scan", "sensor_msgs/LaserScan")}
LOOK_NS = 10_000_000  # [ns] from one look of rospy.wait_for_message() to the next
SHUTDOWN_LOOK = 1.0  # [s] from one look at whether rospy has been shut down to the next
MESSAGES, MESSAGES_TIME = 10, 0.01  # a thread's messages at one time, and how long more take [s]: 1 ms each
_kept: Dict[Tuple[str, Any], "_Subscription"] = {}
clock_ns = 0  # [ns] as on /clock
_sleepers: List[Tuple[int, int, scheduler.Waiter]] = []  # by the time on /clock [ns] at which they wake up
_numbers = itertools.count()
_notifies = False  # a thread waits to notify the others of the clock


def _calls(cls: Any, name: str, is_call: Callable[..., bool]) -> None:
    method = getattr(cls, name)

    @functools.wraps(method)
    def call(*arguments: Any, **options: Any) -> Any:
        if not is_call(*arguments):
            return method(*arguments, **options)
        with scheduler.call():
            return method(*arguments, **options)

    setattr(cls, name, call)


def install(now_ns: int, ports: Set[int]) -> None:
    """`now_ns`: the time on /clock; `ports` are those of the grader's master and node."""
    global clock_ns
    clock_ns = now_ns

    def is_grader(_transport: Any, host: Any, *_: Any) -> bool:
        return isinstance(host, str) and host.rpartition(":")[2] in names

    names = set(map(str, ports))
    _calls(xmlrpc.client.Transport, "request", is_grader)
    import rospy
    from rospy.impl import simtime
    from rospy.impl.tcpros_base import TCPROSTransport
    from rospy.impl.tcpros_service import TCPROSServiceClient

    def answers(transport: Any) -> bool:
        return isinstance(transport.protocol, TCPROSServiceClient) and transport.dest_address[1] in ports

    _calls(TCPROSTransport, "connect", lambda _transport, _host, port, *_: port in ports)
    _calls(TCPROSTransport, "receive_once", answers)
    # A topic with a queue would have a thread for each subscriber, and drop messages if that is not scheduled in time.
    rospy.topics.QueuedConnection = lambda connection, _size: connection
    simtime.init_simtime = _init_simtime(simtime)
    rospy.Subscriber.__init__ = _clock_first(rospy.Subscriber.__init__)
    for module in (rospy, rospy.client):
        module.wait_for_message = wait_for_message
    for module in (rospy, rospy.timer):
        module.sleep = _sleeping(rospy.timer.sleep)
    for module in (rospy, rospy.rostime):
        module.get_rostime = _then(rospy.rostime.get_rostime, clock.looked)
    rospy.Publisher.publish = _then(rospy.Publisher.publish, lambda: scheduler.spend(1.0 / MESSAGES, MESSAGES_TIME))


def _init_simtime(simtime: Any) -> Callable[[], bool]:
    """rospy's function, without a subscription to /clock: set_clock() does what its messages do, for less work."""
    subscribe = simtime.init_simtime

    def init_simtime() -> bool:
        if not scheduler.active or not simtime._is_use_simtime():
            return bool(subscribe())
        _show_clock()
        simtime.rospy.rostime.set_rostime_initialized(True)
        return True

    return init_simtime


def _clock_first(subscribe: Any) -> Any:
    """Of a node that subscribes to /clock itself: rospy's time is set before its callback runs, as rospy does it."""

    @functools.wraps(subscribe)
    def call(self: Any, name: str, *arguments: Any, **options: Any) -> None:
        import rospy
        from rosgraph_msgs.msg import Clock

        clock = "/clock"
        if (
            scheduler.active
            and rospy.resolve_name(name) == clock
            and clock not in rospy.topics.get_topic_manager().subs
        ):
            subscribe(
                object.__new__(rospy.Subscriber), clock, Clock, lambda message: _hear_clock(message.clock.to_nsec())
            )
        subscribe(self, name, *arguments, **options)

    return call


def _sleeping(sleep: Any) -> Any:
    """rospy's function, but each thread wakes up at the end of its own sleep only, not at each tick of /clock."""

    @functools.wraps(sleep)
    def call(duration: Any) -> None:
        import genpy
        import rospy

        started_ns, seconds = clock_ns, duration
        if not isinstance(duration, genpy.Duration):
            duration = genpy.Duration.from_sec(duration)
        length_ns = duration.to_nsec()
        if not scheduler.active or rospy.rostime.is_wallclock() or not started_ns or length_ns <= 0:
            sleep(seconds)
            return
        waiter = scheduler.this_thread()
        with scheduler.guard:
            sleeps = started_ns + length_ns > clock_ns and not rospy.is_shutdown()
            if sleeps:
                heapq.heappush(_sleepers, (started_ns + length_ns, next(_numbers), waiter))
                scheduler.leave()
        if sleeps:
            scheduler.wait(waiter)
        sleep(genpy.Duration())  # raises what it has to

    return call


def sleeper_is_due() -> bool:
    """Whether a thread's sleep by /clock is over."""
    rospy = sys.modules.get("rospy")
    if not _sleepers or rospy is None:
        return False
    return bool(_sleepers[0][0] <= clock_ns or rospy.is_shutdown() or rospy.rostime.is_wallclock())


def wake_sleeper() -> None:
    """Wake the thread whose sleep is over first."""
    with scheduler.guard:
        waiter = heapq.heappop(_sleepers)[2]
        if not waiter.awake:  # by a signal
            scheduler.wake(waiter)


def set_clock(now_ns: int) -> bool:
    """Let rospy's time go on to `now_ns`, if it is simulated time; whether that has woken a thread."""
    global clock_ns
    clock_ns, turns, notifies = now_ns, scheduler.turns, False
    if not sys.modules["rospy.rostime"].is_wallclock():
        with scheduler.work():
            notifies = _show_clock()
    return notifies or scheduler.turns != turns


def _hear_clock(now_ns: int) -> None:
    if now_ns > clock_ns:  # to a busy node, a message may be late
        set_clock(now_ns)


def _show_clock() -> bool:
    """Set rospy's time and wake who waits for that; whether a thread does the latter."""
    import rospy

    global _notifies
    rospy.rostime._rostime_current = rospy.Time(0, clock_ns)
    condition = rospy.rostime.get_rostime_cond()
    if condition.acquire(False):
        condition.notify_all()
        condition.release()
    elif not _notifies:  # a thread holds it, perhaps while it waits for a time, which must go on
        _notifies = True
        _thread.start_new_thread(_notify, (condition,))  # does not wait for its begin, as Thread.start() does
    return _notifies


def _notify(condition: threading.Condition) -> None:
    global _notifies
    with condition:
        _notifies = False
        condition.notify_all()


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
        """The next message, at the time of rospy's look for it; None if rospy is shut down, or at the end [ns]."""
        import rospy

        started_ns, messages = scheduler.now_ns, queue.Queue()  # type: int, queue.Queue[Any]
        # With rospy's own subscription it would not be connected yet, and get none of those that are on their way now.
        self._waiting.append((-1 if self.subscriber is None else scheduler.requests, messages))
        if self.subscriber is None:
            self.subscriber = rospy.Subscriber(self._topic, self._type, self._receive)
        while not rospy.is_shutdown() and scheduler.now_ns < end_ns:
            with contextlib.suppress(queue.Empty):
                message = messages.get(timeout=min(SHUTDOWN_LOOK, (end_ns - scheduler.now_ns) / 1e9))
                time.sleep((LOOK_NS - (scheduler.now_ns - started_ns) % LOOK_NS) / 1e9)
                return message
        return None


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


def topics(ports: Set[int]) -> Dict[str, Any]:
    """What the node publishes, and what it subscribes to, by type, with the ports of its connections to the grader.

    Without rospy's locks, which a waiting thread may hold.
    """
    from rospy.names import get_caller_id
    from rospy.topics import get_topic_manager

    manager = get_topic_manager()
    published = [[name, topic.data_class._md5sum, topic.data_class._type] for name, topic in list(manager.pubs.items())]
    subscribed = [
        [
            name,
            topic.data_class._md5sum,
            topic.data_class._type,
            [_port(link) for link in topic.connections if (link.dest_address or (0, 0))[1] in ports],
        ]
        for name, topic in list(manager.subs.items())
    ]
    return {"node": get_caller_id(), "published": published, "subscribed": subscribed}


def _port(link: Any) -> int:
    try:
        return int(link.socket.getsockname()[1])
    except (AttributeError, OSError):  # it is being connected, or closed
        return 0
