"""Parameters of the RViz bridge."""

from dataclasses import dataclass
from typing import List

from ...param_loading import frame_problems, parameter, positive


@dataclass(frozen=True)
class BridgeParams:
    """Parameters of robocop_rviz_goto_ac."""

    goal_frame: str = parameter("odom", about="frame of the action server's goals; NAME/odom for a named robot")
    default_frame: str = parameter("map", about="assumed for a 2D Nav Goal without a frame, with a warning")
    transform_timeout: float = parameter(
        1.0, low=0.0, about="[s, wall] to wait for a transform at the goal's stamp; then the latest one is used"
    )
    status_period: float = positive(2.0, "[s] between two reports of the server's state")
    cancel_timeout: float = positive(2.0, "[s, wall] for a cancelled goal to end before the next goal is sent")
    ignore_goal_frame: bool = parameter(
        False, about="true: send the coordinates untransformed, as the lab's bridge did; for teaching only"
    )

    def conflicts(self) -> List[str]:
        """Frame names that tf2 would refuse, in words; empty when there are none."""
        return frame_problems("goal_frame", self.goal_frame) + frame_problems("default_frame", self.default_frame)
