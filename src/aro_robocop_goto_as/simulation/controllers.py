"""Velocity commands: applied at once, or in lockstep at the end of the control tick; until then, time is held."""

from typing import Dict, NamedTuple, Optional

from ..geometry import STANDSTILL, Twist2D
from .jobs import WallClock
from .lockstep import Connected, ControllerId, Lockstep, TickOutcome
from .params import LockstepParams
from .simulator import Simulator


class _Pending(NamedTuple):
    placed: int  # how often the robot had been placed by then; what it was commanded before counts no more
    commands: Dict[str, Twist2D]  # the newest command since the last tick, by the name of its node


class Controllers:
    """The nodes that command robots. The thread that runs the simulator calls all methods.

    A control tick in lockstep: begin_tick(), then jobs are run for as long as hold_time() says, then end_tick().
    """

    def __init__(self, simulator: Simulator, params: LockstepParams, clock: WallClock) -> None:
        self.in_lockstep = params.enabled
        self.lockstep = Lockstep(params.lockstep_timeout, clock)
        self._rate = simulator.params.rates.control_rate
        self._simulator = simulator
        self._pending: Dict[int, _Pending] = {}  # by robot, in lockstep
        self._resets = simulator.resets  # before the present tick

    def command(self, controller: ControllerId, twist: Optional[Twist2D]) -> None:
        """A velocity command that does not name a tick. In lockstep it is applied at the end of the current tick.

        None: the command was refused. The earlier command stays in force; in lockstep a refused one counts as an
        answer, too.
        """
        if not self.in_lockstep:
            if twist is not None:
                self._simulator.command(twist, controller.robot)
        elif not self.lockstep.answers_ticks(controller):  # which sends the same command with its answer
            self.lockstep.commanded(controller, self.period)
            self._keep(controller, twist)

    def answer(self, controller: ControllerId, stamp_ns: int, twist: Optional[Twist2D]) -> None:
        """A controller's answer to the control tick at `stamp_ns`, with its command if it has one."""
        period = round(stamp_ns * self._rate / 1e9)
        if period <= self.period:  # else simulated time has not been there
            self.lockstep.answered(controller, period)
            self._keep(controller, twist)

    def _keep(self, controller: ControllerId, twist: Optional[Twist2D]) -> None:
        if twist is not None:
            self._commands(controller.robot)[controller.node] = twist

    def _commands(self, robot: int) -> Dict[str, Twist2D]:
        """A robot's pending commands since it was placed."""
        pending, placed = self._pending.get(robot), self._simulator.placed[robot]
        if pending is None or pending.placed != placed:
            pending = self._pending[robot] = _Pending(placed, {})
        return pending.commands

    @property
    def period(self) -> int:
        """Number of the control period in which, or at whose end, simulated time stands."""
        return -(-self._simulator.steps * self._rate // self._simulator.rate)

    def begin_tick(self, connected: Connected) -> None:
        """Simulated time has reached a control tick, and is held until the controllers have answered."""
        self._resets = self._simulator.resets
        self.lockstep.begin_tick(self.period, connected)

    def hold_time(self, connected: Connected) -> float:
        """How long to hold simulated time at this tick [s, wall] before asking again; 0: it may go on.

        After a reset nobody is waited for any more.
        """
        if self._simulator.resets != self._resets:
            return 0.0
        return self.lockstep.hold_time(self.period, connected)

    def end_tick(self) -> TickOutcome:
        """Apply the commands of the tick; where several nodes command one robot, the last one by name wins."""
        outcome = self.lockstep.outcome
        for robot, node in outcome.gone:
            commands = self._commands(robot)
            commands.pop(node, None)
            if not commands:
                commands[node] = STANDSTILL
        for robot in list(self._pending):
            commands = self._commands(robot)
            if commands:
                self._simulator.command(commands[max(commands)], robot)
        self._pending.clear()
        return outcome
