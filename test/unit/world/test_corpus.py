"""A corpus of small worlds and maps that are built like other people's: corpus/NAME.yaml says what must happen to each.

A case has `body`, the content of a <world> in w.world (of SDF `version`, 1.6 if absent), or `files` with the path of
one of them in `load`, and `images`: rows of grey values, or of channels. What must happen is one of
- error: what the message must contain
- otherwise, each if given: obstacles (their names), ground [m], spawn [x, y, yaw], start [x, y] of a Burger near the
  spawn, ahead [x, y, yaw, distance] of a beam 0.182 m above the ground, cells of the map, first row on top.
  `ignored` and `different` hold a part of each entry of the lists that the log shows; absent: those lists are empty.
"""

from pathlib import Path

import numpy as np
import pytest
import yaml
from PIL import Image
from support import model_named

from aro_robocop_goto_as.errors import WorldError
from aro_robocop_goto_as.raycast.beams import Fan
from aro_robocop_goto_as.raycast.cross_section import CrossSection
from aro_robocop_goto_as.raycast.free_places import free_place
from aro_robocop_goto_as.world.load import load_world

CORPUS = sorted((Path(__file__).parent / "corpus").glob("*.yaml"))
WORLD = '<?xml version="1.0"?>\n<sdf version="{}">\n<world name="w">\n{}</world>\n</sdf>\n'
KEYS = "about body files load images version error ahead cells different ground ignored obstacles spawn start"


def written(case, folder):
    """Write a case's files; the path of the one to load."""
    files = {**case.get("files", {})}
    if "body" in case:
        files["w.world"] = WORLD.format(case.get("version", 1.6), case["body"])
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(text.encode())
    for name, rows in case.get("images", {}).items():
        Image.fromarray(np.array(rows, np.uint8)).save(str(folder / name))
    return str(folder / case.get("load", "w.world"))


def beam(world, x, y, yaw):
    walls = CrossSection(world, 0.182)
    return float(Fan(0.0, 1.0, 1).cast(np.array([[x, y, yaw]]), walls)[0, 0])


@pytest.mark.parametrize("path", CORPUS, ids=lambda path: path.stem)
def test_world_or_map_is_loaded_or_refused_as_it_must_be(path, tmp_path, monkeypatch):
    for variable in ("GAZEBO_MODEL_PATH", "GAZEBO_RESOURCE_PATH", "ROS_PACKAGE_PATH"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setenv("HOME", str(tmp_path))  # where Gazebo's downloaded models are
    case = yaml.safe_load(path.read_text())
    assert set(case) <= set(KEYS.split())
    file = written(case, tmp_path)
    if "error" in case:
        with pytest.raises(WorldError) as caught:
            load_world(file)
        assert [part for part in case["error"] if part not in str(caught.value)] == [], str(caught.value)
        return
    world = load_world(file)
    for key, found in (("ignored", world.ignored), ("different", world.approximated)):
        expected = case.get(key, [])
        assert (
            [part in entry for part, entry in zip(expected, found)] == [True] * len(expected) == [True] * len(found)
        ), found
    if "obstacles" in case:
        assert [obstacle.name for obstacle in world.obstacles] == case["obstacles"]
    assert world.ground == pytest.approx(case.get("ground", 0.0), abs=1e-9)
    if "spawn" in case:
        assert world.has_spawn and tuple(world.spawn) == pytest.approx(case["spawn"])
    if "start" in case:
        assert free_place(world, world.spawn, model_named("burger"))[:2] == pytest.approx(case["start"], abs=1e-6)
    if "ahead" in case:
        *origin, distance = case["ahead"]
        assert beam(world, *origin) == pytest.approx(distance, abs=1e-3)
    if "cells" in case:
        assert world.occupancy.cells[::-1].tolist() == case["cells"]
