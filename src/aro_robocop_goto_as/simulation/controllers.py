"""Velocity commands: applied at once, or in lockstep at the end of the control tick, for which time is held."""

import math
from dataclasses import dataclass, field
from typing import AbstractSet, Callable, Dict, List, Optional, Tuple

from ..geometry import STANDSTILL, Twist2D
from ..sim_params import LockstepParams
from .jobs import Clock
from .lockstep import FIRST, ControllerId, Lockstep
from .simulator import Simulator

DISCONNECT_POLL = 0.05  # [s, wall] between two checks for disconnected controllers while waiting for their answers

SECOND_LOOK = 0.005  # [s, wall] during which what has arrived meanwhile is processed
# [s, wall] rospy.sleep() looks at the time, then waits for up to 0.5 s: a clock message in between does not wake it up.
STILL = 0.6

NodesOf = Callable[[int], AbstractSet[str]]  # names of nodes, by the robot that they are connected to
# Whether a controller is kept from answering, for want of a processor, of which it may use so much [s].
IsKept = Callable[[ControllerId, float], bool]


@dataclass
class TickReport:
    """How a control tick ended."""

    late: List[ControllerId] = field(default_factory=list)  # did not answer in time: time goes on without them
    gone: List[ControllerId] = field(default_factory=list)  # disconnected: their robots are stopped
    slower: List[Tuple[ControllerId, float]] = field(default_factory=list)  # with the rates of their loops [Hz]


class Controllers:
    """The nodes that command robots. The simulation's owner calls all methods.

    A control tick in lockstep: begin_tick(), then jobs are run for as long as hold() says, then end_tick().
    """

    def __init__(self, simulator: Simulator, params: LockstepParams, clock: Clock) -> None:
        self.in_lockstep = params.enabled
        self.timeout = params.lockstep_timeout
        self.lockstep = Lockstep()
        self._rate = simulator.p.rates.control_rate
        self._simulator = simulator
        self._clock = clock
        # In lockstep the newest command of each robot, which is applied at the tick's end:
        self._pending: Dict[int, Tuple[ControllerId, Twist2D]] = {}
        self._report = TickReport()
        self._held_since = self._next_look = 0.0  # [s, wall]
        self._is_reset = False  # since the tick began
        self._silent_since = math.inf  # [s, wall] at all looks since then, nobody was kept from answering

    def command(self, controller: ControllerId, twist: Optional[Twist2D]) -> None:
        """A velocity command that does not name a tick. In lockstep it is applied at the end of the current tick.

        None: it was refused, so the one before stays in force, but in lockstep it is an answer like any other.
        """
        if not self.in_lockstep:
            if twist is not None:
                self._simulator.command(twist, controller.robot)
        elif not self.lockstep.is_stamped(controller):  # which sends the same command with its answer
            self.lockstep.tick = self.tick
            self.lockstep.commanded(controller)
            if twist is not None:
                self._pending[controller.robot] = controller, twist

    def answer(self, controller: ControllerId, stamp_ns: int, twist: Optional[Twist2D]) -> None:
        """A controller's answer to the control tick at `stamp_ns`, with its command if it has one."""
        tick = round(stamp_ns * self._rate / 1e9)
        if tick > self.tick:
            return  # sent before a reset set simulated time back
        self.lockstep.answered(controller, tick)
        if twist is not None and self.lockstep.is_stamped(controller):  # not enrolled yet: it is also on cmd_vel
            self._pending[controller.robot] = controller, twist

    @property
    def tick(self) -> int:
        """Number of the control tick at which simulated time stands, or which it runs towards."""
        return -(-self._simulator.steps * self._rate // self._simulator.rate)

    def enroll(self, answering: NodesOf) -> None:
        """Wait from the next tick on for the controllers that are connected to answer ticks."""
        if self.in_lockstep:
            self.lockstep.tick = self._simulator.steps * self._rate // self._simulator.rate  # the last one reached
            for robot in range(len(self._simulator.robots)):
                for node in answering(robot):
                    self.lockstep.enroll(ControllerId(robot, node))

    def begin_tick(self) -> None:
        """Simulated time has reached a control tick, and is held until the controllers have answered."""
        self.lockstep.tick = self.tick
        self._report, self._is_reset, self._silent_since = TickReport(), False, math.inf
        self._held_since = self._clock.now()
        self._next_look = self._held_since + DISCONNECT_POLL

    def hold(self, connected: NodesOf, is_kept: IsKept) -> float:
        """How long to hold simulated time [s, wall] before asking again; 0: nobody is waited for any more.

        After the timeout, a controller is given up only if it is not kept from answering, at each look for some time.
        """
        while not self._is_reset and self.lockstep.missing():
            now = self._clock.now()
            if now >= self._next_look:
                self._forget_disconnected(connected)
                self._next_look = now + DISCONNECT_POLL
                continue
            share = self.lockstep.patience()
            patience = share * self.timeout
            remaining = self._held_since + patience - now
            if remaining > 0.0:
                return min(remaining, self._next_look - now)
            if any(is_kept(controller, patience) for controller in self.lockstep.missing()):
                self._silent_since = math.inf
                return self._next_look - now
            self._silent_since = min(self._silent_since, now)
            remaining = self._silent_since + (STILL if share >= FIRST else SECOND_LOOK) - now
            if remaining > 0.0:
                return min(remaining, self._next_look - now)
            self._report.late = self.lockstep.give_up()
        return 0.0

    def _forget_disconnected(self, connected: NodesOf) -> None:
        """Do not wait for a controller that has disconnected, and stop its robot."""
        for controller in self.lockstep.missing():
            if controller.node not in connected(controller.robot):
                self._report.gone.append(controller)
                self.lockstep.gone(controller)
                pending = self._pending.get(controller.robot)
                if pending is None or pending[0] == controller:
                    self._pending[controller.robot] = controller, STANDSTILL

    def end_tick(self, answering: NodesOf) -> TickReport:
        """Apply the commands of the tick, and enroll who has connected meanwhile."""
        self.enroll(answering)
        pending, self._pending = self._pending, {}
        for robot, (_, twist) in pending.items():
            self._simulator.command(twist, robot)
        self._report.slower = [(name, self._rate / period) for name, period in self.lockstep.take_slower()]
        return self._report

    def restart(self) -> None:
        """Forget pending commands, because the simulation was reset."""
        self._is_reset = True
        self._pending.clear()
        self.lockstep.restart(self.tick)

    def drop_command(self, robot: int) -> None:
        """Forget a pending command, because its robot was placed elsewhere, at rest."""
        self._pending.pop(robot, None)
