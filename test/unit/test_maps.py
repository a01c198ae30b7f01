"""Maps of map_server as worlds: interpreted as by map_server, with walls where cells are occupied."""

import math
import struct
import zlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image
from support import model_named

from aro_robocop_goto_as.errors import ParameterError, WorldError
from aro_robocop_goto_as.geometry import Pose2D, Pose3D, Twist2D, inverse
from aro_robocop_goto_as.params import SimParams
from aro_robocop_goto_as.physics.bullet import BulletEngine
from aro_robocop_goto_as.physics.kinematic import KinematicEngine
from aro_robocop_goto_as.raycast.beams import Fan
from aro_robocop_goto_as.raycast.cross_section import Slice
from aro_robocop_goto_as.robot.model import RobotSpec
from aro_robocop_goto_as.simulation.factory import make_simulator
from aro_robocop_goto_as.simulation.robots import robots_from
from aro_robocop_goto_as.world.grid_map.image import read_image
from aro_robocop_goto_as.world.grid_map.walls import outline
from aro_robocop_goto_as.world.load import find_world, load_world
from aro_robocop_goto_as.world.model import Obstacle, Walls, World

HEIGHT = 0.182  # [m] of the lidar
LAB = Fan(0.0, 6.28319 / 359, 360)
KEYS = {
    "image": "m.pgm",
    "resolution": "0.05",
    "origin": "[0, 0, 0]",
    "negate": "0",
    "occupied_thresh": "0.65",
    "free_thresh": "0.196",
}


def write_map(directory, pixels, **keys):
    """A map of grey pixels (rows, columns[, channels]) uint8, the first row on top; the path of its YAML file."""
    entries = {**KEYS, **keys}
    Image.fromarray(np.asarray(pixels, dtype=np.uint8)).save(str(directory / entries["image"]))
    return write_yaml(directory, "".join(f"{key}: {value}\n" for key, value in entries.items()))


def write_yaml(directory, text):
    path = directory / "m.yaml"
    path.write_text(text, encoding="utf-8")
    return str(path)


def room(columns=40, rows=30):
    """A room's pixels: free within walls one cell thick."""
    pixels = np.full((rows, columns), 254)
    pixels[[0, -1]] = pixels[:, [0, -1]] = 0
    return pixels


def office(cells=4000, cells_a_room=100):
    """Rooms of 5 x 5 m with doors and some boxes, at 0.05 m a cell."""
    random = np.random.default_rng(1)
    pixels = np.full((cells, cells), 254, dtype=np.uint8)
    for k in range(0, cells, cells_a_room):
        pixels[k : k + 3] = pixels[:, k : k + 3] = 0
    for i in range(0, cells, cells_a_room):
        for j in range(0, cells, cells_a_room):
            door, other_door = random.integers(15, 60, 2)
            pixels[i + door : i + door + 18, j : j + 3] = pixels[i : i + 3, j + other_door : j + other_door + 18] = 254
            for _ in range(4):
                (a, b), (h, w) = random.integers(8, cells_a_room - 14, 2), random.integers(1, 9, 2)
                pixels[i + a : i + a + h, j + b : j + b + w] = 0
    pixels[[0, -1]] = pixels[:, [0, -1]] = 0
    return pixels


# What the files mean


