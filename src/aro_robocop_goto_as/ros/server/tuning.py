"""Gains, tolerances and speeds of the action server, changed by dynamic_reconfigure while it runs."""

from typing import Any

import rospy
from dynamic_reconfigure.server import Server

from aro_robocop_goto_as.cfg import GotoConfig

from ...errors import ParameterError
from ...goto.params import GotoParams, differences, tuned

NAMES = tuple(GotoConfig.defaults)


class Tuning:
    """`params` are the newest valid parameters; its users read them here each time, and keep no copy.

    A request replaces the whole frozen object, so no lock is needed.
    """

    def __init__(self, p: GotoParams) -> None:
        self.params = p
        for name in NAMES:  # from which the server of dynamic_reconfigure starts, and which it wants to be floats
            rospy.set_param(f"~{name}", getattr(p, name))
        self._server = Server(GotoConfig, self._on_change)

    def _on_change(self, config: Any, _level: int) -> Any:
        """Adopt the requested values, or refuse all of them; returns the values in force, which tools then show."""
        try:
            new = tuned(self.params, {name: config[name] for name in NAMES})
        except ParameterError as error:
            rospy.logwarn("%s; nothing is changed", error)
        else:
            for difference in differences(self.params, new):
                rospy.loginfo("%s", difference)
            self.params = new
        config.update({name: getattr(self.params, name) for name in NAMES})
        return config
