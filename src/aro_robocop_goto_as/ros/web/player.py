"""Plays a bag on its topics: at any speed, with pauses, from any moment on."""

import math
import threading
import time
from typing import Any, Callable, Collection, Dict, Iterator, List, NamedTuple, Optional, Tuple

import rosbag
import rospy
from visualization_msgs.msg import Marker, MarkerArray

from ...errors import WebError

LEAD = 1.0  # [s, recorded] before the moment that is sought, for topics with more messages than one in this time
FEW = 10  # messages of a topic that always count as rare: of rare topics all is sent again from the beginning
MARKERS = "visualization_msgs/MarkerArray"  # likewise, however many: each one only changes some of the markers
QUEUE = 1000  # messages that wait for a slow subscriber
CONNECT = 0.5  # [s, wall] for subscribers that wait already, as `rosbag play` gives them
CLEAR = MarkerArray([Marker(action=Marker.DELETEALL)])
Sample = Tuple[float, float, float]  # time [s] and two figures
Figures = Callable[[Any], Tuple[float, float]]  # those of a message


class _Clock(NamedTuple):
    """The moment `at` [s, recorded] was shown at `since` [s, wall]."""

    at: float
    since: float
    playing: bool
    speed: float

    def position(self) -> float:
        return self.at + (time.monotonic() - self.since) * self.speed if self.playing else self.at


class Player:
    """Publishes from a thread of its own, once it is to begin; late subscribers get the present state."""

    def __init__(self, path: str, speed: float) -> None:
        """WebError if the file is no bag, or has no messages."""
        try:
            self.path, self._bag = path, rosbag.Bag(path)
            self.beginning, end = self._bag.get_start_time(), self._bag.get_end_time()  # [s] in the recorded clock
        except (OSError, rosbag.ROSBagException) as error:
            raise WebError(f"{path} can't be played: {error}") from error
        topics = self._bag.get_type_and_topic_info().topics
        self.duration = end - self.beginning
        self.on_seek: Callable[[], None] = lambda: None  # called before another moment is published
        few = max(FEW, self.duration / LEAD)
        self._marked = [name for name, topic in topics.items() if topic.msg_type == MARKERS]
        self._kept = {*self._marked, *(name for name, topic in topics.items() if topic.message_count <= few)}
        self._topics = list(topics)
        self._publishers: Dict[str, rospy.Publisher] = {}
        self._changed = threading.Condition()
        self._begun = threading.Event()
        self._clock = _Clock(0.0, time.monotonic(), False, speed)
        self._sought: Optional[float] = None
        self._newcomers: List[Tuple[str, Callable[[Any], None]]] = []

    def samples(self, topic: str, figures: Figures) -> List[Sample]:
        """Two figures of all messages of a topic, with their times [s] after the beginning; from any thread."""
        with rosbag.Bag(self.path) as bag:
            found = bag.read_messages([topic])
            return [(stamp.to_sec() - self.beginning, *figures(message)) for _, message, stamp in found]

    # -- controls, from any thread --

    def begin(self) -> None:
        """Play, unless that has begun already."""
        self._begun.set()

    def play(self, playing: bool) -> None:
        """Continue, from the beginning if the end was reached, or pause."""
        if playing and self._clock.position() >= self.duration:
            self.seek(0.0)
        with self._changed:
            self._set(playing=playing)

    def set_speed(self, speed: float) -> None:
        """How many times as fast as recorded."""
        with self._changed:
            self._set(speed=speed)

    def seek(self, position: float) -> None:
        """Continue from a moment [s] after the beginning."""
        self.on_seek()
        with self._changed:
            self._sought = min(max(position, 0.0), self.duration)
            self._set(at=self._sought)

    def _set(self, **values: Any) -> None:
        now: Dict[str, Any] = {"at": self.position, "since": time.monotonic()}
        self._clock = self._clock._replace(**{**now, **values})
        self._changed.notify()

    @property
    def position(self) -> float:
        """The moment that is shown [s] after the beginning."""
        return min(self._clock.position(), self.duration)

    @property
    def speed(self) -> float:
        """How many times as fast as recorded; 0 while it is paused, and at its end."""
        return self._clock.speed if self._clock.playing and self.position < self.duration else 0.0

    # -- the thread --

    def start(self) -> None:
        """Publish the topics, and play. The node has to be initialized."""
        for name in self._topics:
            _, message, _ = next(self._bag.read_messages(topics=[name]))
            listener = rospy.SubscribeListener()
            listener.peer_subscribe = self._greet
            self._publishers[name] = rospy.Publisher(name, type(message), listener, queue_size=QUEUE)
        threading.Thread(target=self._work, daemon=True, name="player").start()

    def _greet(self, topic: str, _to_all: Any, publish: Callable[[Any], None]) -> None:
        """A subscriber has connected, to which alone this publishes."""
        with self._changed:
            self._newcomers.append((topic, publish))
            self._changed.notify()

    def _work(self) -> None:
        self._begun.wait()
        time.sleep(CONNECT)
        self.play(True)
        position = 0.0
        while not rospy.is_shutdown():
            for topic, message, stamp in self._bag.read_messages(start_time=self._stamp(position)):
                if not self._wait_until(stamp.to_sec() - self.beginning):
                    break
                self._publishers[topic].publish(message)
            else:
                self._wait_until(math.inf)
            with self._changed:
                position, self._sought = self._sought or 0.0, None
            for topic in self._marked:
                self._publishers[topic].publish(CLEAR)
            for topic, message in self._past(self._topics, position):
                self._publishers[topic].publish(message)

    def _wait_until(self, position: float) -> bool:
        """Whether a moment has come; False if another one was sought. Meanwhile newcomers get what they missed."""
        while True:
            with self._changed:
                if self._sought is not None:
                    return False
                newcomers, self._newcomers = self._newcomers, []
                if not newcomers:
                    ahead = position - self._clock.position()
                    if ahead <= 0.0:
                        return True
                    self._changed.wait(min(ahead / self._clock.speed, 1.0) if self._clock.playing else None)
            for topic, publish in newcomers:
                for _, message in self._past([topic], self.position):
                    publish(message)

    def _stamp(self, position: float) -> rospy.Time:
        return rospy.Time.from_sec(self.beginning + position)

    def _past(self, topics: Collection[str], position: float) -> Iterator[Tuple[str, Any]]:
        """Topics and messages that lead to the state at a moment: the rare ones all, of the others the last second."""
        for kept in (True, False):
            names = [name for name in topics if (name in self._kept) == kept]
            begin = 0.0 if kept else max(position - LEAD, 0.0)
            if names:
                found = self._bag.read_messages(names, self._stamp(begin), self._stamp(position))
                yield from ((topic, message) for topic, message, _ in found)
