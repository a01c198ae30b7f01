"""A model that worlds can include."""

import pytest
from sdf_files import BOX, sdf_file


@pytest.fixture
def chair(tmp_path, monkeypatch):
    """A model directory in GAZEBO_MODEL_PATH with two versions of the model."""
    home = tmp_path / "models" / "chair"
    sdf_file(home / "old.sdf", '<model name="old"/>', "1.4")
    sdf_file(home / "new.sdf", f'<model name="chair"><pose>5 5 5 0 0 0</pose>{BOX}</model>')
    (home / "model.config").write_text(
        "<model><sdf version='1.6'>new.sdf</sdf><sdf version='1.4'>old.sdf</sdf><sdf version='2.0'>no.sdf</sdf></model>"
    )
    monkeypatch.setenv("GAZEBO_MODEL_PATH", f"{tmp_path / 'none'}:{tmp_path / 'models'}")
    return home
