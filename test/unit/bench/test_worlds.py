"""bench.worlds: the worlds that are written for some cases."""

from aro_robocop_goto_as.bench.cases import Case, positions
from aro_robocop_goto_as.bench.worlds import CELLS, MOVING, world_of
from aro_robocop_goto_as.world.load import load_world


def test_usual_cases_run_in_the_hall_of_the_package(tmp_path):
    assert world_of(Case("wheels", "10"), tmp_path) == world_of(Case("wheels", "rospy"), tmp_path) == "bench"
    assert list(tmp_path.iterdir()) == []


def test_twenty_pillars_move_around_the_robot_and_away_from_its_circle(tmp_path):
    world = load_world(world_of(Case("kinematic", "moving"), tmp_path))
    moving = [item for item in world.obstacles if item.motion is not None]
    assert len(moving) == MOVING
    x, y = positions()[0]
    for time in (0.0, 1.0, 2.0, 3.0):
        for item in moving:
            pose = item.motion.carry(item.pose.on_plane(), time)
            assert ((pose.x - x) ** 2 + (pose.y - y - 0.2) ** 2) ** 0.5 > 0.2 + 0.105 + 0.1


def test_large_map_has_ten_thousand_walls_and_is_written_once(tmp_path):
    path = world_of(Case("kinematic", "map"), tmp_path)
    written = {file: file.stat().st_mtime_ns for file in tmp_path.iterdir()}
    assert world_of(Case("wheels", "map"), tmp_path) == path
    assert {file: file.stat().st_mtime_ns for file in tmp_path.iterdir()} == written
    world = load_world(path)
    assert world.occupancy.cells.shape == (CELLS, CELLS)
    assert sum(len(item.geometry.segments) for item in world.obstacles if hasattr(item.geometry, "segments")) == 10_000
