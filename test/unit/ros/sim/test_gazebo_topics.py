"""What /gazebo/model_states and /gazebo/link_states hold, and that their types are gazebo_msgs' to a subscriber."""

import math
from io import BytesIO

import pytest
from geometry_msgs.msg import Twist
from support import driven

from aro_robocop_goto_as.errors import FrameError, WorldError
from aro_robocop_goto_as.geometry import Pose2D, Pose3D, Twist2D
from aro_robocop_goto_as.reading import parse_xml
from aro_robocop_goto_as.ros.sim import gazebo_topics
from aro_robocop_goto_as.world.edit import with_model, with_model_at
from aro_robocop_goto_as.world.sdf.reader import read_model

BOX = b"""<sdf version="1.6"><model name="box"><static>1</static><link name="l"><collision name="c"><geometry><box>
<size>1 1 1</size></box></geometry></collision></link></model></sdf>"""


@pytest.mark.parametrize("name", ["ModelStates", "LinkStates"])
def test_types_have_gazebos_names_and_md5sums(name):
    kind = gazebo_topics.message_type(name)
    assert kind._type == f"gazebo_msgs/{name}"
    assert kind._md5sum == "48c080191eb15c41858319b4d8a609c2"


def test_states_hold_models_robots_and_their_wheels_in_the_world(simulator):
    sim = simulator("stage_2", Pose2D(1.0, -1.0, math.pi / 2.0), drive="kinematic", max_linear_acceleration=1e3)
    sim.command(Twist2D(0.2, 0.0))
    for _ in range(24):
        sim.advance({})
    models = {name: (pose, twist) for name, pose, twist in gazebo_topics.models(sim)}
    assert set(models) == {*sim.world.models, "robot_1"}
    pose, twist = models["robot_1"]
    assert pose.position == pytest.approx((1.0, -0.98, 0.0), abs=1e-9)
    assert (twist.linear.x, twist.linear.y) == pytest.approx((0.0, 0.2), abs=1e-9)
    links = {name: pose for name, pose, _ in gazebo_topics.links(sim)}
    assert links["robot_1::wheel_left_link"].position == pytest.approx((0.92, -0.98, 0.033), abs=1e-9)
    assert links["robot_1::wheel_right_link"].position == pytest.approx((1.08, -0.98, 0.033), abs=1e-9)
    content = BytesIO()
    kind = gazebo_topics.message_type("ModelStates")
    gazebo_topics.to_message(kind, gazebo_topics.models(sim)).serialize(content)
    assert b"robot_1" in content.getvalue()


def test_what_was_spawned_comes_after_the_robot_and_what_was_moved_does_not(simulator):
    sim = simulator("empty", drive="kinematic")
    box = parse_xml(BOX, "box", WorldError)
    sim.change_world(with_model(sim.world, read_model(box, "goal", Pose3D((1.0, 0.0, 0.0)))))
    sim.change_world(with_model_at(sim.world, "ground_plane", Pose3D()))
    names = ["ground_plane", "robot_1", "goal"]
    assert [name for name, _, _ in gazebo_topics.models(sim)] == names
    links = [name.partition("::")[0] for name, _, _ in gazebo_topics.links(sim)]
    assert list(dict.fromkeys(links)) == names


@pytest.mark.parametrize(
    "reference, expected",
    [("", (0.0, 0.2)), ("world", (0.0, 0.2)), ("robot_1", (0.0, 0.0)), ("robot_2", (0.3, 0.0))],
)
def test_velocity_of_a_model_is_in_the_axes_of_its_reference(simulator, reference, expected):
    # Both face along y; the second one backs up.
    ahead, aside = Pose2D(0.0, 0.0, math.pi / 2.0), Pose2D(2.0, 0.0, math.pi / 2.0)
    sim = simulator("empty", ahead, aside, drive="kinematic", max_linear_acceleration=1e3)
    sim.command(Twist2D(-0.1, 0.0), 1)
    driven(sim, Twist2D(0.2, 0.0), 0.1)
    states = gazebo_topics.models(sim)
    moving, frame = (gazebo_topics.state_of(name, states) for name in ("robot_1", reference))
    _, twist = gazebo_topics.relative(moving, frame)
    assert (twist.linear.x, twist.linear.y, twist.angular.z) == pytest.approx((*expected, 0.0), abs=1e-6)


@pytest.mark.parametrize(
    "known, told",
    [
        (["ground_plane", "robot_1"], "model [tables] does not exist; there are: ground_plane, robot_1"),
        (["table", *(f"wall_{i}" for i in range(9))], "model [tables] does not exist; did you mean table?"),
        ([f"wall_{i}" for i in range(9)], "model [tables] does not exist"),
    ],
)
def test_an_unknown_name_is_refused_in_a_line_that_rosservice_does_not_wrap(known, told):
    states = [(name, Pose3D(), Twist()) for name in known]
    with pytest.raises(FrameError) as refused:
        gazebo_topics.state_of("tables", states)
    assert str(refused.value) == told
