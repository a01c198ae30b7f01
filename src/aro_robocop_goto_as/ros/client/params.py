"""Parameters of the RViz bridge."""

from dataclasses import dataclass
from typing import List

from ...param_loading import frame_problems, parameter, positive


@dataclass(frozen=True)
class BridgeParams:
    """Parameters of robocop_rviz_goto_ac; config/rviz_goto_ac.yaml documents each one."""

    goal_frame: str = "odom"
    default_frame: str = "map"
    transform_timeout: float = parameter(1.0, low=0.0)
    status_period: float = positive(2.0)
    cancel_timeout: float = positive(2.0)
    ignore_goal_frame: bool = False

    def conflicts(self) -> List[str]:
        """Frame names that tf2 would refuse, in words; empty when there are none."""
        return frame_problems("goal_frame", self.goal_frame) + frame_problems("default_frame", self.default_frame)
