"""The compiled caster: equal to the reference definition of a scan, independent of batching, free of memory errors."""

import math
import os
import subprocess
import sys
from pathlib import Path
from typing import List, Tuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from reference_beams import bounds, circles, cut_of, cuts, fans, lattice, poses, segments
from support import ROOT, model_named, world_named

from aro_robocop_goto_as import compiled
from aro_robocop_goto_as.errors import InstallationError
from aro_robocop_goto_as.geometry import Pose2D, Pose3D
from aro_robocop_goto_as.raycast import caster_library
from aro_robocop_goto_as.raycast.beams import Fan
from aro_robocop_goto_as.raycast.cross_section import Slice
from aro_robocop_goto_as.raycast.grid_index import Tiles
from aro_robocop_goto_as.raycast.scanners import Scanners, circles_at
from aro_robocop_goto_as.raycast.scene import Plane, Scene
from aro_robocop_goto_as.world.model import Box, Obstacle, World

Pose = Tuple[float, float, float]
NAME = compiled.file_name("caster")
SOURCE = os.path.join(ROOT, "src", "aro_robocop_goto_as", "raycast", "caster.c")
LAB = Fan(0.0, 6.28319 / 359, 360)


@given(fans, cuts, poses)
def test_every_beam_of_any_fan_matches_the_definition(fan: Fan, cut: Slice, pose: Pose) -> None:
    x, y, yaw = pose
    seen = fan.cast(np.array([pose]), cut)[0]
    for beam, distance in enumerate(seen.tolist()):
        least, greatest = bounds(cut, x, y, yaw + fan.angle_min + beam * fan.increment)
        assert least * (1.0 - 1e-7) - 1e-7 <= distance <= greatest * (1.0 + 1e-7) + 1e-7, f"beam {beam}"


@given(fans, cuts, poses, st.floats(0.0, 5.0))
def test_maximum_range_removes_only_returns_beyond_it(fan: Fan, cut: Slice, pose: Pose, max_range: float) -> None:
    every = fan.cast(np.array([pose]), cut)
    seen = fan.cast(np.array([pose]), cut, reach=max_range)
    np.testing.assert_array_equal(seen, np.where(every <= max_range, every, np.inf))


@given(fans, poses, st.data(), st.floats(0.01, 9.0), st.floats(0.3, 2.8), st.floats(0.01, 3.0), st.booleans())
def test_beam_aimed_at_the_end_of_a_segment_hits_it(
    fan: Fan, pose: Pose, data: st.DataObject, away: float, slant: float, length: float, left: bool
) -> None:
    beam = data.draw(st.integers(0, fan.samples - 1))
    angle = pose[2] + fan.angle_min + beam * fan.increment
    x, y = pose[0] + away * math.cos(angle), pose[1] + away * math.sin(angle)
    along = angle + (slant if left else -slant)
    segment = [[(x, y), (x + length * math.cos(along), y + length * math.sin(along))]]
    assert fan.cast(np.array([pose]), cut_of(np.array(segment), np.zeros((0, 3))))[0, beam] == pytest.approx(away)


@given(fans, segments, circles, poses, st.floats(0.5, 30.0), st.sampled_from([1.0, 8.0]))
def test_scan_with_a_grid_index_is_bit_identical_to_one_without(
    fan: Fan, walls: List[object], posts: List[object], pose: Pose, max_range: float, scale: float
) -> None:
    cut = cut_of(scale * np.array(walls, float), scale * np.array(posts, float))
    every = fan.cast(np.array([pose]), cut, reach=max_range)
    cut.tiles = Tiles(cut.segments)
    assert fan.cast(np.array([pose]), cut, reach=max_range).tobytes() == every.tobytes()


@given(lattice, lattice, st.integers(0, 7))
def test_beams_along_tile_borders_see_segments_on_the_border(x: float, y: float, eighth: int) -> None:
    walls = [((i, j), (i + 0.5, j)) for i in range(-3, 4) for j in range(-3, 4)]
    cut, yaw = cut_of(np.array(walls, float), np.zeros((0, 3))), eighth * math.pi / 4.0
    every = Fan(0.0, math.pi / 4.0, 8).cast(np.array([[x, y, yaw]]), cut)
    cut.tiles = Tiles(cut.segments)
    assert Fan(0.0, math.pi / 4.0, 8).cast(np.array([[x, y, yaw]]), cut).tobytes() == every.tobytes()


def test_mark_counter_restarts_at_its_limit() -> None:
    cut = cut_of(np.random.default_rng(1).uniform(-5.0, 5.0, (300, 2, 2)), np.zeros((0, 3)))
    expected = LAB.cast(np.zeros((1, 3)), cut)
    cut.tiles = Tiles(cut.segments)
    cut.tiles.struct.mark = 2**31 - 3
    for _ in range(5):
        np.testing.assert_array_equal(LAB.cast(np.zeros((1, 3)), cut), expected)
    assert cut.tiles.struct.mark == 3


