"""The topics between the grader and a hand-in's node: messages sent, messages received, and connections.

Messages are as on TCPROS, each with its length. If the node could not serialize a message, the stream has rubbish
after it.

An action of the handout's type that the node has under another name, as its only one, has the handout's name here.
"""

import io
import json
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Callable, Dict, Iterator, List, Mapping, NamedTuple, Set, Tuple

import genpy

from aro_robocop_goto_as.names import ACTION_TYPE

from .. import record as rec
from ..agent import wire
from ..errors import GraderLostError
from ..handout import ACTION

SIMULATOR_NODE = "/robocop_sim"  # of the grader's node
MAX_WAITING, MAX_DECODED = 20_000, 16 * 1024**2  # messages, and their bytes, in one turn; further ones are dropped
MAX_LISTED = 100  # entries of a message's list
MAX_TOPICS, MAX_NAME = 1000, 200  # of a node, and characters of a name
MAX_STREAM = 16 * 1024**2  # of a topic's stream that are no whole message

Handler = Callable[[Any], object]


class NodeTopic(NamedTuple):
    """A topic of the node."""

    type: str
    checksum: str


@dataclass
class _Topic:
    kind: Any
    header: Dict[str, str]  # of its connections


@dataclass
class _Sent(_Topic):
    """One that the grader publishes."""

    is_latched: bool
    last: bytes = b""  # message, if it is latched
    count: int = 0  # of messages


@dataclass
class _Heard(_Topic):
    """One that the grader subscribes to."""

    handler: Handler
    of: Callable[[Any], Any]
    stream: bytearray = field(default_factory=bytearray)  # what has come of a message

    def bodies(self, data: bytes) -> Iterator[bytes]:
        """The messages that are complete now that this data has come."""
        self.stream += data
        start = 0
        while len(self.stream) - start >= wire.LENGTH.size:
            (size,) = wire.LENGTH.unpack_from(self.stream, start)
            body, end = start + wire.LENGTH.size, start + wire.LENGTH.size + size
            if end > len(self.stream):
                break
            start = end
            yield bytes(self.stream[body:end])
        del self.stream[:start]
        if len(self.stream) > MAX_STREAM:
            self.stream.clear()


def trimmed(message: Any) -> Any:
    """Truncate a message's strings and lists; returns the message."""
    for name in message.__slots__:
        value = getattr(message, name)
        if isinstance(value, str):
            setattr(message, name, value[: rec.MAX_TEXT])
        elif isinstance(value, (list, tuple)):
            setattr(message, name, [trimmed(it) if isinstance(it, genpy.Message) else it for it in value[:MAX_LISTED]])
        elif isinstance(value, genpy.Message):
            trimmed(value)
    return message


def header(kind: Any, **more: str) -> Dict[str, str]:
    """The header with which a connection begins."""
    text = {"message_definition": kind._full_text} if hasattr(kind, "_full_text") else {}
    return {"callerid": SIMULATOR_NODE, "type": kind._type, "md5sum": kind._md5sum, **text, **more}


def _renamed(topic: str, action: str, other: str) -> str:
    """A topic's name; that of an action's topic has another action's name in it."""
    return other + topic[len(action) :] if topic.startswith(f"{action}/") else topic


