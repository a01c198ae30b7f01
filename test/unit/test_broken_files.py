"""Twelve typical broken world and map files: each is refused with a message of its own."""

import re

import pytest

from aro_robocop_goto_as.errors import WorldError
from aro_robocop_goto_as.world.load import load_world

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
        r":4: 'model://cafe_table' was not found; looked for: .*models/cafe_table \(beside the file\)",
    ),
    "mesh_missing.world": (
        WORLD.format(WALL.format("<geometry><mesh><uri>model://house/meshes/house.dae</uri></mesh></geometry>")),
        r":8: in 'wall/link/collision': 'model://house/meshes/house.dae' was not found; looked for",
    ),
    "heightmap.world": (
        WORLD.format(WALL.format("<geometry><heightmap><uri>a.png</uri></heightmap></geometry>")),
        r":8: in 'wall/link/collision': <heightmap> in <geometry> is not supported; supported: box, cylinder, .*mesh",
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
        r":1: image is 'flat.pgm', expected a PGM or PNG file, but there is no file .*flat.pgm",
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
    assert len(set(messages)) == len(BROKEN) == 12