@pytest.mark.parametrize(
    ("keys", "expected"),
    [
        ({}, [100, 100, -1, -1, 0, 0]),
        ({"mode": "scale"}, [100, 100, 72, 59, 0, 0]),
        ({"mode": "raw"}, [0, 50, 120, -120, -46, -1]),
        ({"mode": "raw", "negate": 1}, [-1, -51, -121, 119, 45, 0]),
        ({"negate": 1}, [0, -1, -1, -1, 100, 100]),
        ({"negate": "true", "mode": "scale"}, [0, 0, 59, 73, 100, 100]),
        ({"occupied_thresh": 0.5}, [100, 100, 100, -1, 0, 0]),
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
        ((255, 255, 255, 255), "trinary", 0),
        ((0, 0, 0, 255), "trinary", 100),
        ((120, 120, 120, 0), "scale", -1),
        ((120, 120, 120, 1), "scale", 72),
        ((120, 120, 120, 254), "scale", 72),
        ((120, 120, 0), "scale", -1),
        ((100, 140, 255), "scale", 72),
        ((100, 21, 255), "raw", 60),
        ((100, 21, 5, 255), "raw", 42),
        ((120, 120, 120, 255), "scale", 72),
        ((0, 0, 0, 0), "scale", 100),
        ((0, 0, 0, 0), "trinary", 100),
    ],
)
def test_colours_are_averaged_and_alpha_counts_as_in_map_server(tmp_path, pixel, mode, expected):
    pixels = np.full((20, 20, len(pixel)), 1 if mode == "raw" else 255)
    pixels[-1, 0] = pixel
    world = load_world(write_map(tmp_path, pixels, image="m.png", mode=mode))
    assert world.occupancy.cells[0, 0] == expected


def test_plain_and_binary_pgm_and_png_of_8_and_16_bits_give_the_same_map(tmp_path):
    pixels = room().astype(np.uint8)
    worlds = [load_world(write_map(tmp_path, pixels)), load_world(write_map(tmp_path, pixels, image="m.png"))]
    (tmp_path / "m.pgm").write_text("P2\n# by hand\n40 30\n255\n" + " ".join(map(str, pixels.ravel())))
    worlds.append(load_world(write_map_over(tmp_path, "m.pgm")))
    Image.fromarray(pixels.astype(np.uint16) * 257).save(str(tmp_path / "m16.png"))
    worlds.append(load_world(write_map_over(tmp_path, "m16.png")))
    for world in worlds[1:]:
        assert (world.occupancy.cells == worlds[0].occupancy.cells).all()


PNM = {  # bytes of a 3 x 2 image: its pixels by SDL_image's arithmetic, rows from the top
    b"P1 3 2\n010 1#no\n10": [[255, 0, 255], [0, 0, 255]],
    b"P4\n3 2\n\x40\xdf": [[255, 0, 255], [0, 0, 255]],
    b"P2 3 2 255 0 1 2 # two\n 253 254 300": [[0, 1, 2], [253, 254, 255]],
    b"P2 3 2 100 0 1 50 77 99 100": [[0, 2, 127], [196, 252, 255]],
    b"P5\n#a\n3 2\n#b\n100\n\x00\x01\x32\x4d\x63\x64": [[0, 2, 127], [196, 252, 255]],
    b"P5 3 2 65535\n\x00\x00\x00\xff\x01\x01\xfe\xff\xff\x00\xff\xff": [[0, 0, 1], [254, 254, 255]],
    b"P3 3 2 255 " + b"7 8 9 " * 6: [[[7, 8, 9]] * 3] * 2,
    b"P6 3 2 255\n" + b"\x07\x08\x09" * 6: [[[7, 8, 9]] * 3] * 2,
    b"P6 3 2 15\n" + b"\x0f\x07\x00" * 6: [[[255, 119, 0]] * 3] * 2,
}


@pytest.mark.parametrize("content", PNM)
def test_every_kind_of_pnm_is_read_as_by_map_servers_image_loader(tmp_path, content):
    (tmp_path / "m.pnm").write_bytes(content)
    assert read_image(str(tmp_path / "m.pnm")).squeeze(-1 if content[1:2] not in b"36" else ()).tolist() == PNM[content]


@pytest.mark.parametrize(
    "content", [b"P5 3 0 255\n", b"P5 3 2 0\n123456", b"P5 3 2 99999\n123456", b"P2 3 2 255 1 2 3 a b c"]
)
def test_pnm_without_pixels_or_maximum_or_numbers_is_refused(tmp_path, content):
    (tmp_path / "m.pnm").write_bytes(content)
    with pytest.raises(WorldError, match="m.pnm: not a PGM or PNG image that can be read: "):
        read_image(str(tmp_path / "m.pnm"))