class Topics:
    """All topics. Messages that have arrived are handled in the order of their topics' names, not of sending."""

    def __init__(self) -> None:
        self.published: Dict[str, NodeTopic] = {}  # by the node
        self.subscribed: Dict[str, NodeTopic] = {}  # likewise
        self.programs: Set[str] = set()  # of ROS that the node has started, which find no master
        self.delays: Dict[str, float] = {}  # [s] by topic: the longest time until the node read a message
        self._action = ACTION  # the node's name for it
        self._sent: Dict[str, _Sent] = {}  # by name
        self._heard: Dict[str, _Heard] = {}  # likewise
        self._outgoing: List[wire.Message] = []
        self._new: List[Dict[str, str]] = []  # headers
        self._arrived: List[Tuple[str, Callable[[], object]]] = []  # topic, and what handles a message
        self._decoded = 0  # bytes of them

    # -- what the grader does with topics --

    def advertise(self, name: str, kind: Any, latch: bool = False) -> None:
        """Begin to publish a topic; with `latch` its last message is sent to each new subscriber."""
        self._sent[name] = _Sent(kind, header(kind, topic=name, latching=str(int(latch))), latch)
        self._new.append(self._sent[name].header)

    def subscribe(self, name: str, kind: Any, handler: Handler, of: Callable[[Any], Any] = trimmed) -> None:
        """Have `handler` called with each message on a topic; `of` reduces a message to the parts that are kept."""
        self._heard[name] = _Heard(kind, header(kind, topic=name), handler, of)
        self._new.append(self._heard[name].header)

    def listens_to(self, name: str) -> bool:
        """Return whether the grader wants what is published on a topic."""
        return name in self._heard

    def ignore(self, name: str) -> None:
        """Stop listening to a topic."""
        del self._heard[name]

    def publish(self, name: str, message: Any) -> None:
        """Send a message."""
        body = io.BytesIO()
        if getattr(message, "_has_header", False):
            self._sent[name].count += 1
            message.header.seq = self._sent[name].count
        message.serialize(body)
        self.send(name, wire.LENGTH.pack(body.tell()) + body.getvalue())

    def send(self, name: str, data: bytes) -> None:
        """Send a serialized message, with its length."""
        sent = self._sent[name]
        if sent.is_latched:
            sent.last = data
        if sent.is_latched or self.node_subscribes_to(name):
            self._outgoing.append((name, data))

    # -- who is connected --

    def node_subscribes_to(self, name: str) -> bool:
        """Return whether the node gets what the grader publishes on a topic."""
        sent, used = self._sent.get(name), self.subscribed.get(name)
        return sent is not None and used is not None and used.checksum in ("*", sent.kind._md5sum)

    def node_publishes(self, name: str) -> bool:
        """Return whether the grader gets what the node publishes on a topic that it listens to."""
        return name in self.published and self.published[name].checksum == self._heard[name].kind._md5sum

    def other_types(self) -> Tuple[Tuple[str, str, str], ...]:
        """The topics that the node uses with another type than the grader: name, its type, and the grader's."""
        ours: Dict[str, _Topic] = {**self._heard, **self._sent}
        return tuple(
            (name, used.type, ours[name].kind._type)
            for name, used in [*self.published.items(), *self.subscribed.items()]
            if name in ours and used.checksum not in ("*", ours[name].kind._md5sum)
        )

    def unpublished(self) -> List[str]:
        """Topics that the node subscribes to and nobody publishes."""
        return sorted(self.subscribed.keys() - self.published.keys() - self._sent.keys())

    # -- the wire's end --

    def begin(self) -> List[Dict[str, str]]:
        """Forget the previous node, because a new one is started; return the headers of all topics."""
        self.published, self.subscribed, self.programs, self._new = {}, {}, set(), []
        self.delays, self._action = {}, ACTION
        for heard in self._heard.values():
            heard.stream.clear()
        self._outgoing = [(name, sent.last) for name, sent in self._sent.items() if sent.last]
        return [*(sent.header for sent in self._sent.values()), *(heard.header for heard in self._heard.values())]

    def take(self) -> Tuple[List[Dict[str, str]], List[wire.Message]]:
        """The headers of new topics, and the messages, since the last time."""
        new, outgoing = self._new, self._outgoing
        self._new, self._outgoing = [], []
        new = [{**it, "topic": self.node_name(it["topic"])} for it in new]
        return new, [(self.node_name(name), data) for name, data in outgoing]

    def node_name(self, name: str) -> str:
        """The node's name for a topic."""
        return _renamed(name, ACTION, self._action)

    def _find_action(self) -> None:
        """Find the node's action; what the grader has of it is offered under the node's name for it."""
        topics = {**self.published, **self.subscribed}
        goals = [name for name, it in topics.items() if name.endswith("/goal") and it.type == f"{ACTION_TYPE}Goal"]
        action = goals[0][: -len("/goal")] if len(goals) == 1 else ACTION
        if action != self._action:
            self._action = action
            ours: Dict[str, _Topic] = {**self._heard, **self._sent}
            self._new += [topic.header for name, topic in ours.items() if name.startswith(f"{ACTION}/")]
        self.published, self.subscribed = (
            {_renamed(name, action, ACTION): topic for name, topic in those.items()}
            for those in (self.published, self.subscribed)
        )

    def update_node_topics(self, body: bytes) -> None:
        """Take the node's list of its topics; GraderLostError if the list can't be read."""
        try:
            told: Mapping[str, Any] = json.loads(body)
            self.published, self.subscribed = (
                {
                    str(name)[:MAX_NAME]: NodeTopic(str(kind)[:MAX_NAME], str(checksum)[:MAX_NAME])
                    for name, checksum, kind in told[direction][:MAX_TOPICS]
                }
                for direction in ("published", "subscribed")
            )
            self.programs.update(str(name)[:MAX_NAME] for name in told["programs"][:MAX_TOPICS])
            self.delays = {str(name)[:MAX_NAME]: float(str(delay)[:9]) for name, delay in told["delays"][:MAX_TOPICS]}
        except (KeyError, RecursionError, TypeError, ValueError) as error:
            raise GraderLostError("the node's topics can't be read") from error
        self._find_action()

    def receive(self, name: str, data: bytes) -> None:
        """Take a part of the stream of the node's messages on a topic."""
        name = _renamed(name, self._action, ACTION)
        heard = self._heard.get(name)
        if heard is None:
            return
        for body in heard.bodies(data):
            if len(self._arrived) >= MAX_WAITING or self._decoded >= MAX_DECODED:
                continue
            self._decoded += len(body)
            try:
                message = heard.of(heard.kind().deserialize(body))
            except Exception:  # genpy does not document its errors; as rospy, which connects anew
                heard.stream.clear()
                return
            self._arrived.append((name, partial(heard.handler, message)))

    def handle_arrived(self) -> None:
        """Handle what has arrived."""
        arrived, self._arrived, self._decoded = self._arrived, [], 0
        for _, handle in sorted(arrived, key=lambda topic_and_handle: topic_and_handle[0]):
            handle()
