"""What is sent to the browsers when groups of shapes change."""

import pytest

from aro_robocop_goto_as.geometry import Pose3D
from aro_robocop_goto_as.web.scene import BODY, BOX, PageScene, Visual

AWAY = Pose3D((1.0, 0.0, 0.0))


class Api:
    """Stands in for the scene of a viser server: names of the nodes that are there, and all that were added."""

    def __init__(self):
        self.nodes = []
        self.added = []

    def __getattr__(self, name):
        def add(node, *arguments, **options):
            self.nodes.append(node)
            self.added.append(Handle(self, node))
            return self.added[-1]

        return add


class Handle:
    def __init__(self, api, name):
        self.api, self.name = api, name

    def remove(self):
        self.api.nodes = [node for node in self.api.nodes if not (node + "/").startswith(self.name + "/")]


@pytest.fixture
def api():
    return Api()


@pytest.fixture
def scene(api):
    scene = PageScene(api)
    api.nodes, api.added = [], []
    return scene


def test_a_group_shows_its_shapes_and_nothing_that_it_held_before(api, scene):
    scene.show("world", {"a": (Visual(BOX), Pose3D()), "b": (Visual(BOX), Pose3D())})
    assert len(api.nodes) == 2
    scene.show("world", {"b": (Visual(BOX), Pose3D())})
    assert api.nodes == [api.added[1].name] and len(api.added) == 2
    scene.show("world", {})
    assert api.nodes == []


def test_a_shape_is_moved_only_when_its_pose_changes(api, scene):
    for pose in (Pose3D(), Pose3D((1e-6, 0.0, 0.0))):
        scene.show("world", {"a": (Visual(BOX), pose)})
    assert not hasattr(api.added[0], "position")
    scene.show("world", {"a": (Visual(BOX), AWAY)})
    assert api.added[0].position == (1.0, 0.0, 0.0) and len(api.added) == 1


def test_the_parts_of_a_body_move_and_go_with_it(api, scene):
    body = Visual(BODY, parts=((Visual(BOX), AWAY), (Visual(BOX), AWAY)))
    scene.show("robots", {"a": (body, Pose3D())})
    assert len(api.nodes) == 3 and scene.draws("robots")
    scene.show("robots", {})
    assert api.nodes == [] and not scene.draws("robots")
