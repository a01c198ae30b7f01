"""Write SDF files for tests, and load them."""

import pytest

from aro_robocop_goto_as.errors import WorldError
from aro_robocop_goto_as.world.load import load_world

BOX = '<link name="l"><collision name="c"><geometry><box><size>1 1 1</size></box></geometry></collision></link>'
SPHERE = "<sphere><radius>0.5</radius></sphere>"


def sdf_file(path, body, version="1.6"):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f'<sdf version="{version}">\n{body}\n</sdf>\n', encoding="utf-8")
    return str(path)


def world_file(directory, body, version="1.7", name="w.world"):
    """The path of a world file with the body from line 3 on."""
    return sdf_file(directory / name, f'<world name="w">\n{body}\n</world>', version)


def model(content, name="m", pose=""):
    return f'<model name="{name}"><static>true</static>{pose}<link name="l">\n{content}\n</link></model>'


def collision(geometry, name="c", pose=""):
    return f'<collision name="{name}">{pose}<geometry>{geometry}</geometry></collision>'


def mesh_world(tmp_path, uri, scale=""):
    geometry = f"<geometry><mesh><uri>{uri}</uri>{scale}</mesh></geometry>"
    link = f'<link name="l"><collision name="c">{geometry}</collision></link>'
    return world_file(tmp_path, f'<model name="m"><static>1</static>{link}</model>')


def only_obstacle(path):
    (obstacle,) = load_world(path).obstacles
    return obstacle


def raised_by(path):
    with pytest.raises(WorldError) as caught:
        load_world(str(path))
    return str(caught.value)
