"""Velocity commands: applied at once, or in lockstep at the end of the control tick; until then, time is held."""

from typing import Dict, Optional

from ..geometry import STANDSTILL, Twist2D
from ..sim_params import LockstepParams
from .jobs import Clock
from .lockstep import Connected, ControllerId, Lockstep, TickReport
from .simulator import Simulator


class Controllers:
    """The nodes that command robots. The simulation's owner calls all methods.

    A control tick in lockstep: begin_tick(), then jobs are run for as long as hold() says, then end_tick().
    """

    def __init__(self, simulator: Simulator, params: LockstepParams, clock: Clock) -> None:
        self.in_lockstep = params.enabled
        self.lockstep = Lockstep(params.lockstep_timeout, clock)
        self._rate = simulator.params.rates.control_rate
        self._simulator = simulator
        # In lockstep the newest command of each node since the last tick, by robot and by the node's name:
        self._pending: Dict[int, Dict[str, Twist2D]] = {}

    def command(self, controller: ControllerId, twist: Optional[Twist2D]) -> None:
        """A velocity command that does not name a tick. In lockstep it is applied at the end of the current tick.

        None: the command was refused. The earlier command stays in force; in lockstep a refused one counts as an
        answer, too.
        """
        if not self.in_lockstep:
            if twist is not None:
                self._simulator.command(twist, controller.robot)
        elif not self.lockstep.answers_ticks(controller):  # which sends the same command with its answer
            self.lockstep.commanded(controller, self.tick)
            self._keep(controller, twist)

    def answer(self, controller: ControllerId, stamp_ns: int, twist: Optional[Twist2D]) -> None:
        """A controller's answer to the control tick at `stamp_ns`, with its command if it has one."""
        tick = round(stamp_ns * self._rate / 1e9)
        if tick <= self.tick:  # else simulated time has not been there
            self.lockstep.answered(controller, tick)
            self._keep(controller, twist)

    def _keep(self, controller: ControllerId, twist: Optional[Twist2D]) -> None:
        if twist is not None:
            self._pending.setdefault(controller.robot, {})[controller.node] = twist

    @property
    def tick(self) -> int:
        """Number of the control tick at which simulated time stands, or which it runs towards."""
        return -(-self._simulator.steps * self._rate // self._simulator.rate)

    def begin_tick(self, connected: Connected) -> None:
        """Simulated time has reached a control tick, and is held until the controllers have answered."""
        self.lockstep.begin_tick(self.tick, connected)

    def hold(self, connected: Connected) -> float:
        """How long to hold simulated time at this tick [s, wall] before asking again; 0: it may go on."""
        return self.lockstep.hold(self.tick, connected)

    def end_tick(self) -> TickReport:
        """Apply the commands of the tick; where several nodes command one robot, the last one by name wins."""
        report, pending, self._pending = self.lockstep.report, self._pending, {}
        for robot, node in report.gone:
            commands = pending.setdefault(robot, {})
            commands.pop(node, None)
            if not commands:
                commands[node] = STANDSTILL
        for robot, commands in pending.items():
            self._simulator.command(commands[max(commands)], robot)
        return report

    def restart(self) -> None:
        """Forget pending commands, because the simulation was reset."""
        self.lockstep.release()
        self._pending.clear()

    def drop_command(self, robot: int) -> None:
        """Forget a pending command, because its robot was placed elsewhere, at rest."""
        self._pending.pop(robot, None)
