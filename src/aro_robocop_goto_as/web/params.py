"""Parameters of the web page."""

from dataclasses import dataclass
from typing import List

from ..param_loading import frame_problems, parameter, positive


@dataclass(frozen=True)
class WebParams:
    """Arguments of robocop_web, given as NAME:=VALUE; docs/web.md documents each one."""

    web_host: str = "127.0.0.1"
    web_port: int = parameter(8080, low=1, high=65535)
    web_frame: str = "map"
    web_origins: str = ""
    web_linear_velocity: float = positive(0.2, high=100.0)
    web_angular_velocity: float = positive(1.0, high=100.0)
    replay: str = ""
    replay_waits: bool = True
    view_only: bool = False

    def conflicts(self) -> List[str]:
        """A frame name that tf2 would refuse, in words; empty when there is none."""
        return frame_problems("web_frame", self.web_frame)
