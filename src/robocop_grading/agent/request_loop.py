"""Receives the grader's requests to live until a simulated time, and answers when everything until then is done."""

import _thread
import ctypes
import itertools
import json
import math
import os
import pickle
import socket
from typing import List, Tuple

from . import connections, files, ros, ros_graph, stuck, wire
from .scheduler import allocate_lock, scheduler

# Processor time [s] that a node may use before simulated time goes on without it
STARTING_TIME = 20.0  # until all its threads wait for the first time; ROS and NumPy take 2 to 4
REQUEST_TIME = 0.5  # per request of the grader after that
LOOP_TIME = 0.002  # per request, after MAX_OVERRUNS requests in a row used all of their time: a loop without pauses
AFTER_LOOP_TIME = 0.2  # per request, after such a loop has ended
MAX_TURN = 0.05  # of the thread whose turn it is, before it moves to the background
MAX_OVERRUNS = 3  # requests in a row
WAKE_UPS_PER_LOOK = 100  # wake-ups of threads between two looks at the processor time
MAX_POLL_PERIOD = 0.005  # [s, wall] between two looks at the processor time
_recv_with_gil = ctypes.PyDLL(None).recv  # PyDLL does not release the interpreter's lock


class CpuBudget:
    """The processor time [s] that a node may use at one request, until all of its threads wait."""

    def __init__(self) -> None:
        self.time, self._usual = STARTING_TIME, REQUEST_TIME  # [s]
        self._overruns = 0  # times in a row

    def reset(self) -> None:
        """All threads wait: the next request has the usual time."""
        self.time, self._overruns = self._usual, 0

    def overrun(self) -> None:
        """Some thread still runs, and the time is used up."""
        self._overruns += 1
        if self._overruns >= MAX_OVERRUNS:
            self.time, self._usual = LOOP_TIME, AFTER_LOOP_TIME


