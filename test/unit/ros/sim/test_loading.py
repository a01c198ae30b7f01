"""What the log says about where the robot starts."""

import pytest
from sdf_files import SPHERE, collision, model, world_file

from aro_robocop_goto_as.param_loading import from_dict
from aro_robocop_goto_as.ros.sim import loading
from aro_robocop_goto_as.simulation.params import SimParams


@pytest.mark.parametrize(
    "name, told",
    [
        ("burger", "the saved robot's pose (0, 0) is occupied by 'm/l/c'; spawning at the free pose ("),
        ("chair", "world w does not say where robots start, and (0, 0) is occupied by 'm/l/c'; spawning at"),
    ],
)
def test_what_is_in_the_way_of_the_start_is_told(tmp_path, monkeypatch, name, told):
    warnings = []
    monkeypatch.setattr(loading.rospy, "logwarn", lambda text, *values: warnings.append(text % values))
    path = world_file(tmp_path, model(collision(SPHERE)) + f'<model name="{name}"/>')
    loading.load_simulator(from_dict(SimParams, {"world": path, "drive": "kinematic"}, "test"))
    assert warnings[0].startswith(told)
