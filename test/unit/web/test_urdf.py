"""A robot's description -> shapes."""

import os

import numpy as np
import pytest
from support import ROOT

from aro_robocop_goto_as.errors import RobotModelError
from aro_robocop_goto_as.web.scene import BODY, BOX, CYLINDER
from aro_robocop_goto_as.web.urdf import read_links

URDF = """<robot name="r"><!-- a comment -->
  <material name="blue"><color rgba="0 0 1 0.5"/></material>
  <link name="base">
    <visual><origin xyz="1 2 3"/><geometry><box size="1 2 3"/></geometry><material name="blue"/></visual>
    <visual><geometry><!-- none --><cylinder radius="0.5" length="2"/></geometry></visual>
    <visual><geometry><mesh filename="package://nowhere/mesh.stl"/></geometry></visual></link>
  <link name="empty"/></robot>"""


def test_a_description_is_read_with_its_colours_and_without_meshes_that_are_not_there():
    links = read_links(URDF)
    assert list(links) == ["base"] and links["base"].kind == BODY
    (box, where), (cylinder, _) = links["base"].parts
    assert (box.kind, box.size, box.color, box.opacity) == (BOX, (1.0, 2.0, 3.0), (0, 0, 255), 0.5)
    assert where.position == (1.0, 2.0, 3.0)
    assert (cylinder.kind, cylinder.size) == (CYLINDER, (1.0, 1.0, 2.0))


@pytest.mark.parametrize(
    "urdf, reason",
    [
        ("", "not well-formed XML"),
        ("<robot", "not well-formed XML"),
        ("<sdf/>", "expected <robot>, got <sdf>"),
        (URDF.replace("1 2 3", "1 2"), "robot_description"),
        (URDF.replace('"0.5"', '"wide"'), "robot_description"),
    ],
)
def test_what_is_no_description_is_refused_with_the_reason(urdf, reason):
    with pytest.raises(RobotModelError, match=reason):
        read_links(urdf)


def test_the_descriptions_of_all_models_are_drawn():
    for name in os.listdir(os.path.join(ROOT, "urdf")):
        with open(os.path.join(ROOT, "urdf", name)) as stream:
            links = read_links(stream.read())
        assert sum(len(link.parts) for link in links.values()) >= 10, name
        assert all(np.isfinite(shape.size).all() for link in links.values() for shape, _ in link.parts)
