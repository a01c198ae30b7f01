"""Velocity commands: applied at once, or in lockstep at the end of the control tick, for which time is held."""

from typing import Dict, Optional, Tuple

from ..geometry import STANDSTILL, Twist2D
from ..sim_params import LockstepParams
from .awaited_answers import AwaitedAnswers, ControllerId
from .jobs import Clock
from .lockstep import Lockstep, NodesOf, TickReport
from .simulator import Simulator


class Controllers:
    """The nodes that command robots. The simulation's owner calls all methods.

    A control tick in lockstep: begin_tick(), then jobs are run for as long as lockstep.hold() says, then end_tick().
    """

    def __init__(self, simulator: Simulator, params: LockstepParams, clock: Clock) -> None:
        self.in_lockstep = params.enabled
        self.answers = AwaitedAnswers()
        self.lockstep = Lockstep(self.answers, params.lockstep_timeout, clock, self._stop_robot_of)
        self._rate = simulator.p.rates.control_rate
        self._simulator = simulator
        # In lockstep the newest command of each robot, which is applied at the tick's end:
        self._pending: Dict[int, Tuple[ControllerId, Twist2D]] = {}

    def command(self, controller: ControllerId, twist: Optional[Twist2D]) -> None:
        """A velocity command that does not name a tick. In lockstep it is applied at the end of the current tick.

        None: it was refused, so the one before stays in force, but in lockstep it is an answer like any other.
        """
        if not self.in_lockstep:
            if twist is not None:
                self._simulator.command(twist, controller.robot)
        elif not self.answers.is_stamped(controller):  # which sends the same command with its answer
            self.answers.tick = self.tick
            self.answers.commanded(controller)
            if twist is not None:
                self._pending[controller.robot] = controller, twist

    def answer(self, controller: ControllerId, stamp_ns: int, twist: Optional[Twist2D]) -> None:
        """A controller's answer to the control tick at `stamp_ns`, with its command if it has one."""
        tick = round(stamp_ns * self._rate / 1e9)
        if tick > self.tick:
            return  # simulated time has not been there
        self.answers.answered(controller, tick)
        if twist is not None and self.answers.is_stamped(controller):  # not enrolled yet: it is also on cmd_vel
            self._pending[controller.robot] = controller, twist

    @property
    def tick(self) -> int:
        """Number of the control tick at which simulated time stands, or which it runs towards."""
        return -(-self._simulator.steps * self._rate // self._simulator.rate)

    def enroll(self, answering: NodesOf) -> None:
        """Wait from the next tick on for the controllers that are connected to answer ticks."""
        if self.in_lockstep:
            self.answers.tick = self._simulator.steps * self._rate // self._simulator.rate  # the last one reached
            for robot in range(len(self._simulator.robots)):
                for node in answering(robot):
                    self.answers.enroll(ControllerId(robot, node))

    def begin_tick(self) -> None:
        """Simulated time has reached a control tick, and is held until the controllers have answered."""
        self.answers.tick = self.tick
        self.lockstep.begin_tick()

    def _stop_robot_of(self, gone: ControllerId) -> None:
        pending = self._pending.get(gone.robot)
        if pending is None or pending[0] == gone:
            self._pending[gone.robot] = gone, STANDSTILL

    def end_tick(self, answering: NodesOf) -> TickReport:
        """Apply the commands of the tick, and enroll who has connected meanwhile."""
        self.enroll(answering)
        report, pending, self._pending = self.lockstep.report, self._pending, {}
        for robot, (_, twist) in pending.items():
            self._simulator.command(twist, robot)
        report.slower = [(name, self._rate / period) for name, period in self.answers.take_slower()]
        return report

    def restart(self) -> None:
        """Forget pending commands, because the simulation was reset."""
        self.lockstep.release()
        self._pending.clear()
        self.answers.restart(self.tick)

    def drop_command(self, robot: int) -> None:
        """Forget a pending command, because its robot was placed elsewhere, at rest."""
        self._pending.pop(robot, None)
