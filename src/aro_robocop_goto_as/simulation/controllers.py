"""Velocity commands: applied at once; in lockstep at the end of the tick that they answer, for which time is held."""

import contextlib
import queue
from typing import Dict, List, NamedTuple, Optional

from ..component_params import LockstepParams
from ..errors import CommandError
from ..geometry import STANDSTILL, Twist2D
from .lockstep import Controller, Lockstep
from .loop_interface import LoopInterface
from .simulator import Simulator
from .wall_clock import Clock, Job, Jobs

DISCONNECT_POLL = 0.05  # [s, wall] between two looks for disconnected controllers while waiting for their answers


class _Pending(NamedTuple):
    controller: Controller
    twist: Twist2D


class Controllers:
    """The nodes that command robots. The loop's thread calls all methods."""

    def __init__(
        self, simulator: Simulator, params: LockstepParams, interface: LoopInterface, clock: Clock, jobs: "Jobs[Job]"
    ) -> None:
        """`jobs` are run while time is held; they bring the answers."""
        self.in_lockstep = params.enabled
        self.timeout = params.timeout
        self.lockstep: Lockstep[Controller] = Lockstep()
        self._rate = params.control_rate
        self._simulator = simulator
        self._interface = interface
        self._clock = clock
        self._jobs = jobs
        self._pending: Dict[int, _Pending] = {}  # lockstep: newest command of each robot, applied at the tick's end
        self._resets = 0

    def command(self, controller: Controller, twist: Twist2D) -> None:
        """A velocity command that does not name a tick. In lockstep it is applied at the end of the current tick."""
        if self.lockstep.is_stamped(controller):
            return  # this controller sends the same command with its answer
        if not self.in_lockstep:
            self._apply(controller.robot, twist)
            return
        self.lockstep.tick = self.tick
        self.lockstep.commanded(controller)
        self._pending[controller.robot] = _Pending(controller, twist)

    def answer(self, controller: Controller, stamp_ns: int, twist: Optional[Twist2D]) -> None:
        """A controller's answer to the control tick at `stamp_ns`, with its command if it has one."""
        tick = round(stamp_ns * self._rate / 1e9)
        if tick > self.tick:
            return  # sent before a reset set simulated time back
        self.lockstep.answered(controller, tick)
        if twist is not None:
            self._pending[controller.robot] = _Pending(controller, twist)

    def _apply(self, robot: int, twist: Twist2D) -> None:
        try:
            self._simulator.command(twist, robot)
        except CommandError as error:
            self._interface.command_refused(error)

    @property
    def tick(self) -> int:
        """Number of the control tick at which simulated time stands, or which it runs towards."""
        return -(-self._simulator.steps * self._rate // self._simulator.config.rates.physics)

    def await_answers(self) -> float:
        """Hold simulated time until every controller has answered this tick or timed out, then apply the commands.

        Returns how long that took [s, wall].
        """
        self.enroll_answering()
        self.lockstep.tick = self.tick
        started, resets = self._clock.now(), self._resets
        next_look = started + DISCONNECT_POLL
        while self.lockstep.missing() and self._resets == resets and not self._interface.stopped():
            now = self._clock.now()
            remaining = started + self.lockstep.patience() * self.timeout - now
            if remaining <= 0.0:
                late = self.lockstep.give_up()
                if late:
                    self._interface.controllers_late(late)
                break
            if now >= next_look:
                self._forget_disconnected()
                next_look = now + DISCONNECT_POLL
                continue
            with contextlib.suppress(queue.Empty):
                self._clock.get(self._jobs, min(remaining, next_look - now))()
        pending, self._pending = self._pending, {}
        for robot, command in pending.items():
            self._apply(robot, command.twist)
        return self._clock.now() - started

    def enroll_answering(self) -> None:
        """Controllers that are connected to answer ticks are waited for from their first tick on."""
        if self.in_lockstep:
            for robot in range(len(self._simulator.robots)):
                for node in self._interface.answering(robot):
                    self.lockstep.enroll(Controller(robot, node))

    def _forget_disconnected(self) -> None:
        """Do not wait for a controller that has disconnected, and stop its robot."""
        for controller in self.lockstep.missing():
            if controller.node not in self._interface.connected(controller.robot):
                self._interface.controller_gone(controller)
                self.lockstep.gone(controller)
                pending = self._pending.get(controller.robot)
                if pending is None or pending.controller == controller:
                    self._pending[controller.robot] = _Pending(controller, STANDSTILL)

    def restart(self) -> None:
        """The simulation was reset: what was commanded before it does not count."""
        self._resets += 1
        self._pending.clear()
        self.lockstep.restart(self.tick)

    def drop_command(self, robot: int) -> None:
        """A robot was placed elsewhere, at rest."""
        self._pending.pop(robot, None)

    def awaited(self) -> List[Controller]:
        """The controllers that lockstep waits for; empty without lockstep."""
        return self.lockstep.drivers() if self.in_lockstep else []