def test_raw_values_beyond_the_threshold_are_walls_and_negative_ones_unknown(tmp_path):
    pixels = np.full((30, 40), 1)
    pixels[5, 5:9], pixels[9, 5:9], pixels[13, 5:9] = 66, 120, 200
    world = load_world(write_map(tmp_path, pixels, mode="raw"))
    assert sorted(np.unique(world.occupancy.cells)) == [-56, 1, 66, 120]
    assert sorted(set(Slice(world, HEIGHT).segments[..., 1].ravel().round(3))) == [1.0, 1.05, 1.2, 1.25]


def write_map_over(directory, image):
    """Write the YAML file of an existing image."""
    return write_yaml(directory, "".join(f"{key}: {value}\n" for key, value in {**KEYS, "image": image}.items()))


def test_unknown_cells_are_not_walls(tmp_path):
    pixels = np.full((40, 40), 205)
    pixels[5:35, 5:35] = 254
    world = load_world(write_map(tmp_path, pixels))
    assert (world.occupancy.cells == -1).sum() == 700
    assert len(Slice(world, HEIGHT).segments) == 0


def test_origin_with_yaw_rotates_the_walls(tmp_path):
    world = load_world(write_map(tmp_path, room(), origin=f"[1, 2, {math.pi / 2}]"))
    cut = Slice(world, HEIGHT).segments
    assert cut[..., 0].min() == pytest.approx(1.0 - 30 * 0.05) and cut[..., 0].max() == pytest.approx(1.0)
    assert cut[..., 1].min() == pytest.approx(2.0) and cut[..., 1].max() == pytest.approx(2.0 + 40 * 0.05)


def test_robot_spawns_at_zero_in_map_or_at_the_nearest_free_place(tmp_path):
    assert load_world(write_map(tmp_path, room(), origin="[-1, -0.7, 0]")).spawn == Pose2D()
    moved = load_world(write_map(tmp_path, room(), origin="[1, -0.7, 0]")).spawn
    assert (moved.x, moved.y) == (pytest.approx(1.375), pytest.approx(0.0, abs=0.03))
    narrow = load_world(write_map(tmp_path, room(9, 9))).spawn
    assert (narrow.x, narrow.y) == (pytest.approx(0.225), pytest.approx(0.225))


def test_robot_starts_in_a_known_cell_with_room_for_its_model_or_not_at_all(tmp_path):
    pixels = np.zeros((80, 80))
    pixels[36:44] = 254  # a corridor 0.4 m wide along x, which leads out of the map
    pixels[20:60, 60:78] = 254  # and a room at its end, from x 1 to x 1.9
    world = load_world(write_map(tmp_path, pixels, origin="[-2, -2, 0]"))
    assert robots_from(SimParams().spawn_params(), world, model_named)[0].spawn.x < 2.0
    wide = [robot.spawn for robot in robots_from(SimParams(model="waffle").spawn_params(), world, model_named)]
    assert all(1.22 <= spawn.x <= 1.68 and abs(spawn.y) <= 0.78 for spawn in wide)
    pixels[20:60, 60:78] = 0
    pixels[36:44] = 254
    with pytest.raises(ParameterError, match="no room for a robot"):
        robots_from(
            SimParams(model="waffle").spawn_params(),
            load_world(write_map(tmp_path, pixels, origin="[-2, -2, 0]")),
            model_named,
        )


def test_several_robots_start_in_known_cells_only(tmp_path):
    pixels = np.full((60, 60), 205)
    pixels[20:40, 20:40] = 254  # a square of 1 m in the middle
    world = load_world(write_map(tmp_path, pixels, origin="[-1.5, -1.5, 0]"))
    robots = robots_from(SimParams(robots="3").spawn_params(), world, model_named)
    assert all(max(abs(robot.spawn.x), abs(robot.spawn.y)) <= 0.5 for robot in robots)
    with pytest.raises(ParameterError, match="room for . around its spawn"):
        robots_from(SimParams(robots="10").spawn_params(), world, model_named)