class RequestLoop:
    """Answers the grader's requests, in a thread of its own that the node does not see."""

    def __init__(self, descriptor: int, clock_ns: int) -> None:
        self._descriptor = descriptor
        self._writing, self._turn = allocate_lock(), allocate_lock()
        self._turn.acquire()  # free while the grader waits for an answer
        self._budget = CpuBudget()
        self._busy = False  # the node still ran at the end of the last request
        self._programs = 0  # of ROS that the grader has been told of
        _, body = self._read()
        parameters, offered = pickle.loads(body)
        self.grader = ros_graph.SimulatorProxy(self._publish, self._call, offered)
        for name, value in parameters.items():
            self.grader.master.setParam("/robocop_sim", name, value)
        self.clock = ros.RosClock(clock_ns, lambda data: self.grader.feed(ros_graph.CLOCK, data))

    # -- the wire --

    def _read(self) -> Tuple[int, bytes]:
        size, kind = wire.HEAD.unpack(self._receive(wire.HEAD.size))
        return kind, self._receive(size)

    def _receive(self, size: int) -> bytes:
        data = b""
        while len(data) < size:
            more = os.read(self._descriptor, size - len(data))
            if not more:
                raise EOFError("the grader has ended")
            data += more
        return data

    def _write(self, kind: int, body: bytes) -> None:
        data = memoryview(wire.frame(kind, body))
        with self._writing:
            while data:
                data = data[os.write(self._descriptor, data) :]

    def _publish(self, topic: str, data: bytes) -> None:
        self._write(wire.MESSAGE, wire.named(topic, data))

    def _call(self, service: str, request: bytes) -> bytes:
        """Call a service of the grader, and return its response; only one thread at a time reads from the wire."""
        if not scheduler.active:
            raise OSError("services of the grader can't be called from a forked process")
        scheduler.calling.add(_thread.get_ident())
        try:
            with self._turn:
                self._write(wire.CALL, wire.named(service, request))
                return self._read()[1]
        finally:
            scheduler.calling.discard(_thread.get_ident())

    # -- turns --

    def serve(self) -> None:
        """Answer requests until the grader closes its end; the grader does so only after it has killed this process."""
        while True:
            kind, body = self._read()
            if kind == wire.TOPIC:
                with scheduler.work():
                    self.grader.offer(pickle.loads(body))
                continue
            self._turn.release()
            until_ns, clock_ns = wire.TIMES.unpack_from(body)
            self._busy = not self._answer(until_ns, clock_ns, list(wire.messages_of(body)))
            self._turn.acquire()
            self.grader.end_probes()
            self._tell()
            self._write(wire.DONE, wire.TIMES.pack(scheduler.now_ns, scheduler.next_deadline()))
            if self._busy:
                self._freeze()

    def _tell(self) -> None:
        """Tell the grader the node's topics, programs of ROS that it has started, and delays, if they have changed."""
        self.grader.note_delays()
        if self.grader.has_news or len(stuck.children.programs) != self._programs:
            self.grader.has_news, self._programs = False, len(stuck.children.programs)
            told = connections.topics(self.grader)
            told.update(programs=sorted(stuck.children.programs), delays=sorted(self.grader.delays.items()))
            self._write(wire.TOPICS, json.dumps(told).encode())

    def _freeze(self) -> None:
        """Wait for the next request, and let no thread run meanwhile: a loop without pauses would only take time."""
        _recv_with_gil(self._descriptor, ctypes.create_string_buffer(1), 1, socket.MSG_PEEK)

    def _answer(self, until_ns: int, clock_ns: int, messages: List[wire.Message]) -> bool:
        """Advance to `until_ns`; if `clock_ns` has changed, /clock ticks first. Return False if a thread still runs."""
        all_wait, ticks = True, clock_ns != self.clock.now_ns
        if (messages or ticks) and not self._busy:
            all_wait = self._advance_to(until_ns - 1)
        if messages:
            with scheduler.work():
                for topic, data in messages:
                    self.grader.feed(topic, data)
            if ticks and not self._busy:  # its loops find the newest data when the clock wakes them up
                all_wait = self._run_until_all_wait() and all_wait
        all_wait_already = ticks and not self.clock.set(clock_ns) and all_wait and not self._busy
        self.clock.end_sleeps()
        return self._advance_to(until_ns, all_wait_already) and all_wait

    def _advance_to(self, until_ns: int, all_wait_already: bool = False) -> bool:
        """Let everything happen until that time; return False if some thread still runs."""
        all_wait = True
        while True:
            all_wait = (all_wait_already or self._run_until_all_wait()) and all_wait
            all_wait_already = False
            if scheduler.next_deadline() > until_ns:
                scheduler.advance(until_ns)
                return all_wait
            scheduler.wake_next()

    def _run_until_all_wait(self) -> bool:
        """Wait until all threads wait; return False if they use more processor time than is allowed."""
        poll_period, started = 0.001, stuck.processor_time() if self._busy else math.inf
        turn, turn_started = -1, 0.0
        for count in itertools.count(1):
            idle = scheduler.wait_until_idle(poll_period)
            stuck.children.poll()
            asleep = None if idle else stuck.all_asleep()
            nothing_runs = idle or (asleep is not None and not scheduler.move_to_background(asleep))
            if nothing_runs or scheduler.only_background_runs():
                if files.wake():
                    if count % WAKE_UPS_PER_LOOK:
                        continue
                elif nothing_runs and not stuck.children.busy:
                    self._budget.reset()
                    return True
                if idle:
                    files.wait_for_more(poll_period)
            poll_period = min(2.0 * poll_period, MAX_POLL_PERIOD, self._budget.time / 2.0)
            used = stuck.processor_time()  # not before: mostly there is nothing to wait for, and the kernel takes long
            started = min(started, used)
            if turn != scheduler.turns:
                turn, turn_started = scheduler.turns, used
            if used - turn_started > MAX_TURN and (files.wake() or scheduler.queue):
                scheduler.move_to_background(set(scheduler.running))
            if used - started > self._budget.time:
                scheduler.move_to_background(set(scheduler.running))
                self._budget.overrun()
                return False
        return False
