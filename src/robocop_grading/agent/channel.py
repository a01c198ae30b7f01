"""The grader's requests to go on until a simulated time, and the answers when everything is done.

A request and an answer are each a line of numbers. After an answer's, there are a tab and ros.topics() as JSON if they
may have changed. Of each connection: PORT OF THIS PROCESS, PORT OF THE GRADER, BYTES SENT so far.

    UNTIL [ns] CLOCK [ns] CONNECTION...
    DONE [ns] NEXT [ns] BUSY [0 or 1] CONNECTION...
"""

import contextlib
import ctypes
import itertools
import json
import math
import os
import socket
from typing import Iterator, List, Set

from . import readers, ros, scheduler, stuck

STARTING = 20.0  # [s] of processor time for a node until it waits for the first time; ROS and NumPy take 2 to 4
PATIENCE = 0.5  # [s] likewise for what it does at one time ...
TIMES = 3  # ... as often in a row as a node without end gets it; then it is a loop without pauses, which gets
IMPATIENCE = 0.002  # [s] as long as it goes on, and
BRIEFLY = 0.2  # [s] once it has come to an end
TURN = 0.05  # [s] of processor time that other threads leave to one
MANY = 100  # times that threads are woken between two looks at the processor time
LOOK = 0.005  # [s, wall] between two looks at the processor time
MAX_LOOKS = 1000  # for what the process sends to itself
_recv_with_gil = ctypes.PyDLL(None).recv  # PyDLL does not release the interpreter's lock


class Channel:
    """Answers the grader, in a thread of its own that nothing else knows of."""

    def __init__(self, descriptor: int, ports: Set[int]) -> None:
        self._descriptor, self._ports = descriptor, ports
        self._allowance, self._patience = STARTING, PATIENCE
        self._exhausted = 0  # requests in a row at whose end the node still ran
        self._busy = False  # the node still ran at the end of the last request
        self._calls = 0  # to the grader, of which it knows the effects
        os.register_at_fork(after_in_child=self._leave)

    def serve(self) -> None:
        """Until the grader closes its end, which it does only after it has killed this process."""
        try:
            self._serve()
        finally:
            os.close(self._descriptor)  # the grader need not wait for an answer

    def _leave(self) -> None:
        """In a forked child, which may outlive this process: the grader learns of the latter's end."""
        with contextlib.suppress(OSError):
            os.close(self._descriptor)

    def _serve(self) -> None:
        for request in self._requests():
            until_ns, clock_ns, *sent = map(int, request.split())
            for port, of, count in zip(*[iter(sent)] * 3):
                readers.expect((port, of), count)
            self._busy = not self._go_on(until_ns, clock_ns)
            answer = [scheduler.now_ns, scheduler.next_deadline(), int(self._busy), *self._sent()]
            has_called = scheduler.calls != self._calls  # it may have told the master, or connected to a topic
            self._calls = scheduler.calls
            topics = "\t" + json.dumps(ros.topics(self._ports)) if has_called else ""
            scheduler.requests += 1  # what the grader sends from now on belongs to the next one
            self._write(f"{' '.join(map(str, answer))}{topics}\n".encode())
            if self._busy and not has_called:  # the grader connects to new topics, which needs its threads
                self._freeze()

    def _freeze(self) -> None:
        """Wait for the next request and let no thread run meanwhile: a loop without pauses would go on for nothing."""
        _recv_with_gil(self._descriptor, ctypes.create_string_buffer(1), 1, socket.MSG_PEEK)

    def _write(self, data: bytes) -> None:
        while data:
            data = data[os.write(self._descriptor, data) :]

    def _requests(self) -> Iterator[bytes]:
        data = b""
        while True:
            self._wait_for_request()
            more = os.read(self._descriptor, 65536)
            if not more:
                return
            *lines, data = (data + more).split(b"\n")
            yield from lines

    def _wait_for_request(self) -> None:
        """Let threads do what others ask of the node meanwhile: the master, or who wants to hear a topic."""
        turn = -1
        while not readers.wait_for(self._descriptor, LOOK if scheduler.running or scheduler.starting else None):
            readers.wake(topics=False)
            if not scheduler.wait_until_idle(LOOK) and turn == scheduler.turns:
                scheduler.wait_for_none_of(set(scheduler.running))  # of a node that is busy
            turn = scheduler.turns

    def _go_on(self, until_ns: int, clock_ns: int) -> bool:
        """Let simulated time go on to a tick of /clock or another time; False if the node has not come to an end."""
        rested, is_at_rest = True, False
        if clock_ns != ros.clock_ns:
            if not self._busy:  # its loops find the newest data when the clock wakes them up
                rested = self._live(until_ns - 1)
                if self._has_called():
                    return rested
            is_at_rest = not ros.set_clock(clock_ns) and rested and not self._busy
        while ros.sleeper_is_due() and not self._has_called():  # in the same order in every run
            if rested and not (is_at_rest or self._busy):
                rested = self._rest()
            ros.wake_sleeper()
            is_at_rest = False
        return self._live(until_ns, is_at_rest) and rested

    def _has_called(self) -> bool:
        """Return whether nodes are to be connected before time goes on, since this one has called the grader."""
        return scheduler.calls != self._calls and not self._busy

    def _live(self, until_ns: int, is_at_rest: bool = False) -> bool:
        """Let everything happen until then; False if the node has not come to an end."""
        rested = True
        while True:
            rested = (is_at_rest or self._rest()) and rested
            is_at_rest = False
            if self._has_called():
                return rested
            if scheduler.next_deadline() > until_ns:
                scheduler.advance(until_ns)
                return rested
            scheduler.wake_next()

    def _rest(self) -> bool:
        """Wait until all threads wait, and nothing is on its way to them; False if they need too much time for it."""
        look, started = 0.001, stuck.processor_time() if self._busy else math.inf
        turn, turn_started, expecting = -1, 0.0, 0
        for count in itertools.count(1):
            idle = scheduler.wait_until_idle(look)
            stuck.others.look()
            asleep = None if idle else stuck.all_asleep()
            is_over = idle or (asleep is not None and not scheduler.wait_for_none_of(asleep))
            if is_over or scheduler.is_unawaited():
                if readers.wake():
                    if count % MANY:
                        continue
                elif is_over and not stuck.others.work:
                    with scheduler.guard:
                        if not readers.more_is_expected():
                            self._allowance, self._exhausted = self._patience, 0
                            return True
                    expecting += 1
                    readers.counts_own &= expecting < MAX_LOOKS  # else a way to receive is not counted
                if idle:
                    readers.wait_for_more(look)
            look = min(2.0 * look, LOOK, self._allowance / 2.0)
            used = stuck.processor_time()  # not before: mostly there is nothing to wait for, and the kernel takes long
            started = min(started, used)
            if turn != scheduler.turns:
                turn, turn_started = scheduler.turns, used
            if used - turn_started > TURN and (readers.wake() or scheduler.queue):
                scheduler.wait_for_none_of(set(scheduler.running))
            if used - started > self._allowance:
                scheduler.wait_for_none_of(set(scheduler.running))
                self._exhausted += 1
                if self._exhausted >= TIMES:
                    self._allowance, self._patience = IMPATIENCE, BRIEFLY
                return False
        return False

    def _sent(self) -> List[int]:
        """The connections on which something has been sent since the last time."""
        found: List[int] = []
        closed, readers.closed[:] = list(readers.closed), []
        for traffic in [*readers.received.values(), *closed]:
            if traffic.link is not None and traffic.sent != traffic.reported:
                traffic.reported = traffic.sent
                found += [*traffic.link, traffic.sent]
        return found