def test_unused_yaml_keys_are_listed(tmp_path):
    assert load_world(write_map(tmp_path, room(), author="me")).ignored == ("key 'author' of the map",)


def test_map_is_found_by_path_and_not_in_the_worlds_directory(tmp_path, monkeypatch):
    path = write_map(tmp_path, room())
    monkeypatch.chdir(tmp_path)
    assert find_world(path, "worlds") == path and find_world("m.yaml", "worlds") == "m.yaml"


# Walls


def edges_one_by_one(occupied):
    """Every cell edge between an occupied and another cell, as a set of ((x, y), (x, y)) in cells."""
    rows, columns = occupied.shape
    found = set()
    for row in range(rows):
        for column in range(columns):
            sides = {
                (0, -1): ((0, 0), (1, 0)),
                (0, 1): ((0, 1), (1, 1)),
                (-1, 0): ((0, 0), (0, 1)),
                (1, 0): ((1, 0), (1, 1)),
            }
            for (dx, dy), (start, end) in sides.items():
                x, y = column + dx, row + dy
                beyond = 0 <= x < columns and 0 <= y < rows and occupied[y, x]
                if occupied[row, column] and not beyond:
                    found.add(((column + start[0], row + start[1]), (column + end[0], row + end[1])))
    return found


@given(st.integers(1, 7), st.integers(1, 7), st.data())
def test_outline_is_all_edges_of_occupied_regions_in_maximal_segments(rows, columns, data):
    occupied = np.array(data.draw(st.lists(st.booleans(), min_size=rows * columns, max_size=rows * columns)))
    occupied = occupied.reshape(rows, columns)
    pieces = []
    segments = outline(occupied)
    for (x, y), (x_end, y_end) in segments.astype(int).tolist():
        along = range(x, x_end) if y == y_end else range(y, y_end)
        pieces += [((k, y), (k + 1, y)) if y == y_end else ((x, k), (x, k + 1)) for k in along]
    assert len(pieces) == len(set(pieces)) and set(pieces) == edges_one_by_one(occupied)
    level = [tuple(map(tuple, s.tolist())) for s in segments if s[0, 1] == s[1, 1]]
    assert not {start for start, _ in level} & {end for _, end in level}, "two pieces of one wall"


