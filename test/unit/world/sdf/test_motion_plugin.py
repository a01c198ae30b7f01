"""This package's plugin for scripted motion is validated."""

import pytest
from sdf_files import model, raised_by, world_file

MOVER = '<plugin name="p" filename="robocop_motion">{}</plugin>'


POST = (
    '<collision name="c"><pose>{}</pose>'
    "<geometry><cylinder><radius>0.1</radius><length>1</length></cylinder></geometry></collision>"
)


@pytest.mark.parametrize(
    ("motion", "shape", "named"),
    [
        ("<spin>1</spin>", "", ["<spin>", "turn, waypoint"]),
        ("<waypoint>1 2</waypoint>", "", ["'1 2'", "3 finite numbers"]),
        ("<waypoint>1 1 0</waypoint><waypoint>1 0 0</waypoint>", "", ["at 1 s", "later"]),
        ("<waypoint>1 1 0</waypoint>", "", ["'1 0'", "0 0, where the cycle starts again"]),
        ("<turn>1</turn></plugin>" + MOVER[: -len("</plugin>")].format(""), "", ["second", "robocop_motion"]),
        ("<turn>1</turn>", POST.format("0 0 0 1 0 0"), ["m/l/c", "upright cylinders, spheres"]),
    ],
)
def test_invalid_motion_is_refused(tmp_path, motion, shape, named):
    text = model(shape, pose=MOVER.format(motion))
    message = raised_by(world_file(tmp_path, text))
    assert [word for word in named if word not in message] == [], message
