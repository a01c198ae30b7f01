"""The hand-in's node as a child process: its output line by line, and simulated time with it by way of its agent."""

import contextlib
import json
import math
import os
import resource
import select
import socket
import time
from pathlib import Path
from subprocess import PIPE, STDOUT
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Sequence, Set, Tuple

import rospy

from aro_robocop_goto_as.errors import GraderLostError, NoTimeError
from aro_robocop_goto_as.process import child

from ..sandbox.guard import Guard
from ..sandbox.stillness import Stillness
from ..submission import CHANNEL
from . import ros_internals
from .output import Output

MAX_ANSWER = 1_000_000  # bytes
MAX_NAME = 200  # characters that are kept of a type's name
NEVER = 1 << 62  # [ns]
SHORTLY = 5e-5  # [s, wall] in which a message that was sent arrives
SOON = 5e-4  # [s, wall] between two looks at whether connections have been made
POLL = 0.005  # [s, wall] between two looks at other things while the node's answer is waited for
MAX_IDLE = 45.0  # [s, wall] in which the node does nothing, until its answer is not waited for any more, and
MAX_STALL = 20.0  # [s, wall] likewise for something it has told of
MAX_STALLS = 2  # times that the node did nothing while what it had told of did not come
MAX_ROUNDS = 5000  # answers to requests to go on until the same time
NO_TIME = 900.0  # [s, wall] for one answer


def _own_limit() -> float:
    """The limit of this process's processor time [s], which the sandbox has set, and which is also the node's."""
    soft, _ = resource.getrlimit(resource.RLIMIT_CPU)
    return math.inf if soft == resource.RLIM_INFINITY else float(soft)


class _Answer(NamedTuple):
    """What the agent says when the node has done all that it does until a time; see agent/channel.py."""

    done_ns: int  # since the node was started
    next_ns: int  # likewise
    is_busy: bool
    sent: List[Tuple[ros_internals.Link, int]]  # bytes
    topics: Dict[str, Any]


def _read(line: bytes) -> _Answer:
    """Read an answer; KeyError, OverflowError, RecursionError, TypeError or ValueError if it is none."""
    numbers, _, text = line.decode().partition("\t")
    done_ns, next_ns, is_busy, *sent = map(int, numbers.split())
    links = [((port, of), count) for port, of, count in zip(*[iter(sent)] * 3)]
    told = json.loads(text) if text else {}
    topics: Dict[str, Any] = told and {
        "node": str(told["node"]),
        "published": [(str(name), str(checksum), str(kind)) for name, checksum, kind in told["published"]],
        "subscribed": [
            (str(name), str(checksum), str(kind), list(map(int, ports)))
            for name, checksum, kind, ports in told["subscribed"]
        ],
    }
    return _Answer(done_ns, next_ns, bool(is_busy), links, topics)


