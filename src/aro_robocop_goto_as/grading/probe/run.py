"""Advances time tick by tick, each time until the submission has answered, and records what it does."""

import time
from typing import Callable, Optional, Sequence, Set

from ...errors import GraderLostError
from ...ros.private_api import shutdown_has_begun
from ...simulation.lockstep import SURE, Lockstep
from .. import memory_group
from .. import record as rec
from ..resource_guard import exceeded_memory
from .node_rest import REST_TIMEOUT, NodeRest
from .nodes import Node
from .one_shot_subscriptions import OneShotSubscriptions
from .recording import Recording
from .stage import Stage

# [s, wall] how long a tick waits for an answer:
FIRST_TIMEOUT = 2.0  # until the node has been silent once for a goal
LATER_TIMEOUT = 0.2  # afterwards, for an answer that is due
UNSURE_TIMEOUT = 0.06  # afterwards, for one that may not be due: a slow loop whose period is not yet known
MUTE_TIMEOUT = 0.5  # instead of the first, for a node that was silent in a whole scenario; later ticks don't wait
OTHER_STREAM_TIMEOUT = 0.15  # for the other stream's answer once one has come
IN_VAIN = 5  # such waits, after which a node that rests with one stream's answer is not waited for again
SAME_ITERATION = 0.004  # [s, wall] for a command that often comes with a feedback message, but need not
START_REST = 0.5  # [s, wall] how long time is held while the node starts
MOST_BUSY = 20.0  # [s, wall] likewise in total, besides the time-out for its start
ONE_SHOT_TIMEOUT = 2.0  # [s, wall] for a node to unsubscribe after its message, if it wanted only one
LASTING_TIMEOUT = 0.3  # likewise, once one of the node's subscriptions has lasted
SETTLE = 0.15  # [s, wall] for what a node does at once, while time is held, if it may sleep on the wall clock
PUNCTUAL = 0.005  # [s, wall] to an answer, or to the first look at whether the node works on it
PACE = 0.008  # [s, wall] minimum duration of a tick that needs no answer
STREAMS = ("command", "feedback")
NODE_LOST = "the grader's ROS node was shut down while the submission ran"


