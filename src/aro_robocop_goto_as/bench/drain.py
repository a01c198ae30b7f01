"""The client of a measurement: a process that empties its connections as fast as data comes, and counts messages.

It is told what to do on its standard input: each line asks for one line on the standard output, a Tally as JSON; at the
end of input it ends.
"""

import argparse
import json
import os
import select
import socket
import sys
import time
from dataclasses import asdict, dataclass
from typing import Dict, List

from .frames import Count, FrameCounter
from .subscribe import Subscription

READ_SIZE = 1 << 18  # [bytes] at most at a time


@dataclass(frozen=True)
class Tally:
    """What has arrived until now."""

    time: float  # [s] of the monotonic clock, which all processes share
    cpu: float  # [s] that this process has used
    open: int  # connections
    counts: Dict[str, Count]  # topic -> messages
    first_at: Dict[str, float]  # topic -> when its first message was there, on the same clock

    @staticmethod
    def from_json(text: str) -> "Tally":
        """The tally of a line of JSON."""
        fields = json.loads(text)
        fields["counts"] = {topic: Count(**count) for topic, count in fields["counts"].items()}
        return Tally(**fields)

    @property
    def messages(self) -> int:
        """Of all topics."""
        return sum(count.messages for count in self.counts.values())

    @property
    def newest_ns(self) -> int:
        """The latest stamp [ns] of any topic; 0 before there is one."""
        return max((count.last_ns or 0 for count in self.counts.values()), default=0)


class Drain:
    """Connections by topic, one each, with a counter."""

    def __init__(self) -> None:
        self._epoll = select.epoll()
        self._links: Dict[int, socket.socket] = {}
        self._topics: Dict[int, str] = {}
        self._counters: Dict[str, FrameCounter] = {}
        self._first_at: Dict[str, float] = {}
        self._server = socket.socket()

    def listen(self) -> int:
        """Take whoever connects to this port of loopback; their topics are called "0", "1", ... as they come."""
        self._server.bind(("127.0.0.1", 0))
        self._server.listen(socket.SOMAXCONN)
        self._epoll.register(self._server, select.EPOLLIN)
        return int(self._server.getsockname()[1])

    def add(self, topic: str, link: socket.socket) -> None:
        """Read from this connection from now on; from any thread."""
        link.setblocking(False)
        self._counters[topic] = FrameCounter()
        self._topics[link.fileno()] = topic
        self._links[link.fileno()] = link
        self._epoll.register(link, select.EPOLLIN)

    def run(self, questions: int) -> None:
        """Read until the file descriptor with the questions is at its end."""
        self._epoll.register(questions, select.EPOLLIN)
        while True:
            for ready, _ in self._epoll.poll():
                if ready in self._links:
                    self._read(ready)
                elif ready == self._server.fileno():
                    self.add(str(len(self._topics)), self._server.accept()[0])
                elif os.read(questions, 1):
                    print(json.dumps(asdict(self.tally())), flush=True)
                else:
                    return

    def _read(self, ready: int) -> None:
        try:
            data = self._links[ready].recv(READ_SIZE)
        except BlockingIOError:
            return
        except ConnectionError:
            data = b""
        topic = self._topics[ready]
        if data:
            counter = self._counters[topic]
            counter.feed(data)
            if topic not in self._first_at and counter.messages:
                self._first_at[topic] = time.monotonic()
        else:
            self._epoll.unregister(ready)
            self._links.pop(ready).close()

    def tally(self) -> Tally:
        """The state of things."""
        counts = {topic: counter.count for topic, counter in list(self._counters.items())}
        return Tally(time.monotonic(), time.process_time(), len(self._links), counts, dict(self._first_at))


def main(argv: List[str]) -> None:
    """Entry point of the process; the first line that it writes means that it is ready."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--master", help="URI; subscribe to TOPICS there")
    parser.add_argument("--listen", action="store_true", help="take bare connections instead; says at which port")
    parser.add_argument("topics", nargs="*")
    args = parser.parse_args(argv)
    drain = Drain()
    if args.listen:
        print(drain.listen(), flush=True)
        drain.run(sys.stdin.fileno())
        return
    subscription = Subscription(args.master, args.topics, drain.add)
    print("ready", flush=True)
    drain.run(sys.stdin.fileno())
    subscription.close()


if __name__ == "__main__":
    main(sys.argv[1:])