class Node:
    """One node; each line of its output is passed to `on_line`.

    While it is waited for, its calls of services are answered. When it waits itself, what it has sent is handled.
    """

    def __init__(
        self,
        command: Sequence[str],
        environment: Mapping[str, str],
        folder: Path,
        on_line: Callable[[str], Any],
        answer_calls: Callable[[], Any],
        handle_arrived: Callable[[], Any],
        master_port: int,
        now_ns: int,
        clock_ns: int,
    ) -> None:
        mine, theirs = socket.socketpair()
        ports = [master_port, *ros_internals.ports()]
        channel = ",".join(map(str, [theirs.fileno(), clock_ns, *ports]))
        self._process = child.start(
            [channel if word == CHANNEL else word for word in command],
            environment=environment,
            folder=folder,
            stdout=PIPE,
            stderr=STDOUT,
            pass_fds=[theirs.fileno()],
        )
        theirs.close()
        self._channel, self._started_ns = mine, now_ns
        self._answer_calls, self._handle_arrived = answer_calls, handle_arrived
        self._buffer = b""
        self._sent: Dict[ros_internals.Link, int] = {}  # bytes, as the agent has been told
        self._topics: Dict[str, Any] = {"node": "", "published": [], "subscribed": []}  # as the agent has told last
        self._has_called = False  # the master or a topic of this process, and may not be connected yet
        self.next_ns = now_ns  # when the node will do something without having received a message
        self.is_busy = False  # it computes without an end, as a loop without pauses
        self.ended = ""  # why the node was ended here, if it was
        self._lost = False  # the agent has ended
        self._stalls = 0  # times that something the node had told of did not come
        self._lost_links: Set[ros_internals.Link] = set()  # on which it did not
        self.guard = Guard(self._process.pid, processor_time=_own_limit())
        assert self._process.stdout is not None
        self._output = Output(self._process.stdout, on_line)

    def status(self) -> Optional[int]:
        """The exit status of a node that ended by itself, once all that it sent has arrived; None while it runs."""
        if not self._lost and self._has_ended():
            self._lose()
        return self._process.poll()

    def end(self) -> None:
        """SIGKILL the node and its children. With SIGTERM, shutdown messages would be recorded as errors."""
        self.guard.stop()
        child.kill_tree(self._process.pid)
        self._process.wait()
        self._output.close()
        self._channel.close()

    # -- time --

    def go_on(self, until_ns: int, clock_ns: int, meanwhile: Callable[[], object] = lambda: None) -> None:
        """Let the node live until a simulated time [ns]; when this returns, all that it did until then has arrived.

        `clock_ns`: the time on /clock, which its loops see when they have handled all messages. `meanwhile` is called
        once, while the node works.
        """
        again, rounds = not self._lost, 0
        self._request(until_ns, clock_ns)
        meanwhile()
        while again:
            rounds += 1
            if rounds > MAX_ROUNDS:
                raise GraderLostError("the node's time did not go on")
            answer = self._answer()
            if answer is None:
                self._lose()
                return
            self.next_ns = min(NEVER, answer.next_ns + self._started_ns)
            self.is_busy = answer.is_busy
            if answer.topics:
                self._topics, self._has_called = answer.topics, True
            self._await(answer.sent)
            again = self._connect() or answer.done_ns + self._started_ns < until_ns
            if again:
                self._request(until_ns, clock_ns)

    def _request(self, until_ns: int, clock_ns: int) -> None:
        now = dict(ros_internals.sent())  # of two connections with the same ports, the newer one
        sent = [f"{port} {of} {count}" for (port, of), count in now.items() if self._sent.get((port, of)) != count]
        self._sent = now
        request = " ".join([f"{until_ns - self._started_ns} {clock_ns}", *sent])
        with contextlib.suppress(OSError):  # the answer will tell
            self._channel.sendall(f"{request}\n".encode())

    def _wait(self, done: Callable[[], bool], pause: float = POLL, max_idle: float = MAX_IDLE) -> bool:
        """Wait until `done` is true; False if the node has done nothing for `max_idle` [s, wall] meanwhile.

        NoTimeError if the machine has no time for it.
        """
        deadline, stillness = time.monotonic() + NO_TIME, Stillness(self._process.pid)
        while not done():
            self._answer_calls()
            if stillness.look() > max_idle:
                return False
            if time.monotonic() > deadline:
                raise NoTimeError(f"the node's turn was not over within {NO_TIME:g} s")
            time.sleep(pause)
        return True

    def _expect(self, done: Callable[[], bool], pause: float) -> bool:
        """Wait for what the node has told of; return whether it came. GraderLostError if it never comes."""
        came = self._wait(done, pause, MAX_STALL)
        self._stalls += not came
        if self._stalls > MAX_STALLS:
            raise GraderLostError("the node told the grader of messages or topics that did not come")
        return came

    def _answer(self) -> Optional[_Answer]:
        """The agent's answer; None if there is none. GraderLostError if it is nothing that an agent says."""
        if not self._wait(self._has_answer, pause=0.0):
            self._give_up()
        if b"\n" not in self._buffer:
            return None
        line, _, self._buffer = self._buffer.partition(b"\n")
        try:
            return _read(line)
        except (KeyError, OverflowError, RecursionError, TypeError, ValueError) as error:
            raise GraderLostError("the node's answer to the grader can't be read") from error

    def _has_answer(self) -> bool:
        """Wait a moment for the agent; whether there is a line from it, or never will be. Output is read meanwhile."""
        files = [self._channel, self._output] if self._output.is_open else [self._channel]
        ready, _, _ = select.select(files, [], [], POLL)
        if self._output in ready:
            self._output.read()
        if self._channel in ready:
            data = b""
            with contextlib.suppress(OSError):
                data = os.read(self._channel.fileno(), 65536)
            self._buffer += data
            if not data or len(self._buffer) > MAX_ANSWER:
                return True
        return b"\n" in self._buffer

    def _has_ended(self) -> bool:
        self._output.read()  # it may wait for that
        return self._process.poll() is not None

    def _lose(self) -> None:
        """The agent does not answer: because the process ends, or because the hand-in has ended or stopped it."""
        self._lost, self.next_ns = True, NEVER
        if not self._wait(self._has_ended):
            self._give_up()
        name = self._topics["node"]
        self._wait(lambda: not ros_internals.hears_from(name), SHORTLY)  # what it has sent before its end counts
        self._handle_arrived()
        self._output.pass_on()

    def _give_up(self) -> None:
        self.ended = "it stopped answering the grader, which has ended it"
        self.end()

    # -- messages and connections --

    def _await(self, sent: List[Tuple[ros_internals.Link, int]]) -> None:
        """Wait until what the node has sent has arrived, and has been made use of."""

        def missing() -> Set[ros_internals.Link]:
            links = {link for link, count in sent if -1 < ros_internals.handled(link) < count}
            return links - self._lost_links

        if not self._expect(lambda: not missing(), SHORTLY):
            self._lost_links |= missing()
        self._handle_arrived()
        self._output.pass_on()

    def join(self) -> None:
        """Wait until the node is connected to topics that this process has begun to publish or to subscribe to.

        It learns of them from the master, which nothing else waits for.
        """
        if not self.is_busy:  # else it does nothing until it is to go on
            self._expect(lambda: self._hears() and self._reaches() or self._has_ended(), SOON)
            self._handle_arrived()

    def _connect(self) -> bool:
        """Wait until all nodes know what this one has told the master; return whether it has to go on at once.

        It may have connected to itself, and then has threads that have something to do before time goes on.
        """
        has_called, self._has_called = self._has_called, False
        if has_called:
            self._expect(lambda: self._is_connected() or self._has_ended() or rospy.is_shutdown(), SOON)
            self._handle_arrived()
        return has_called and not self.is_busy and not self._has_ended()

    def _hears(self) -> bool:
        return all(ros_internals.hears(self._topics["node"], *topic[:2]) for topic in self._topics["published"])

    def _reaches(self) -> bool:
        return all(ros_internals.reaches(self._topics["node"], *topic[:2]) for topic in self._topics["subscribed"])

    def _is_connected(self) -> bool:
        return (
            ros_internals.all_updated()
            and self._hears()
            and all(
                ros_internals.is_connected(topic, checksum, set(ports) - {0})
                for topic, checksum, _type, ports in self._topics["subscribed"]
            )
        )

    def other_types(self) -> List[Tuple[str, str, str]]:
        """The topics that it shares with this process with another type: name, its type, and this process's."""
        topics = [topic[:3] for topic in (*self._topics["published"], *self._topics["subscribed"])]
        found = [(name, kind, ros_internals.other_type(name, checksum)) for name, checksum, kind in topics]
        return [(str(name), str(kind)[:MAX_NAME], other) for name, kind, other in found if other]
