"""What connects the simulation loop to the outside."""

from typing import AbstractSet, Sequence

from ..errors import CommandError
from .lockstep import Controller
from .observations import Observations, Subscriptions


class LoopInterface:
    """What connects the loop to the outside: the ROS node, the judge, or a test. Called from the loop's thread."""

    def stopped(self) -> bool:
        """Whether the loop has to end."""
        return False

    def subscriptions(self) -> Subscriptions:
        """The sensors that somebody subscribes to now."""
        return {}

    def publish(self, observations: Observations) -> None:
        """Send one step's observations, and the clock last."""

    def publish_clock(self) -> None:
        """Repeat the clock while simulated time is held."""

    def report(self) -> None:
        """Called at clock ticks and while waiting: report the status if it is due."""

    def status_changed(self) -> None:
        """Paused, resumed or reset: report the status now."""

    def frames_changed(self) -> None:
        """map -> odom of a robot has jumped."""

    def world_changed(self) -> None:
        """The world was replaced by another one."""

    def connected(self, robot: int) -> AbstractSet[str]:
        """Names of the nodes that are connected to a robot's inputs."""
        return set()

    def answering(self, robot: int) -> AbstractSet[str]:
        """Names of the nodes that will answer a robot's control ticks."""
        return set()

    def command_refused(self, error: CommandError) -> None:
        """A velocity command was not finite; the previous one stays in force."""

    def controllers_late(self, controllers: Sequence[Controller]) -> None:
        """These did not answer a control tick in time; simulated time continues without them."""

    def controller_gone(self, controller: Controller) -> None:
        """This controller disconnected; its robot is stopped."""

    def placed_in_contact(self, robot: int) -> None:
        """A robot was placed in contact with an obstacle or with another robot."""
