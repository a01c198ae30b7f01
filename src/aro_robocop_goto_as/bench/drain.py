"""The client of a measurement: a process that reads its connections as fast as data arrives, and counts messages.

For each line on its standard input it prints a Tally as one line of JSON; it ends at the end of its input.
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

READ_SIZE = 1 << 18  # [bytes] per call


@dataclass(frozen=True)
class Tally:
    """The messages received so far."""

    time: float  # [s] of the monotonic clock, the same in all processes
    cpu: float  # [s] processor time of this process
    open: int  # connections
    counts: Dict[str, Count]  # topic -> messages
    first_at: Dict[str, float]  # topic -> time of its first message [s], same clock

    @staticmethod
    def from_json(text: str) -> "Tally":
        """From a line of JSON."""
        fields = json.loads(text)
        fields["counts"] = {topic: Count(**count) for topic, count in fields["counts"].items()}
        return Tally(**fields)

    @property
    def messages(self) -> int:
        """Number of messages of all topics."""
        return sum(count.messages for count in self.counts.values())

    @property
    def newest_ns(self) -> int:
        """The latest stamp [ns] of any topic; 0 if there is none."""
        return max((count.last_ns or 0 for count in self.counts.values()), default=0)


class Drain:
    """One connection and one counter for each topic."""

    def __init__(self) -> None:
        self._epoll = select.epoll()
        self._links: Dict[int, socket.socket] = {}
        self._topics: Dict[int, str] = {}
        self._counters: Dict[str, FrameCounter] = {}
        self._first_at: Dict[str, float] = {}
        self._server = socket.socket()

    def listen(self) -> int:
        """Accept connections on a loopback port, which is returned; their topics are called "0", "1", ... in order."""
        self._server.bind(("127.0.0.1", 0))
        self._server.listen(socket.SOMAXCONN)
        self._epoll.register(self._server, select.EPOLLIN)
        return int(self._server.getsockname()[1])

    def add(self, topic: str, link: socket.socket) -> None:
        """Read from this connection from now on; may be called from any thread."""
        link.setblocking(False)
        self._counters[topic] = FrameCounter()
        self._topics[link.fileno()] = topic
        self._links[link.fileno()] = link
        self._epoll.register(link, select.EPOLLIN)

    def run(self, requests: int) -> None:
        """Read connections until the file descriptor `requests` is at its end."""
        self._epoll.register(requests, select.EPOLLIN)
        while True:
            for ready, _ in self._epoll.poll():
                if ready in self._links:
                    self._read(ready)
                elif ready == self._server.fileno():
                    self.add(str(len(self._topics)), self._server.accept()[0])
                elif os.read(requests, 1):
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
        """The messages received so far."""
        counts = {topic: counter.count for topic, counter in list(self._counters.items())}
        return Tally(time.monotonic(), time.process_time(), len(self._links), counts, dict(self._first_at))


def main(argv: List[str]) -> None:
    """Entry point of the process; its first line of output means that it is ready."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--master", help="URI; subscribe to TOPICS there")
    parser.add_argument("--listen", action="store_true", help="accept plain connections instead; prints the port")
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
