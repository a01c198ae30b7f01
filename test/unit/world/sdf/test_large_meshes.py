"""Large meshes are read once, in another process, which has a limit on its time."""

import logging
import os

import numpy as np
import pytest
import trimesh
from sdf_files import mesh_world, only_obstacle, raised_by

from aro_robocop_goto_as.world.sdf import large_meshes


@pytest.fixture(name="ball")
def _ball(tmp_path, monkeypatch):
    """The path of a mesh that counts as large; ROS's home is an empty folder."""
    monkeypatch.setenv("ROS_HOME", str(tmp_path / "home"))
    monkeypatch.setattr(large_meshes, "LARGE", 100)
    path = tmp_path / "ball.stl"
    trimesh.creation.icosphere(subdivisions=1).export(str(path))
    return path


def kept(tmp_path):
    return sorted((tmp_path / "home" / "robocop_meshes").iterdir())


def test_mesh_is_read_once_and_kept_under_the_hash_of_its_file(tmp_path, ball, monkeypatch, caplog):
    first = only_obstacle(mesh_world(tmp_path, "ball.stl")).geometry.corners
    assert len(first) == 80 and "reading" in caplog.text and "ball.stl" in caplog.text
    monkeypatch.setattr(large_meshes, "_read_in_child", None)
    (tmp_path / "copy.stl").write_bytes(ball.read_bytes())
    assert np.array_equal(only_obstacle(mesh_world(tmp_path, "copy.stl")).geometry.corners, first)
    ball.write_bytes(ball.read_bytes() + b" ")
    assert "NoneType" in raised_by(mesh_world(tmp_path, "ball.stl"))


def test_what_was_kept_is_read_again_if_it_is_damaged_and_the_oldest_are_deleted(tmp_path, ball, monkeypatch):
    monkeypatch.setattr(large_meshes, "KEPT", 2)
    monkeypatch.setattr(large_meshes, "_read_in_child", large_meshes.read_triangles)
    whole = large_meshes.load_triangles(str(ball))
    (file,) = kept(tmp_path)
    for damaged in (b"", file.read_bytes()[:-1], b"\x93NUMPY"):
        file.write_bytes(damaged)
        assert np.array_equal(large_meshes.load_triangles(str(ball)), whole)
        assert kept(tmp_path) == [file]
    os.utime(file, (1, 1))
    for size in (2, 3):
        trimesh.creation.icosphere(subdivisions=size).export(str(ball))
        large_meshes.load_triangles(str(ball))
    assert len(kept(tmp_path)) == 2 and file not in kept(tmp_path)


def test_mesh_is_read_where_nothing_can_be_kept(tmp_path, ball, monkeypatch, caplog):
    monkeypatch.setattr(large_meshes, "_read_in_child", large_meshes.read_triangles)
    (tmp_path / "home").write_text("a file")
    assert len(large_meshes.load_triangles(str(ball))) == 80
    assert "can't keep the mesh for the next start" in caplog.text


def test_error_of_a_large_mesh_is_that_of_a_small_one(tmp_path, ball):
    (tmp_path / "bad.obj").write_text("v 0 0 0\n" * 30 + "v 1 a 0\n")
    assert raised_by(mesh_world(tmp_path, "bad.obj")).endswith("bad.obj:31: v is '1 a 0', expected 3 finite numbers")


def test_time_to_read_a_mesh_is_limited(tmp_path, ball, monkeypatch):
    monkeypatch.setattr(large_meshes, "TIME_LIMIT", 1)
    (tmp_path / "endless.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\n" + "f 1 2 3\n" * 3_000_000)
    message = raised_by(mesh_world(tmp_path, "endless.obj"))
    assert "endless.obj: not read within 1 s of processor time; expected a simpler mesh" in message


def test_progress_is_told(tmp_path, ball, monkeypatch, caplog):
    monkeypatch.setattr(large_meshes, "PERIOD", 0.01)
    with caplog.at_level(logging.WARNING):
        large_meshes.load_triangles(str(ball))
    assert f"still reading {ball} after 0 s" in caplog.text