@given(fans, st.lists(poses, min_size=1, max_size=6), st.lists(cuts, min_size=1, max_size=2), st.data())
def test_scanning_all_robots_at_once_is_bit_identical_to_one_at_a_time(
    fan: Fan, footprints: List[Pose], walls: List[Slice], data: st.DataObject
) -> None:
    robots = range(len(footprints))
    bodies = np.array(data.draw(st.lists(st.tuples(lattice, lattice, st.floats(0.05, 0.5)), max_size=9)))
    owners = np.array([i % len(footprints) for i in range(len(bodies))], np.int64)
    planes = [Plane(cut, bodies.reshape(-1, 3), owners) for cut in walls]
    plane_of = [data.draw(st.integers(0, len(planes) - 1)) for _ in robots]
    scene = Scene(planes, plane_of, np.array([data.draw(poses) for _ in robots]))
    scene.footprints[:] = footprints
    together = fan.scan(scene, robots, 5.0)
    order = data.draw(st.permutations(robots))
    assert fan.scan(scene, order, 5.0).tobytes() == together[order].tobytes()
    for robot in robots:
        assert fan.scan(scene, [robot], 5.0).tobytes() == together[robot].tobytes()


def test_robots_see_each_others_bodies_but_not_their_own() -> None:
    bodies, owners = np.array([[0.5, 0.0, 0.1], [0.5, 0.0, 0.2]]), np.array([0, 1], np.int64)
    scene = Scene([Plane(cut_of(np.zeros((0, 2, 2)), np.zeros((0, 3))), bodies, owners)], [0, 0], np.zeros((2, 3)))
    scene.footprints[:] = (0.0, 0.0, 0.0), (3.0, 0.0, math.pi)
    assert Fan(0.0, 1.0, 1).scan(scene, [0, 1]).tolist() == [[pytest.approx(2.3)], [pytest.approx(2.4)]]


def test_each_scanner_sees_world_and_robots_at_its_own_height() -> None:
    models = [model_named(name) for name in ("burger", "waffle", "burger")]
    low_box = Obstacle("box", Pose3D((2.0, 0.0, 0.07)), Box((1.0, 1.0, 0.14)))
    at = [Pose2D(0.0, 0.0), Pose2D(0.0, 2.0, -math.pi / 2), Pose2D(0.0, -2.0)]
    burgers_lidar, waffles_lidar = (model.scan_height for model in models[:2])
    assert waffles_lidar < 0.14 < burgers_lidar
    fan = Fan(0.0, math.pi / 180.0, 360)
    scans = Scanners(models, World("w", (low_box,), Pose2D(), (), "")).distances(fan, 10.0, at, [0, 1, 2], 0.0)
    assert np.isinf(scans[0, 0]), "the box is below a Burger's scanner"
    assert scans[1, 45] == pytest.approx(1.5 * math.sqrt(2.0), abs=0.2)
    assert np.isinf(scans[0, 90]), "a Waffle is below a Burger's scanner"
    (_, _, radius), (_, _, scanner_radius) = (
        *circles_at(models[0], waffles_lidar),
        *circles_at(models[0], burgers_lidar),
    )
    assert scans[1, 0] == pytest.approx(2.064 - math.sqrt(radius**2 - 0.032**2))
    assert scans[0, 270] == pytest.approx(2.0 - scanner_radius)


def test_moving_obstacles_are_updated_in_place_for_any_time() -> None:
    moved, fresh = Slice(world_named("stage_4"), 0.182), Slice(world_named("stage_4"), 0.182)
    array = moved.circles
    for time in (0.0, 1.3, 250.0, 0.4):
        moved.move(time)
        assert moved.circles is array and moved.circles.tobytes() == fresh.at(time).circles.tobytes()
    assert (fresh.at(1.3).circles != fresh.circles).any()


# What is refused


@pytest.mark.parametrize("angles", [(0.0, -0.1, 10), (0.0, math.nan, 10), (math.inf, 0.1, 10), (0.0, math.inf, 2)])
def test_fan_with_negative_increment_or_non_finite_angles_is_refused(angles: "tuple[float, float, int]") -> None:
    with pytest.raises(ValueError, match="^expected (increment > 0|finite angles)"):
        Fan(*angles)


ARRAYS = {
    "shape": (np.zeros((4, 2)), r"^footprints: expected shape \('any', 3\), got \(4, 2\)"),
    "dimensions": (np.zeros(3), r"^footprints: expected shape \('any', 3\), got \(3,\)"),
    "type": (np.zeros((4, 3), np.float32), "^footprints: expected a C-contiguous array of float64, got float32"),
    "order": (
        np.zeros((3, 4)).T,
        r"^footprints: expected a C-contiguous array of float64, got float64, strides \(8, 32\)",
    ),
    "list": ([[0.0] * 3], "^footprints: expected a C-contiguous array of float64, got list"),
}


