"""Poses compose through models, links, frames and joints."""

import numpy as np
from sdf_files import SPHERE, collision, model, world_file

from aro_robocop_goto_as.geometry import Pose3D, rotation_matrix
from aro_robocop_goto_as.world.load import load_world

RELATIVE = "<pose relative_to='{}'>1 0 0 0 0 0</pose>"


def test_pose_relative_to_the_world_counts_from_the_world_at_any_depth(tmp_path):
    in_world = "<pose relative_to='world'>1 2 3 0 0 0</pose>"
    moved = "<pose>10 20 30 0 0 1</pose>"
    link = f'<link name="l">{in_world}{collision(SPHERE)}</link>'
    inner = f'<model name="in">{in_world}<link name="l">{collision(SPHERE)}</link></model>'
    include = f"<include><uri>model://ground_plane</uri>{in_world}</include>"
    found = load_world(
        world_file(tmp_path, f'<model name="m"><static>1</static>{moved}{link}{inner}{include}</model>', "1.8")
    )
    assert [o.pose for o in found.obstacles] == [Pose3D((1.0, 2.0, 3.0))] * 3


def test_poses_relative_to_what_is_beside_compose(tmp_path):
    quarter = "0 0 1.5707963267948966"
    frame = f'<frame name="f"><pose>1 0 0 {quarter}</pose></frame><frame name="g" attached_to="f"/>'
    link = f'<link name="a"><pose relative_to="b">1 0 0 0 0 0</pose>{collision(SPHERE)}</link>'
    other = f'<link name="b"><pose>0 0 0 {quarter}</pose>{collision(SPHERE, pose=RELATIVE.format("a"))}</link>'
    own = f'<link name="c"><pose>5 5 5 1 1 1</pose>{collision(SPHERE, pose=RELATIVE.format("__model__"))}</link>'
    links = model("", pose="").replace('<link name="l">\n\n</link>', link + other + own)
    body = frame + model(collision(SPHERE), "n", '<pose relative_to="g">2 0 0 0 0 0</pose>') + links
    found = {o.name: o.pose for o in load_world(world_file(tmp_path, body, "1.8")).obstacles}
    expected = {"n/l/c": (1, 2, 0), "m/a/c": (0, 1, 0), "m/b/c": (0, 2, 0), "m/c/c": (1, 0, 0)}
    assert set(found) == set(expected)
    for name, position in expected.items():
        np.testing.assert_allclose(found[name].position, position, atol=1e-12)
    np.testing.assert_allclose(rotation_matrix(found["m/c/c"].orientation), np.eye(3), atol=1e-12)


def test_poses_relative_to_joints_compose_as_in_a_urdf_that_gz_converted(tmp_path):
    # `gz sdf -p ROBOT.urdf` places each joint in its parent link, and the child link at the joint, by an empty <pose>.
    quarter = "0 0 1.5707963267948966"
    joints = (
        f'<joint name="j" type="fixed"><pose relative_to="a">1 0 0 {quarter}</pose><child>b</child></joint>'
        '<joint name="k" type="fixed"><pose>0 0 3 0 0 0</pose><child>b</child></joint>'
    )
    links = "".join(
        f'<link name="{name}"><pose relative_to="{to}"{pose}{collision(SPHERE)}</link>'
        for name, to, pose in (("b", "j", "/>"), ("c", "b", " degrees='false'>2 0 0 0 0 0</pose>"), ("d", "k", "/>"))
    )
    body = f'<model name="m"><static>1</static><link name="a"><pose>0 1 0 0 0 0</pose></link>{joints}{links}</model>'
    found = {o.name: o.pose for o in load_world(world_file(tmp_path, body, "1.8")).obstacles}
    for name, position in {"m/b/c": (1, 1, 0), "m/c/c": (1, 3, 0), "m/d/c": (1, 1, 3)}.items():
        np.testing.assert_allclose(found[name].position, position, atol=1e-12)
