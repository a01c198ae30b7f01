"""Objects in URDF are spawned like those in SDF."""

import pytest

from aro_robocop_goto_as.errors import WorldError
from aro_robocop_goto_as.geometry import Pose3D
from aro_robocop_goto_as.world.edit import requested_model
from aro_robocop_goto_as.world.model import Box, Cylinder, Sphere

TABLE = """<?xml version="1.0"?>
<robot name="table">
  <link name="world"/>
  <joint name="stand" type="fixed"><parent link="world"/><child link="leg"/><origin xyz="1 0 0.25"/></joint>
  <link name="leg">
    <inertial><mass value="1"/></inertial>
    <visual><geometry><box size="9 9 9"/></geometry></visual>
    <collision><geometry><cylinder radius="0.05" length="0.5"/></geometry></collision>
  </link>
  <joint name="hinge" type="revolute"><parent link="leg"/><child link="top"/>
    <origin xyz="0 0 0.25" rpy="0 0 1.5707963267948966"/></joint>
  <link name="top">
    <collision name="board"><origin xyz="0.1 0 0.01"/><geometry><box size="1 0.5 0.02"/></geometry></collision>
    <collision><geometry><sphere radius="0.1"/></geometry></collision>
  </link>
  <gazebo reference="top"><material>Gazebo/Wood</material></gazebo>
</robot>
"""
AT = Pose3D((2.0, 3.0, 0.0))


def test_collisions_of_a_urdf_are_placed_by_its_joints_at_zero():
    model = requested_model("desk", TABLE, "", AT, "w.world")
    shapes = {o.name: (o.geometry, o.pose.position) for o in model.obstacles}
    assert shapes == {
        "desk/leg/collision_0": (Cylinder(0.05, 0.5), pytest.approx((3.0, 3.0, 0.25))),
        "desk/top/board": (Box((1.0, 0.5, 0.02)), pytest.approx((3.0, 3.1, 0.51))),
        "desk/top/collision_1": (Sphere(0.1), pytest.approx((3.0, 3.0, 0.5))),
    }
    assert requested_model("", TABLE, "", AT, "w.world").name == "table"


def test_urdf_can_be_given_as_a_file(tmp_path):
    (tmp_path / "table.urdf").write_text(TABLE)
    assert len(requested_model("", "", str(tmp_path / "table.urdf"), AT, "w.world").obstacles) == 3


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ('radius="0.05"', 'radius="x"', "xml of the request:8: in 'table/leg/collision_0': <radius> is 'x', expected"),
        ("<sphere", "<capsule", "xml of the request:14: in 'table/top/collision_1': <capsule> in <geometry> is not"),
        ('link="leg"/><child', 'link="foot"/><child', "<pose relative_to='foot'> is not supported"),
        ('xyz="0.1 0 0.01"', 'xyz="0.1 0"', "xml of the request:13: in 'table/top/board': <pose> is '0.1 0 0 0 0'"),
        ('<link name="top">', "<link>", "in 'table/?': <link> has no name"),
        ('<parent link="world"/>', '<parent link="top"/>', "is relative to itself"),
    ],
)
def test_error_in_a_urdf_names_its_line(before, after, message):
    assert before in TABLE
    with pytest.raises(WorldError) as caught:
        requested_model("", TABLE.replace(before, after), "", AT, "w.world")
    assert message in str(caught.value)