@given(st.integers(0, 10**6))
def test_scan_hits_in_an_extruded_map_fall_on_occupied_cells(tmp_path_factory, seed):
    random = np.random.default_rng(seed)
    pixels = np.where(random.random((60, 80)) < 0.03, 0, np.where(random.random((60, 80)) < 0.1, 205, 254))
    pixels[20:40, 20:40] = 254
    directory = tmp_path_factory.getbasetemp()
    world = load_world(write_map(directory, pixels, origin="[-1.3, 0.4, 0.3]"))
    occupancy, pose = world.occupancy, world.spawn
    distances = LAB.cast(np.array([[pose.x, pose.y, 0.0]]), Slice(world, HEIGHT))[0]
    angles = (6.28319 / 359 * np.arange(360))[np.isfinite(distances)]
    distances = distances[np.isfinite(distances)]
    assert len(distances) > 100
    hits = np.array([pose.x, pose.y]) + distances[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    grid = inverse(occupancy.origin)
    turn = np.array([[math.cos(grid.yaw), -math.sin(grid.yaw)], [math.sin(grid.yaw), math.cos(grid.yaw)]])
    cells = (hits @ turn.T + [grid.x, grid.y]) / occupancy.resolution
    near = [np.floor(cells + shift) for shift in ((1e-6, 1e-6), (1e-6, -1e-6), (-1e-6, 1e-6), (-1e-6, -1e-6))]
    framed = np.pad(occupancy.cells, 1, constant_values=-1)
    on_wall = [framed[c[:, 1].astype(int) + 1, c[:, 0].astype(int) + 1] == 100 for c in near]
    assert np.any(on_wall, axis=0).all()


@pytest.mark.parametrize("drive", ["wheels", "kinematic"])
def test_robot_is_stopped_by_the_walls_of_a_map(tmp_path, burger, drive):
    world = load_world(write_map(tmp_path, room(60, 60), origin="[-1.5, -1.5, 0]"))
    sim = make_simulator(SimParams(drive=drive, cmd_vel_timeout=0.0), world, [RobotSpec("", burger, Pose2D(1.0, 0.5))])
    sim.command(Twist2D(0.2))
    for _ in range(240 * 4):
        sim.step({})
    assert 1.2 < sim.world_from_footprint().x < 1.45 and sim.touching()
    sim.close()


# Big maps


@pytest.fixture(scope="module")
def big(tmp_path_factory):
    directory = tmp_path_factory.mktemp("big")
    return load_world(write_map(directory, office(), origin="[-100, -100, 0]"))


def free_poses(world, count, seed=2):
    random, poses = np.random.default_rng(seed), []
    origin, cells = world.occupancy.origin, world.occupancy.cells
    while len(poses) < count:
        row, column = random.integers(4, 3996, 2)
        if (cells[row - 3 : row + 4, column - 3 : column + 4] == 0).all():
            poses.append([origin.x + column * 0.05, origin.y + row * 0.05, random.uniform(-3, 3)])
    return np.array(poses)


def test_map_of_4000_by_4000_cells_has_less_than_80000_wall_segments(big):
    (walls,) = [o.geometry for o in big.obstacles if isinstance(o.geometry, Walls)]
    assert big.occupancy.cells.shape == (4000, 4000)
    assert (big.occupancy.cells == 100).sum() > 900_000
    assert 20_000 < len(walls.segments) < 80_000


def test_scan_in_a_big_map_equals_a_scan_of_all_its_walls(big):
    cut = Slice(big, HEIGHT)
    poses = free_poses(big, 5)
    seen = LAB.cast(poses, cut, reach=10.0)
    endless = LAB.cast(poses[:1], cut)
    cut.tiles = None
    every = LAB.cast(poses, cut)
    np.testing.assert_array_equal(seen, np.where(every <= 10.0, every, np.inf))
    np.testing.assert_array_equal(endless, every[:1])


def test_scan_in_a_big_map_examines_only_nearby_walls(big):
    cut, tried = Slice(big, HEIGHT), []
    for pose in free_poses(big, 100):
        LAB.cast(pose[None, :], cut, reach=10.0)
        tried.append((cut.tiles.segment_marks == cut.tiles.struct.mark).sum())
    assert sum(tried) / 100 < 1000 < len(cut.segments) / 40


@pytest.mark.parametrize(
    "fan", [LAB, Fan(-2.0, 0.013, 300), Fan(1.0, 0.05, 200), Fan(3.0, 1.0, 1), Fan(-9.0, 0.1, 190)]
)
def test_grid_index_does_not_change_the_scan(fan):
    random = np.random.default_rng(4)
    starts = random.uniform(-12.0, 12.0, (3000, 1, 2))
    segments = np.concatenate([starts, starts + random.uniform(-0.5, 0.5, (3000, 1, 2))], axis=1)
    segments[:3] = [[[-1e4, 11.0], [1e4, 11.0]], [[-30.0, -11.5], [30.0, -11.0]], [[0.3, -20.0], [0.3, 20.0]]]
    segments[:, :, 0] += np.where(np.abs(segments[:, :, 0]) < 1.0, 5.0, 0.0)
    cut = Slice(World("w", (Obstacle("o", Pose3D(), Walls(segments, 1.0)),), Pose2D(), (), ""), HEIGHT)
    assert cut.tiles is not None
    poses = np.column_stack([random.uniform(-13, 13, (20, 2)), random.uniform(-10, 10, 20)])
    found = {reach: fan.cast(poses, cut, reach=reach) for reach in (0.7, 5.0, math.inf)}
    cut.tiles = None
    every = fan.cast(poses, cut)
    for reach, seen in found.items():
        np.testing.assert_array_equal(seen, np.where(every <= reach, every, np.inf))


def test_both_engines_stop_the_robot_at_a_wall_of_a_big_map(big, burger):
    ahead = Fan(-0.25, 0.01, 51)
    poses = free_poses(big, 300) * [1.0, 1.0, 0.0]
    seen = ahead.cast(poses, Slice(big, HEIGHT), reach=10.0) * np.cos(-0.25 + 0.01 * np.arange(51))
    facing_a_wall = (np.ptp(np.minimum(seen, 9.0), axis=1) < 1e-6) & (seen[:, 25] > 0.5) & (seen[:, 25] < 1.5)
    (x, y, _), distance = poses[facing_a_wall][0], seen[facing_a_wall][0, 25]
    for drive in (BulletEngine(big, 240, 20, 1.0), KinematicEngine(big, 240, 0.105)):
        robot = drive.add_robot(burger, Pose2D(x, y))
        drive.set_wheel_speeds(robot, (6.0, 6.0))
        for _ in range(240 * 8):
            drive.step()
        assert distance - 0.15 < drive.state(robot).world_from_footprint.x - x < distance - 0.03
        assert drive.touching(robot)
        drive.close()


@pytest.mark.parametrize("header", ["P5", "P2\n# written by hand\n"])
def test_pgm_with_exactly_the_pixels_its_header_claims_is_read(tmp_path, header):
    pixels = room().astype(np.uint8)
    body = pixels.tobytes() if header == "P5" else " ".join(map(str, pixels.ravel())).encode()
    (tmp_path / "m.pgm").write_bytes(f"{header} 40 30 255\n".encode() + body)
    assert load_world(write_map_over(tmp_path, "m.pgm")).occupancy.cells.shape == (30, 40)


# What is refused


def yaml_of(**changed):
    return "".join(f"{key}: {value}\n" for key, value in {**KEYS, **changed}.items())


BROKEN = {  # case: (text of the YAML, line of the error or None, what the message must name)
    "not YAML": ("image: [m.pgm\nresolution: 1\n", 2, ["YAML"]),
    "a list": ("- m.pgm\n", 1, ["image, resolution, origin"]),
    "empty": ("", 1, ["image, resolution, origin"]),
    "keys missing": ("image: m.pgm\nresolution: 0.05\n", None, ["no origin, negate", "occupied_thresh"]),
    "image missing": (yaml_of(image="none.pgm"), 1, ["none.pgm", "no file"]),
    "image not one": (yaml_of(image="text.pgm"), None, ["text.pgm", "PGM or PNG"]),
    "image cut short": (yaml_of(image="cut.png"), None, ["cut.png", "PGM or PNG"]),
    "image a photograph": (yaml_of(image="m.jpg"), None, ["m.jpg", "JPEG", "PGM, PNG"]),
    "no resolution": (yaml_of(resolution="0"), 2, ["resolution is '0'", "greater than 0"]),
    "resolution in words": (yaml_of(resolution="5 cm"), 2, ["resolution is '5 cm'", "metres per cell"]),
    "origin without yaw": (yaml_of(origin="[0, 0]"), 3, ["origin is [0, 0], expected three numbers [x, y, yaw]"]),
    "origin in words": (yaml_of(origin="[0, left, 0]"), 3, ["origin is [0, left, 0], expected three numbers"]),
    "origin of one number": (yaml_of(origin="0"), 3, ["origin is '0', expected three numbers"]),
    "origin within a list": (yaml_of(origin="[[0, 0, 0]]"), 3, ["origin is [a sequence], expected three numbers"]),
    "origin by names": (yaml_of(origin="{x: 0, y: 0, yaw: 0}"), 3, ["origin is a mapping, expected three numbers"]),
    "origin without end": (yaml_of(origin=str([0] * 99)), 3, ["origin is a sequence, expected three numbers"]),
    "origin not finite": (yaml_of(origin="[0, .nan, 0]"), 3, ["origin", "[x, y, yaw]"]),
    "negate unclear": (yaml_of(negate="maybe"), 4, ["negate is 'maybe'", "0 or 1"]),
    "threshold in percent": (yaml_of(occupied_thresh="65"), 5, ["occupied_thresh is '65'", "from 0 to 1"]),
    "thresholds crossed": (yaml_of(free_thresh="0.7"), 6, ["free_thresh is '0.7'", "occupied_thresh, which is 0.65"]),
    "unknown mode": (yaml_of(mode="ternary"), 7, ["mode is 'ternary'", "trinary or scale or raw"]),
    "no room for a robot": (yaml_of(image="full.pgm"), None, ["no free place"]),
}


@pytest.mark.parametrize("case", BROKEN)
def test_broken_map_is_refused_with_file_line_and_key(tmp_path, case):
    text, line, named = BROKEN[case]
    for name, pixels in {"m.pgm": room(), "m.jpg": room(), "full.pgm": np.zeros((9, 9)), "cut.png": room()}.items():
        Image.fromarray(pixels.astype(np.uint8)).save(str(tmp_path / name))
    (tmp_path / "text.pgm").write_text("no image")
    (tmp_path / "cut.png").write_bytes((tmp_path / "cut.png").read_bytes()[:60])
    path = write_yaml(tmp_path, text)
    with pytest.raises(WorldError) as caught:
        load_world(path)
    message = str(caught.value)
    assert message.startswith(f"{path}:{line}: " if line else str(tmp_path))
    assert [word for word in named if word not in message] == []


CLAIMS = {  # file: (content, claim of the header and expectation in the message)
    "beyond.pgm": (b"P5 100000 100000 255\n0", "too large an image (.*10000000000 pixels.*); expected no more than "),
    "binary.pgm": (b"P5 9000 9000 255\n0", "9000 x 9000 pixels, expected no more than the 1 that the file can hold"),
    "wide.pgm": (b"P5 20 20 65535\n" + bytes(799), "20 x 20 pixels, expected no more than the 399 that"),
    "cut.pgm": (b"P5 20 20 255\n" + bytes(399), "20 x 20 pixels, expected no more than the 399 that"),
    "plain.pgm": (b"P2 9000 9000 255\n1 2 3", "9000 x 9000 pixels, expected no more than the 3 that"),
    "short.pgm": (b"P2 20 20 255\n" + b"254 " * 399, "20 x 20 pixels, expected no more than the 399 that"),
    "empty.pgm": (b"P2 20 20 255", "20 x 20 pixels, expected no more than the 0 that"),
}


@pytest.mark.parametrize("name", CLAIMS)
def test_image_that_claims_more_than_its_file_holds_is_refused_before_memory_is_allocated(tmp_path, name, monkeypatch):
    def loaded(_image):
        raise AssertionError("the pixels were decoded")

    content, claim = CLAIMS[name]
    (tmp_path / name).write_bytes(content)
    monkeypatch.setattr(Image.Image, "load", loaded)
    with pytest.raises(WorldError, match=f"^{tmp_path}/{name}: the header claims {claim}"):
        load_world(write_map_over(tmp_path, name))


def test_png_that_claims_more_than_its_file_can_hold_is_refused(tmp_path):
    Image.fromarray(room().astype(np.uint8)).save(str(tmp_path / "m.png"))
    content = bytearray((tmp_path / "m.png").read_bytes())
    content[16:24] = struct.pack(">II", 9000, 9000)
    content[29:33] = struct.pack(">I", zlib.crc32(bytes(content[12:29])))
    (tmp_path / "m.png").write_bytes(bytes(content))
    with pytest.raises(WorldError, match="m.png: the header claims 9000 x 9000 pixels, expected no more than the "):
        load_world(write_map_over(tmp_path, "m.png"))
