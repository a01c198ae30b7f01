"""Worlds are found by name or path, and those of Stage are told apart; broken files are in sdf and grid_map."""

from pathlib import Path

import pytest
from support import ROOT

from aro_robocop_goto_as.errors import WorldError
from aro_robocop_goto_as.world.load import find_world, load_world

WORLDS = Path(ROOT, "worlds")


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
