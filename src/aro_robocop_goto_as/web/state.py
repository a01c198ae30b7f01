"""The state of the page that its parts share, as plain values."""

import threading
from dataclasses import dataclass, replace
from typing import Any, Optional, Tuple

from ..geometry import Pose3D


@dataclass(frozen=True)
class PageState:
    """What more than one part of the page needs to know."""

    can_send: bool = True  # visitors can send requests; otherwise they watch the system, or a recording
    recorded: bool = False  # a recording is shown, no running system
    robots: Tuple[str, ...] = ("",)  # namespaces; "" is a robot without one
    chosen: str = ""  # the robot that a visitor chose last
    answer: str = ""  # why the last request failed, empty if it did not
    simulated: bool = False  # a simulator has reported
    factor_asked: float = 0.0  # that the simulator is to reach; 0 for as fast as possible
    answering: bool = False  # there is a server of the selected robot, which publishes its status
    executing: Optional[bool] = None  # the selected robot's server executes a goal; None until it is known
    resets: int = 0  # how often robots were placed at their start again, or elsewhere
    root: str = ""  # the frame that the scene is drawn in
    pose: Optional[Pose3D] = None  # of the selected robot, in that frame

    @property
    def selected(self) -> str:
        """The robot that is shown in detail and driven."""
        return self.chosen if self.chosen in self.robots else self.robots[0]


class SharedState:
    """Holds the one PageState that all read; any thread may change parts of it."""

    def __init__(self, now: PageState) -> None:
        self.now = now
        self._lock = threading.Lock()

    def change(self, **values: Any) -> None:
        """Replace these fields of the state."""
        with self._lock:
            self.now = replace(self.now, **values)
