"""Worlds are found by name or path; twelve typical broken files are each refused with a message of its own."""

import re
from pathlib import Path

import pytest
from map_files import room, write_map
from support import ROOT

from aro_robocop_goto_as.errors import WorldError
from aro_robocop_goto_as.world.load import find_world, load_world

WORLDS = Path(ROOT, "worlds")
WORLD = '<?xml version="1.0"?>\n<sdf version="1.6">\n<world name="w">\n{}\n</world>\n</sdf>\n'
WALL = """<model name="wall">
  <static>true</static>
  <link name="link">
    <collision name="collision">
      {}
    </collision>
  </link>
</model>"""
MAP = """image: map.pgm
resolution: 0.05
origin: [0.0, 0.0, 0.0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
"""
PGM = b"P5 20 20 255\n" + bytes([254] * 400)

BROKEN = {  # file: (content, pattern of the message after the file's path)
    "cut_off.world": (WORLD.format('<model name="wall">'), r":5: not well-formed XML: .*model.*world"),
    "entities.world": (
        '<!DOCTYPE sdf [<!ENTITY secret SYSTEM "file:///etc/passwd">]>\n' + WORLD[22:].format("&secret;"),
        r": '<!DOCTYPE sdf>' is not supported; expected a file without DOCTYPE and entities",
    ),
    "newer.sdf": (
        WORLD.format("").replace("1.6", "1.10"),
        r":2: SDF version '1.10' is not supported; supported: 1.4, .*1.7",
    ),
    "model_not_installed.world": (
        WORLD.format("<include>\n  <uri>model://cafe_table</uri>\n</include>"),
        r":4: 'model://cafe_table' was not found; looked for: .*models/cafe_table \(beside model_not_installed.world\)",
    ),
    "mesh_missing.world": (
        WORLD.format(WALL.format("<geometry><mesh><uri>model://house/meshes/house.dae</uri></mesh></geometry>")),
        r":8: in 'wall/link/collision': 'model://house/meshes/house.dae' was not found; looked for",
    ),
    "misspelt.world": (
        WORLD.format(WALL.format("<geometry><box><sise>1 1 1</sise></box></geometry>")),
        r":8: in 'wall/link/collision': <box> has no <size>",
    ),
    "negative.world": (
        WORLD.format(WALL.format("<geometry><sphere><radius>-0.5</radius></sphere></geometry>")),
        r":8: in 'wall/link/collision': <radius> is '-0.5', expected one finite number greater than 0",
    ),
    "comma.world": (
        WORLD.format(WALL.format("<pose>1,5 0 0 0 0 0</pose><geometry><box><size>1 1 1</size></box></geometry>")),
        r":8: in 'wall/link/collision': <pose> is '1,5 0 0 0 0 0', expected 6 finite numbers",
    ),
    "no_image.yaml": (
        MAP.replace("map.pgm", "flat.pgm"),
        r":1: image is 'flat.pgm', expected a PGM, PNG or BMP file, but there is no file .*flat.pgm",
    ),
    "no_origin.yaml": (
        MAP.replace("origin", "orgin"),
        r": no origin; expected the keys image, resolution, origin, negate, ",
    ),
    "in_degrees.yaml": (
        MAP.replace("0.0, 0.0, 0.0", "0.0, 0.0, 90°"),
        r":3: origin is \[0.0, 0.0, 90°\], expected three numbers .*rad\]",
    ),
}


STAGE = {
    "maze.world": '# a maze\ninclude "pioneer.inc"\nresolution 0.02\n',
    "blank.world": "\n" * 60000 + "window\n(\n size [ 600 700 ] )\n",
    "simple.world": 'define floorplan model\n(\n  gui_nose 0\n)\nfloorplan( bitmap "cave.png" size [16 16 1.5] )\n',
    "robot.world": "resolution 0.1\nposition( pose [ 0 0 0 0 ] )\n",
}


@pytest.mark.parametrize("name", STAGE)
def test_world_of_stage_is_named_as_such(tmp_path, name):
    (tmp_path / name).write_text(STAGE[name])
    with pytest.raises(WorldError, match=f"^{tmp_path}/{name}: a world of Stage; expected an SDF file"):
        load_world(str(tmp_path / name))


@pytest.mark.parametrize("text", ["define\n", "", "window", "\n  <!-- window ( -->\n<sdf/>", "hello (world)"])
def test_other_texts_are_not_taken_for_a_world_of_stage(tmp_path, text):
    (tmp_path / "w.world").write_text(text)
    with pytest.raises(WorldError) as caught:
        load_world(str(tmp_path / "w.world"))
    assert "Stage" not in str(caught.value)


def message_of(directory, name):
    (directory / "map.pgm").write_bytes(PGM)
    path = directory / name
    path.write_text(BROKEN[name][0], encoding="utf-8")
    with pytest.raises(WorldError) as caught:
        load_world(str(path))
    return str(caught.value)


@pytest.mark.parametrize("name", BROKEN)
def test_broken_file_is_refused_with_file_line_problem_and_expectation(tmp_path, name):
    message = message_of(tmp_path, name)
    assert re.match(re.escape(str(tmp_path / name)) + BROKEN[name][1], message), message
    assert "\n" not in message


def test_each_broken_file_gets_a_different_message(tmp_path):
    messages = [message_of(tmp_path, name).partition(name)[2] for name in BROKEN]
    assert len(set(messages)) == len(BROKEN) == 11


def test_bare_name_is_looked_up_in_the_worlds_directory():
    assert find_world("stage_4", str(WORLDS)) == str(WORLDS / "stage_4.sdf")


def test_file_name_with_an_extension_is_a_path(tmp_path, monkeypatch):
    (tmp_path / "mine.world").touch()
    assert find_world(str(tmp_path / "mine.world"), str(WORLDS)) == str(tmp_path / "mine.world")
    monkeypatch.chdir(tmp_path)
    assert find_world("mine.world", str(WORLDS)) == "mine.world"


@pytest.mark.parametrize("name", ["hause", "./stage_4", "stage_4.sdf", ""])
def test_unknown_world_is_refused_with_the_known_names(name):
    with pytest.raises(WorldError) as caught:
        find_world(name, str(WORLDS))
    assert f"'{name}'" in str(caught.value)
    assert "empty, maze_1, stage_1, stage_2, stage_3, stage_4, world" in str(caught.value)


def test_missing_worlds_directory_is_reported_as_having_none(tmp_path):
    with pytest.raises(WorldError, match="none"):
        find_world("stage_4", str(tmp_path / "missing"))


def test_map_is_found_by_path_and_not_in_the_worlds_directory(tmp_path, monkeypatch):
    path = write_map(tmp_path, room())
    monkeypatch.chdir(tmp_path)
    assert find_world(path, "worlds") == path and find_world("m.yaml", "worlds") == "m.yaml"
