"""When simulated time may go on: pause, spans of a ~step request, and pacing against the wall clock."""

from concurrent.futures import Future
from typing import Optional

from ..sim_params import TimeParams
from .jobs import Clock
from .pacer import Pacer

PAUSED_PERIOD = 0.1  # [s, wall] between repetitions of /clock while paused, for nodes that start meanwhile
LONGEST_HOLD = 0.5  # [s, wall] between two checks for other due work while the wall clock is waited for


class TimeControl:
    """Pause, span and pacing. A `step` is the simulator's count; its owner runs jobs for as long as hold() says."""

    def __init__(self, params: TimeParams, rate: int, clock: Clock) -> None:
        """`rate` [Hz] of the steps."""
        self.paused = params.start_paused
        self.pacer = Pacer(params.real_time_factor, rate, clock.now)
        self._rate = rate
        self._clock = clock
        self._span_end = 0  # step at which a requested span ends; 0 = none
        self._span_ended: Future[int] = Future()
        self._pause_after_span = True
        self._next_repetition = 0.0  # [s, wall] of the clock, while paused

    def restart(self, step: int) -> None:
        """Pace from this step on, as after a pause."""
        self.pacer.restart(step)

    @property
    def standing(self) -> bool:
        """Whether simulated time stands still: it is paused, and no span runs."""
        return self.paused and not self._span_end

    def hold(self, step: int) -> float:
        """How long to hold simulated time at a step [s, wall] before asking again; 0: it may go on."""
        if self.standing:
            return PAUSED_PERIOD
        return min(LONGEST_HOLD, self.pacer.ahead(step))

    def repetition_due(self) -> bool:
        """While simulated time stands still: whether /clock has to be repeated now."""
        now = self._clock.now()
        if not self.standing or now < self._next_repetition:
            return False
        self._next_repetition = now + PAUSED_PERIOD
        return True

    def set_paused(self, paused: bool, step: int) -> None:
        """Pause or resume at a step; during a span, from its end on."""
        self.paused = self._pause_after_span = paused
        self.restart(step)

    def set_real_time_factor(self, factor: float, step: int) -> None:
        """Run at this multiple of the wall clock from a step on; 0 = as fast as possible."""
        self.pacer.factor = factor
        self.restart(step)

    # -- spans --

    def begin_span(self, duration: float, step: int) -> "Optional[Future[int]]":
        """Run for `duration` [s, simulated] from a step on, one step at least, then pause; None while a span runs.

        Returns the number of the span's last step, once it is reached. If somebody resumes the simulation meanwhile, it
        keeps running instead of pausing.
        """
        if self._span_end:
            return None
        self._pause_after_span = True
        self._span_end, self._span_ended = step + max(1, round(duration * self._rate)), Future()
        self.restart(step)
        return self._span_ended

    def steps_left(self, step: int) -> int:
        """How many steps after this one may be made before the span ends."""
        return self._span_end - step if self._span_end else 10**9

    def end_span(self, step: int) -> bool:
        """End the span if it ends at this step; whether it does."""
        if not self._span_end or step < self._span_end:
            return False
        self._span_end, self.paused = 0, self._pause_after_span
        self._span_ended.set_result(step)
        return True

    def shift_span(self, steps: int) -> None:
        """Move the span's end by as many steps as a reset has set the simulator's count back."""
        if self._span_end:
            self._span_end -= steps