@pytest.mark.parametrize("case", ARRAYS)
def test_array_of_wrong_shape_type_or_layout_is_refused_by_name(case: str) -> None:
    array, message = ARRAYS[case]
    with pytest.raises(ValueError, match=message):
        caster_library.address("footprints", array, (None, 3))  # type: ignore[arg-type]


def test_invalid_scenes_and_scans_are_refused() -> None:
    plane = Plane(cut_of(np.zeros((0, 2, 2)), np.zeros((0, 3))))
    scene = Scene([plane], [0, 0], np.zeros((2, 3)))
    for robot in (-1, 2, 2**40):
        with pytest.raises(ValueError, match="^robots: "):
            LAB.scan(scene, [0, robot])
    scene.footprints[1, 2] = np.nan
    with pytest.raises(ValueError, match="^poses: "):
        LAB.scan(scene, [0])
    with pytest.raises(ValueError, match="^plane_of: expected numbers from 0 to 0, got "):
        Scene([plane], [0, 1], np.zeros((2, 3)))
    with pytest.raises(ValueError, match=r"^mounts: expected shape \(2, 3\), got \(1, 3\)"):
        Scene([plane], [0, 0], np.zeros((1, 3)))
    with pytest.raises(ValueError, match="^owners: expected numbers from 0 to 0"):
        Scene([Plane(plane.walls, np.zeros((1, 3)), np.array([1], np.int64))], [0], np.zeros((1, 3)))


# The library itself


def _compile(tmp_path: Path, text: str) -> str:
    source, path = tmp_path / "other.c", tmp_path / NAME
    source.write_text(text)
    subprocess.run(["cc", "-shared", "-fPIC", str(source), "-o", str(path)], check=True)
    return str(path)


def test_missing_library_is_reported_with_the_command_to_build_it(tmp_path: Path) -> None:
    with pytest.raises(InstallationError, match=rf"^{NAME} is in none of {tmp_path}: build .*\./robocop setup"):
        compiled.find("caster", [str(tmp_path)])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("int aro_caster_version(void) { return 99; }", "has version 99, these sources need version 1: build"),
        ("int other(void) { return 1; }", "can't be used .*aro_caster_version.*: build"),
    ],
)
def test_library_built_from_other_sources_is_refused(tmp_path: Path, text: str, message: str) -> None:
    path = _compile(tmp_path, text)
    with pytest.raises(InstallationError, match=message):
        compiled.load("caster", caster_library.VERSION, path)


def test_file_that_is_not_a_library_is_refused(tmp_path: Path) -> None:
    (tmp_path / NAME).write_text("no library")
    with pytest.raises(InstallationError, match="can't be used .*: build"):
        compiled.load("caster", caster_library.VERSION, compiled.find("caster", [str(tmp_path)]))


@pytest.fixture(scope="module")
def sanitized(tmp_path_factory: pytest.TempPathFactory) -> str:
    """The library, built with the address and undefined-behaviour sanitizers."""
    path = str(tmp_path_factory.mktemp("sanitized") / NAME)
    checks = ["-fsanitize=address,undefined,float-cast-overflow", "-fno-sanitize-recover=all"]
    warnings = ["-Wall", "-Wextra", "-Wconversion", "-pedantic", "-Werror"]
    subprocess.run(
        ["cc", "-std=c99", "-g", "-O1", *warnings, *checks, "-fPIC", "-shared", SOURCE, "-lm", "-o", path], check=True
    )
    return path


def _under_sanitizers(path: str, *arguments: str) -> "subprocess.CompletedProcess[str]":
    runtime = subprocess.run(["cc", "-print-file-name=libasan.so"], check=True, capture_output=True, text=True).stdout
    script = os.path.join(os.path.dirname(__file__), "scan_under_sanitizers.py")
    return subprocess.run(
        [sys.executable, script, path, *arguments],
        env={**os.environ, "LD_PRELOAD": runtime.strip(), "ASAN_OPTIONS": "detect_leaks=0", "PYTHONMALLOC": "malloc"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=120,
    )


def test_sanitizers_report_nothing(sanitized: str) -> None:
    done = _under_sanitizers(sanitized)
    assert (done.returncode, done.stdout) == (0, "sound\n")


def test_sanitizers_detect_a_read_beyond_an_array(sanitized: str) -> None:
    done = _under_sanitizers(sanitized, "--beyond")
    assert done.returncode != 0 and "AddressSanitizer: heap-buffer-overflow" in done.stdout
