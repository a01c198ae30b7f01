"""Worlds are found by name or path, and files of other kinds are told apart; broken ones are in sdf and grid_map."""

from pathlib import Path

import pytest
from support import ROOT

from aro_robocop_goto_as.errors import WorldError
from aro_robocop_goto_as.world.load import find_world, load_world

WORLDS = Path(ROOT, "worlds")


@pytest.mark.parametrize("text", ['# a maze\ninclude "pioneer.inc"\n', "P2\n1 1\n255\n0\n", ""])
def test_file_of_another_kind_is_refused_with_what_was_expected(tmp_path, text):
    (tmp_path / "stage.world").write_text(text)
    with pytest.raises(WorldError, match="stage.world:1: not XML; expected an SDF file, or the YAML file of a map"):
        load_world(str(tmp_path / "stage.world"))


@pytest.mark.parametrize(
    ("encoding", "declaration"),
    [("utf-8", "<?xml version='1.0'?>\r\n"), ("utf-8-sig", "<?xml version='1.0'?>\n"), ("utf-16", "")],
)
def test_file_in_unicode_is_read_whatever_is_before_its_content(tmp_path, encoding, declaration):
    text = f"\r\n  <!-- zeď -->\r\n{declaration}<sdf version='1.6'><world name='{encoding}'/></sdf>"
    (tmp_path / "w.world").write_bytes(text.encode(encoding))
    assert load_world(str(tmp_path / "w.world")).name == encoding


def test_world_is_found_by_its_bare_name_or_by_the_path_of_its_file(tmp_path, monkeypatch):
    assert find_world("stage_4", str(WORLDS)) == str(WORLDS / "stage_4.sdf")
    (tmp_path / "mine.world").touch()
    monkeypatch.chdir(tmp_path)
    for path in (str(tmp_path / "mine.world"), "mine.world"):
        assert find_world(path, str(WORLDS)) == path


@pytest.mark.parametrize("name", ["hause", "./stage_4", "stage_4.sdf", ""])
def test_unknown_world_is_refused_with_the_known_names(name):
    with pytest.raises(WorldError) as caught:
        find_world(name, str(WORLDS))
    assert f"'{name}'" in str(caught.value)
    assert "empty, maze_1, stage_1, stage_2, stage_3, stage_4, world" in str(caught.value)
