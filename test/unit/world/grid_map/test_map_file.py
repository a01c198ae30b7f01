"""Maps of map_server are interpreted as by map_server."""

import numpy as np
import pytest
from map_files import room, write_map, write_yaml, yaml_of
from PIL import Image

from aro_robocop_goto_as.errors import WorldError
from aro_robocop_goto_as.world.load import load_world


@pytest.mark.parametrize(
    ("keys", "expected"),
    [
        ({}, [100, 100, -1, -1, 0, 0]),
        ({"mode": "scale"}, [100, 100, 72, 59, 0, 0]),
        ({"mode": "raw"}, [0, 50, 120, -120, -46, -1]),
        ({"mode": "raw", "negate": 1}, [-1, -51, -121, 119, 45, 0]),
        ({"negate": 1}, [0, -1, -1, -1, 100, 100]),
        ({"negate": "true", "mode": "scale"}, [0, 1, 60, 73, 100, 100]),
        ({"occupied_thresh": "5e-1"}, [100, 100, 100, -1, 0, 0]),
        ({"free_thresh": 0.4}, [100, 100, -1, -1, 0, 0]),
        ({"free_thresh": 0.5}, [100, 100, -1, 0, 0, 0]),
    ],
)
def test_grey_values_are_interpreted_as_by_map_server(tmp_path, keys, expected):
    pixels = np.concatenate([np.full((30, 12), 254), np.repeat([[0, 50, 120, 136, 210, 255]], 2, axis=1)])
    if keys.get("negate"):
        pixels[:30] = 0
    if keys.get("mode") == "raw":
        pixels[:30] = 254 if keys.get("negate") else 1
    world = load_world(write_map(tmp_path, pixels, **keys))
    assert world.occupancy.cells[0, ::2].tolist() == expected


@pytest.mark.parametrize(
    ("pixel", "mode", "expected"),
    [
        ((0, 0, 0), "trinary", 100),
        ((0, 90, 255), "trinary", -1),
        ((0, 0, 0, 255), "trinary", 100),
        ((120, 120, 120, 0), "scale", -1),
        ((120, 120, 120, 254), "scale", -1),
        ((120, 120, 1), "scale", 72),
        ((120, 120, 0), "scale", -1),
        ((100, 140, 255), "scale", 72),
        ((100, 21, 5, 255), "raw", 42),
        ((205, 205, 205), "scale", 1),
        ((90, 90, 90), "scale", 98),
        ((0, 0, 0, 0), "scale", 100),
        ((0, 0, 0, 0), "trinary", 100),
    ],
)
def test_colours_are_averaged_and_alpha_counts_as_in_map_server(tmp_path, pixel, mode, expected):
    pixels = np.full((20, 20, len(pixel)), 1 if mode == "raw" else 255)
    pixels[-1, 0] = pixel
    world = load_world(write_map(tmp_path, pixels, image="m.png", mode=mode))
    assert world.occupancy.cells[0, 0] == expected


@pytest.mark.parametrize(
    "image", ["/home/student/maps/m.pgm", "C:\\Users\\student\\m.pgm", "package://maps/m.pgm", "maps/m.pgm"]
)
def test_image_that_is_not_where_the_file_says_is_looked_for_beside_it_and_that_is_said(tmp_path, image):
    write_map(tmp_path, [[0, 255], [255, 255]])
    world = load_world(write_yaml(tmp_path, yaml_of(image=image)))
    assert world.occupancy.cells[::-1].tolist() == [[100, 0], [0, 0]]
    assert world.approximated == (f"there is no image {image}; m.pgm beside the map's file is used",)


def test_keys_of_other_programs_and_comments_in_another_encoding_are_ignored(tmp_path):
    (tmp_path / "m.yaml").write_bytes(yaml_of(costs="[]").encode() + "# zeď\n".encode("cp1250"))
    Image.fromarray(np.array([[254, 0]], np.uint8)).save(str(tmp_path / "m.pgm"))
    world = load_world(str(tmp_path / "m.yaml"))
    assert (world.occupancy.cells.tolist(), len(world.ignored)) == ([[0, 100]], 1)
    assert "costs" in world.ignored[0]


BROKEN = {  # case: (text of the YAML, what the message must name)
    "not YAML": ("image: [m.pgm\nresolution: 1\n", ["YAML"]),
    "too deep": ("image: " + 1000 * "[", ["nested too deeply"]),
    "a list": ("- m.pgm\n", ["image, resolution, origin"]),
    "keys missing": ("image: m.pgm\nresolution: 0.05\n", ["origin: missing", "negate: missing", "occupied_thresh"]),
    "image missing": (yaml_of(image="none.pgm"), ["none.pgm", "no file"]),
    "image not one": (yaml_of(image="text.pgm"), ["text.pgm", "PGM, PNG or BMP"]),
    "image a photograph": (yaml_of(image="m.jpg"), ["m.jpg", "JPEG", "PGM, PNG or BMP"]),
    "no resolution": (yaml_of(resolution="0"), ["resolution: expected at least 1e-09, got 0.0"]),
    "origin without yaw": (yaml_of(origin="[0, 0]"), ["origin: expected a list of 3 numbers, got [0, 0]"]),
    "origin out of range": (yaml_of(origin="[0, 1e300, 0]"), ["origin: expected at most 1e+06, got 1e+300"]),
    "negate unclear": (yaml_of(negate="maybe"), ["negate: expected true or false, got 'maybe'"]),
    "threshold in percent": (yaml_of(occupied_thresh="65"), ["occupied_thresh: expected at most 1, got 65.0"]),
    "thresholds crossed": (
        yaml_of(free_thresh="0.7"),
        ["free_thresh: expected at most occupied_thresh, 0.65, got"],
    ),
    "unknown mode": (yaml_of(mode="ternary"), ["mode: expected one of trinary, scale, raw, got 'ternary'"]),
}


@pytest.mark.parametrize("case", BROKEN)
def test_broken_map_is_refused_with_file_key_and_value(tmp_path, case):
    text, named = BROKEN[case]
    for name, pixels in {"m.pgm": room(), "m.jpg": room()}.items():
        Image.fromarray(pixels.astype(np.uint8)).save(str(tmp_path / name))
    (tmp_path / "text.pgm").write_text("no image")
    path = write_yaml(tmp_path, text)
    with pytest.raises(WorldError) as caught:
        load_world(path)
    message = str(caught.value)
    assert message.startswith(str(tmp_path))
    assert [word for word in named if word not in message] == []
