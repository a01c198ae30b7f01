"""When simulated time may go on: pause, spans of a ~step request, and pacing against the wall clock."""

from concurrent.futures import Future
from dataclasses import dataclass
from typing import Callable, Optional

from .jobs import WallClock
from .params import TimeParams

PAUSED_PERIOD = 0.1  # [s, wall] between repetitions of /clock while paused, for nodes that start meanwhile
MAX_HOLD = 0.5  # [s, wall] between two checks for other due work while the wall clock is waited for
PACE_PERIOD = 1.0  # [s, wall] over which the pace is measured
MAX_LAG = 0.1  # [s, wall] a longer lag is dropped instead of being made up for in a burst
REST_PERIOD, REST = 0.01, 1e-4  # [s, wall] a simulation that never waits rests this often, for this long
TOLERANCE = 0.95  # share of the requested factor, below which the simulation counts as behind


@dataclass(frozen=True)
class Pace:
    """Real-time factor reached over the last period, and the requested one (0 = as fast as possible)."""

    reached: float
    asked: float
    step_time: float  # [s, wall] of work per step, without waiting
    lag: float  # [s, wall] behind the requested factor
    dropped: float = 0.0  # [s, wall] of lag over the last period that will not be made up for

    @property
    def behind(self) -> bool:
        """Return whether the machine is too slow for the requested factor; a lag that is made up for does not count."""
        return self.dropped > 0.0 and self.reached < TOLERANCE * self.asked


class Pacer:
    """Keeps simulated time at `factor` times the wall clock; factor 0 inserts rests only.

    A rest lets the process's other threads run, which accept subscribers and receive commands. A thread that waits for
    the GIL asks for it after 5 ms (sys.getswitchinterval). numpy often releases the GIL for microseconds, after which
    these 5 ms begin anew, so that other threads could starve for minutes.
    """

    def __init__(self, factor: float, rate: int, now: Callable[[], float]) -> None:
        """`rate` [Hz] of the steps; `now`: the wall clock [s]."""
        self.factor = factor
        self.now = now
        self._rate = rate
        self.restart(0)

    def restart(self, step: int) -> None:
        """Start counting at this step, as after a pause."""
        self._anchor_wall, self._anchor_step = self.now(), step
        self._pace_wall, self._pace_step = self._anchor_wall, step
        self._rested = self._anchor_wall
        self._waited = self._lag = self._dropped = 0.0

    def wait_time(self, step: int) -> float:
        """How long to wait [s, wall] before going on from a step: until it is due, or for a rest, which begins now."""
        wall = self.now()
        ahead = self._until_due(step, wall)
        if ahead == 0.0 and wall - self._rested >= REST_PERIOD:
            ahead = REST
        if ahead > 0.0:
            self._rested = wall + ahead
        return ahead

    def _until_due(self, step: int, wall: float) -> float:
        if self.factor == 0.0:
            return 0.0
        due = self._anchor_wall + (step - self._anchor_step) / self._rate / self.factor
        self._lag = max(0.0, wall - due)
        if wall - due > MAX_LAG:
            self._anchor_wall, self._anchor_step = wall, step
            self._dropped += self._lag
        return max(0.0, due - wall)

    def waited(self, seconds: float) -> None:
        """Add time [s, wall] spent waiting, which does not count as work."""
        self._waited += seconds
        if seconds >= REST:
            self._rested = self.now()

    def measure_pace(self, step: int) -> Optional[Pace]:
        """The pace since the last measurement; None until PACE_PERIOD has passed."""
        wall = self.now()
        elapsed = wall - self._pace_wall
        if elapsed < PACE_PERIOD:
            return None
        done = step - self._pace_step
        step_time = max(0.0, elapsed - self._waited) / done if done > 0 else 0.0
        dropped, self._dropped = self._dropped, 0.0
        self._pace_wall, self._pace_step, self._waited = wall, step, 0.0
        return Pace(done / self._rate / elapsed, self.factor, step_time, self._lag, dropped)


class TimeControl:
    """Pause, span and pacing. A span is the simulated time that one request of ~step asks for.

    A `step` is the simulator's step count. The simulation thread runs jobs for as long as hold_time() says.
    """

    def __init__(self, params: TimeParams, rate: int, clock: WallClock) -> None:
        """`rate` [Hz] of the steps."""
        self.paused = params.start_paused
        self.pacer = Pacer(params.real_time_factor, rate, clock.now)
        self._rate = rate
        self._clock = clock
        self._span_end = 0  # step at which a requested span ends; 0 = none
        self._span_ended: Future[int] = Future()
        self._pause_after_span = True
        self._next_repetition = 0.0  # [s, wall] of the clock, while paused

    @property
    def standing(self) -> bool:
        """Return whether simulated time stands still: it is paused, and no span runs."""
        return self.paused and not self._span_end

    @property
    def as_fast_as_possible(self) -> bool:
        """Return whether steps follow each other as fast as possible: nothing but a controller holds them."""
        return not (self.pacer.factor or self.paused or self._span_end)

    def hold_time(self, step: int) -> float:
        """How long to hold simulated time at a step [s, wall] before asking again; 0: it may go on."""
        if self.standing:
            return PAUSED_PERIOD
        return min(MAX_HOLD, self.pacer.wait_time(step))

    def repetition_due(self) -> bool:
        """Return whether /clock has to be repeated now, because simulated time stands still."""
        now = self._clock.now()
        if not self.standing or now < self._next_repetition:
            return False
        self._next_repetition = now + PAUSED_PERIOD
        return True

    def set_paused(self, paused: bool, step: int) -> None:
        """Pause or resume at a step; during a span, from its end on."""
        self.paused = self._pause_after_span = paused
        self.pacer.restart(step)

    def set_real_time_factor(self, factor: float, step: int) -> None:
        """Run at this multiple of the wall clock from a step on; 0 = as fast as possible."""
        self.pacer.factor = factor
        self.pacer.restart(step)

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
        self.pacer.restart(step)
        return self._span_ended

    def steps_left(self, step: int) -> int:
        """How many steps after this one may be made before the span ends."""
        return self._span_end - step if self._span_end else 10**9

    def end_span(self, step: int) -> bool:
        """End the span if it ends at this step; return whether it does."""
        if not self._span_end or step < self._span_end:
            return False
        self._span_end, self.paused = 0, self._pause_after_span
        self._span_ended.set_result(step)
        return True
