"""A running simulator: with its time, its controllers and the jobs of other threads.

Its owner, the ROS node, the grader or a test, has the loop, of which every part returns values:

    jobs.run_next(time.hold(...))       what other threads ask for, while the wall clock is waited for
    simulator.advance(subscriptions)    -> observations, which the owner publishes
    controllers.lockstep.hold(...)      in lockstep: how long to wait for answers to a control tick
    take_changes()                      -> what has jumped, which the owner publishes anew
"""

import enum
from typing import Callable, Optional, Set

from ..geometry import Pose2D
from ..sim_params import SimParams
from ..world.model import World
from .controllers import Controllers
from .jobs import Clock, Jobs
from .simulator import Simulator
from .time_control import TimeControl


class Change(enum.Enum):
    """What has changed other than by a step."""

    STATUS = "paused, resumed, or reset"
    FRAMES = "map -> odom of a robot has jumped"
    WORLD = "the world was replaced"


class Simulation:
    """The simulator, its time, its controllers and other threads' jobs; all methods are for the owner's thread."""

    def __init__(
        self, simulator: Simulator, clock: Optional[Clock] = None, stopped: Callable[[], bool] = lambda: False
    ) -> None:
        """`stopped`: whether the owner's loop has ended; by the wall clock unless another one is given."""
        params: SimParams = simulator.params
        clock = clock or Clock()
        self.simulator = simulator
        self.jobs = Jobs(clock, stopped)
        self.time_control = TimeControl(params.time, simulator.rate, clock)
        self.controllers = Controllers(simulator, params.lockstep, clock)
        self._changes: Set[Change] = set()

    def take_changes(self) -> Set[Change]:
        """What has changed since the last call."""
        changes = self._changes
        if changes:
            self._changes = set()
        return changes

    def set_paused(self, paused: bool) -> None:
        """Pause or resume simulated time; during a span, from its end on."""
        self.time_control.set_paused(paused, self.simulator.steps)
        self._changes.add(Change.STATUS)

    def reset(self, seed: Optional[int] = None) -> None:
        """Put robots at their spawn poses, odometry to zero, noise to its start; None keeps the seed."""
        self.simulator.reset(seed)
        self.time_control.pacer.restart(self.simulator.steps)
        self.controllers.restart()
        self._changes |= {Change.FRAMES, Change.STATUS}

    def place(self, world_from_footprint: Pose2D, robot: int = 0, *, anywhere: bool = False) -> None:
        """Place a robot elsewhere, at rest.

        PlaceError, naming the obstacle, if it would overlap something, unless it may be placed `anywhere`.
        """
        if not anywhere:
            self.simulator.require_room(world_from_footprint, robot)
        self.simulator.place(world_from_footprint, robot)
        self.controllers.drop_command(robot)
        self._changes.add(Change.FRAMES)

    def change_world(self, edit: Callable[[World], World]) -> None:
        """Replace the world by what `edit` makes of it."""
        self.simulator.change_world(edit(self.simulator.world))
        self._changes.add(Change.WORLD)