class Run(Recording):
    """The recording of the current scenario, and the ticks that both parts share."""

    def __init__(self, stage: Stage, part: str, grader_pids: Sequence[int] = ()) -> None:
        """`grader_pids` are the processes, besides the node's, that have to rest before time may pass."""
        super().__init__(stage, part)
        self.node: Optional[Node] = None
        self.one_shot = OneShotSubscriptions(stage.sensor_topics)
        self._rest = NodeRest(stage, lambda: self.node, grader_pids, self.one_shot.waiting)
        stage.before_tick, stage.after_publishing = self._digest, self._serve_one_shot
        self.punctual = True  # it has not yet rested before an answer, as a node does that sleeps on the wall clock
        self.waits_in_vain = 0  # for a second stream, while the node was punctual
        self.sends_both = False  # it has sent both streams in one tick, before it rested
        self.lockstep = Lockstep()
        self.awaiting = ""  # id of the active goal
        self.followed = False  # whether a goal was followed before
        self.heard: Set[str] = set()  # streams, since the last tick
        self.death_recorded = False
        self.accepts_late = False  # this node accepts a goal when time advances, as one driven by a timer does
        self.fell_silent = False  # since the goal was sent; or it is known to answer less often than every tick
        self.mute = False  # it got goals in an earlier scenario, and nothing has come from it since

    def heard_from(self, stream: str) -> None:
        """A command or a feedback message has arrived."""
        self.mute = False
        self.heard.add(stream)
        if self.awaiting:
            self.lockstep.commanded(stream)

    @property
    def _heard_both(self) -> bool:
        """Whether both streams have been heard since the last tick."""
        return self.heard.issuperset(STREAMS)

    def drain(self, until: Callable[[], bool], timeout: float) -> bool:
        """Process messages until a condition holds, for at most `timeout` [s, wall]; whether it holds."""
        return self.stage.loop.run_jobs_until(until, timeout)

    # -- time --

    def tick(self, pace: float = PACE, real_time: bool = True, patience: float = REST_TIMEOUT) -> None:
        """One control tick. While a goal is active it lasts until the node answers, otherwise `pace` [s, wall] or more.

        In both cases until it is at rest, for at most `patience` [s, wall]. `real_time`: a watched run is shown at
        real time.
        """
        if shutdown_has_begun():
            raise GraderLostError(NODE_LOST)
        self.heard.clear()
        started = self.stage.wall()
        self.lockstep.tick = self.stage.tick_number + 1
        sample = self.stage.tick(real_time)
        self.add("samples", sample)
        if self.stage.watch is not None:
            self.stage.watch.show(sample, self.parts["goals"], self.parts["clicks"])
        if self.awaiting and not (self.mute and self.fell_silent):
            self._await_answers()
        else:
            self.drain(lambda: False, max(1e-3, pace - (self.stage.wall() - started)))
            self.rest(patience)
        self._record_death()

    def _await_answers(self) -> None:
        """Wait until every awaited stream was heard, or the goal has ended.

        The wait is short for a node that may not be due at this tick, as it is slower than the ticks.
        """

        def done() -> bool:
            answered = self.awaiting in self.ended or not self.lockstep.missing()
            return answered or self._dead() or self.one_shot.waiting()

        timeout = MUTE_TIMEOUT if self.mute else FIRST_TIMEOUT
        if self.fell_silent:
            timeout = LATER_TIMEOUT if self.lockstep.patience() >= SURE else UNSURE_TIMEOUT
        deadline = time.monotonic() + timeout
        if self.punctual and not self.drain(done, PUNCTUAL):
            self.punctual = bool(self.heard) or not self._rest.is_idle()
        self.sends_both = self.sends_both or self._heard_both
        while not self.heard and not self.drain(lambda: done() or bool(self.heard), 0.05):
            if time.monotonic() >= deadline:
                self.fell_silent = True
                break
        if self.heard and not done():
            self._await_other_stream(done)
        if not done():
            self.lockstep.give_up()
        if not self.punctual and self.awaiting not in self.ended and not self._heard_both:
            self.drain(lambda: self._heard_both, SAME_ITERATION)
        self.rest()

    def _await_other_stream(self, done: Callable[[], bool]) -> None:
        """Wait until the node rests; longer if it has slept between its two answers, or if that is not known yet.

        It is known of a node whose answers came together, and whose second one then did not come later either. One
        that sends it from a thread that sleeps on the wall clock is heard while it is waited for.
        """
        rested = self.rest()
        self.sends_both = self.sends_both or self._heard_both
        if done() or (rested and self.punctual and self.waits_in_vain >= IN_VAIN):
            return
        if self.drain(done, OTHER_STREAM_TIMEOUT):
            answered = self.awaiting in self.ended or self._heard_both
            self.punctual = self.punctual and not (rested and answered)
        elif self.punctual and self.sends_both:
            self.waits_in_vain += 1

    def rest(self, timeout: float = REST_TIMEOUT) -> bool:
        """Hold simulated time until the node is idle; False if it is busy for too long."""
        return self._rest.hold(timeout)

    def _digest(self) -> None:
        self._rest.digest(bool(self.awaiting))

    def _serve_one_shot(self) -> None:
        """After messages were sent: hold time until a node that needed one of them has made use of it."""
        if not self.awaiting or self.awaiting in self.ended:
            return
        if self.one_shot.served():
            timeout = LASTING_TIMEOUT if self.one_shot.lasting_seen else ONE_SHOT_TIMEOUT
            started = time.monotonic()
            if self.drain(lambda: self._dead() or not self.one_shot.served(), timeout):
                self.stage.exclude_from_deadlines(time.monotonic() - started)
            else:
                self.one_shot.keep_served()
        if self.one_shot.seen:
            self.rest()

    def follow_goal(self, goal: str) -> None:
        """From now on ticks wait for answers to this goal, which has just been sent."""
        busy = self.awaiting and self.awaiting not in self.ended  # its loop wakes up with the next tick only
        self.awaiting = goal
        self.fell_silent = self.lockstep.slower_than_ticks()
        self.heard.clear()
        self.lockstep = Lockstep(self.stage.tick_number)
        soon = self.drain(
            lambda: goal in self.known or goal in self.ended, SETTLE if busy or self.accepts_late else FIRST_TIMEOUT
        )
        self.accepts_late = not (soon or busy)
        if not (self.punctual and self.followed):
            self.drain(lambda: self._heard_both or goal in self.ended, SETTLE)
        self.followed = True
        self.rest()
        for stream in STREAMS:
            self.lockstep.commanded(stream)

    def settle(self, seconds: float) -> None:
        """Let time pass without waiting for answers, as the goal has ended."""
        self.awaiting = ""
        if not self.punctual:
            self.drain(lambda: False, SETTLE)
        self.rest()
        for _ in range(int(round(seconds * 10))):
            self.tick()
        self.one_shot.forget()

    # -- the node --

    def _dead(self) -> bool:
        return self.node is None or self.node.status() is not None

    def _record_death(self) -> None:
        if self.node is None or self.death_recorded:
            return
        status = self.node.status()
        if status is not None:
            self.death_recorded = True
            reason = self.node.guard.reason
            if not reason and status in rec.OUT_OF_TIME:
                reason = "it used more processor time than a node may"
            elif not reason and status in rec.KILLED and memory_group.has_killed():
                reason = exceeded_memory(memory_group.LIMIT)
            self.add("deaths", rec.Death(self.stage.now, status, reason))

    def wait_for(self, condition: Callable[[], bool], timeout: float, pace: float = PACE) -> bool:
        """Let time pass until a condition holds, the node is dead or `timeout` [s, wall] is over; whether it holds.

        Not at real time even if watched: a node that takes simulated seconds to start has the same timeout.
        """
        deadline, excludable = time.monotonic() + timeout, MOST_BUSY
        while not condition():
            if self._dead() or time.monotonic() >= deadline:
                self._record_death()
                return condition()
            started = time.monotonic()
            if not self.rest(START_REST):  # it loads its modules, for long on a busy machine
                spent = min(excludable, time.monotonic() - started)
                excludable, deadline = excludable - spent, deadline + spent
                self.stage.exclude_from_deadlines(spent)
            self.tick(pace, real_time=False, patience=START_REST)
            self._rest.forgive()
        return True
