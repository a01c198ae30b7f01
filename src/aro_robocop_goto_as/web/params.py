"""Parameters of the web page."""

from dataclasses import dataclass
from typing import List

from ..param_loading import frame_problems, parameter, positive


@dataclass(frozen=True)
class WebParams:
    """Arguments of robocop_web, given as NAME:=VALUE."""

    web_host: str = parameter(
        "127.0.0.1",
        about="address that the page listens on; 0.0.0.0: every network. ROBOCOP_WEB_HOST replaces the default",
    )
    web_port: int = parameter(8080, 1, 65535, "port of the page")
    web_frame: str = parameter("map", about="frame of the scene; odom if nobody publishes this frame")
    web_origins: str = parameter(
        "", about="more origins (https://host:port ...) whose requests are accepted, for a proxy that changes Host"
    )
    web_linear_velocity: float = positive(0.2, "[m/s] of buttons and keys", high=100.0)
    web_angular_velocity: float = positive(1.0, "[rad/s] of buttons and keys", high=100.0)
    replay: str = parameter("", about="path of a bag: the page shows this recording")
    replay_waits: bool = parameter(True, about="play when the first browser has opened the page, else at once")
    view_only: bool = parameter(
        False, about="nobody can send requests, and controls are hidden, as for a projector; the trail is off at first"
    )

    def conflicts(self) -> List[str]:
        """A frame name that tf2 would refuse, in words; empty when there is none."""
        return frame_problems("web_frame", self.web_frame)
