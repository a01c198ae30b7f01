"""Meshes of every format are read as their triangles."""

import numpy as np
import pytest
import trimesh
from sdf_files import mesh_world, only_obstacle, raised_by

from aro_robocop_goto_as.shapes import Mesh

# An upright triangle on the x axis; the unit is centimetres, and x is declared to be up, which Gazebo ignores.
TRIANGLE_DAE = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset><unit name="centimeter" meter="0.01"/><up_axis>X_UP</up_axis></asset>
  <library_geometries><geometry id="g"><mesh>
    <source id="p"><float_array id="a" count="9">0 0 0 100 0 0 0 0 200</float_array>
      <technique_common><accessor source="#a" count="3" stride="3">
        <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
      </accessor></technique_common></source>
    <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
    <triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
  </mesh></geometry></library_geometries>
  <library_visual_scenes><visual_scene id="s"><node><translate>0 300 0</translate>
    <instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url="#s"/></scene>
</COLLADA>
"""


def test_collada_mesh_is_read_with_unit_scene_and_scale(tmp_path):
    (tmp_path / "t.dae").write_text(TRIANGLE_DAE)
    obstacle = only_obstacle(mesh_world(tmp_path, "t.dae", "<scale>-2 1 1</scale>"))
    assert isinstance(obstacle.geometry, Mesh)
    assert obstacle.geometry.corners == pytest.approx(np.array([[[0, 3, 0], [-2, 3, 0], [0, 3, 2]]]))
    assert obstacle.geometry.file == str(tmp_path / "t.dae")


@pytest.mark.parametrize("kind", ["stl", "stl_ascii", "obj"])
def test_mesh_is_read_as_it_was_written_and_scaled(tmp_path, kind):
    box, name = trimesh.creation.box((0.5, 1.0, 1.5)), "box." + kind[:3]
    box.export(str(tmp_path / name), file_type=kind)
    corners = only_obstacle(mesh_world(tmp_path, name, "<scale>2 1 1</scale>")).geometry.corners
    assert corners == pytest.approx(box.triangles * [2.0, 1.0, 1.0])


@pytest.mark.parametrize("header", [b"made by hand", b"solid made by hand\nfacet normal"])
def test_bytes_after_the_facets_of_a_binary_stl_are_skipped_as_in_gazebo(tmp_path, header):
    facet = np.array([0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0], "<f4").tobytes() + b"\0\0"
    (tmp_path / "a.stl").write_bytes(header.ljust(80) + b"\1\0\0\0" + facet + b"\n")
    obstacle = only_obstacle(mesh_world(tmp_path, "a.stl"))
    assert obstacle.geometry.corners.tolist() == [[[0, 0, 0], [1, 0, 0], [0, 1, 0]]]


CORNERS = b"v 0 0 0\nv 1 0 0\nv 0 0 1\n"
BROKEN_MESHES = {  # file: (content, what the message must name)
    "empty.stl": (b"", "no triangles found; expected a complete mesh in .stl format"),
    "nan.obj": (b"v 0 0 0\nv 1 0 0\nv nan 0 1\nf 1 2 3\n", "not finite numbers"),
    "words.obj": (b"v 0 0 0\nv 1 a 0\n", "expected a mesh in .obj format"),
    "beyond.obj": (CORNERS + b"f 1 2 9\n", "index 8 is out of bounds"),
    "far.obj": (b"v 0 0 0\nv 1 0 0\nv 1e300 0 1\nf 1 2 3\n", "has corners beyond +-1e+06 m"),
    "cut.dae": (TRIANGLE_DAE[:700].encode(), "XML"),
    "below.dae": (TRIANGLE_DAE.replace("<p>", "<p>0 1 -1</p><p>").encode(), "a triangle has a vertex below 0"),
    "web.dae": (b"<html>404</html>", "web.dae:1: <html>, expected <COLLADA xmlns='...'>"),
    "unit.dae": (TRIANGLE_DAE.replace("0.01", "0").encode(), "meter='0'"),
    "entity.dae": (b"<!DOCTYPE COLLADA [<!ENTITY e SYSTEM 'file:///etc/hostname'>]><COLLADA/>", "DOCTYPE"),
    "nowhere.dae": (TRIANGLE_DAE.replace("#s", "#other").encode(), "no <scene> with a <visual_scene>"),
}


@pytest.mark.parametrize("name", BROKEN_MESHES)
def test_unreadable_mesh_is_refused_with_the_line_that_uses_it(tmp_path, name):
    content, named = BROKEN_MESHES[name]
    (tmp_path / name).write_bytes(content)
    path = mesh_world(tmp_path, name)
    message = raised_by(path)
    assert message.startswith(f"{path}:3: in 'm/l/c': {tmp_path / name}") and named in message


def test_mesh_with_no_extent_along_an_axis_is_refused(tmp_path):
    (tmp_path / "t.obj").write_bytes(CORNERS + b"f 1 2 3\n")
    assert "<scale> is '1 0 1'" in raised_by(mesh_world(tmp_path, "t.obj", "<scale>1 0 1</scale>"))


A, B, C = (0, 0, 0), (1, 0, 0), (0, 0, 1)


@pytest.mark.parametrize(
    ("rest", "expected"),
    [
        (b"f 1 2 3", [(A, B, C)]),
        (b"f 3/9/9 2//9 1/9  # a comment\r\nvt 0\nl 1 2\n\xff", [(C, B, A)]),
        (b"f 1 \\\n2 3\n", [(A, B, C)]),
        (b"\tv\t1\t0\t1\n  f\t1 2 4  # \xe9", [(A, B, (1, 0, 1))]),
        (b"v 1 0 1 0.5 0.5 0.5\nf 1 2 4 3", [(A, B, (1, 0, 1)), ((1, 0, 1), C, A)]),
        (b"f -3 -2 -1\nv 5 0 0\nf -4 -3 -1\nf 1 2 5\nv 6 0 0", [(A, B, C), (A, B, (5, 0, 0)), (A, B, (6, 0, 0))]),
    ],
)
def test_only_vertices_and_faces_of_an_obj_are_read(tmp_path, rest, expected):
    (tmp_path / "m.obj").write_bytes(b"\xef\xbb\xbf" + CORNERS + rest)
    found = only_obstacle(mesh_world(tmp_path, "m.obj")).geometry.corners
    assert sorted(found.tolist()) == sorted(np.array(expected).tolist())


NORMALS = """<source id="n"><float_array id="na" count="{}">0 1 0</float_array><technique_common>
<accessor source="#na" count="1" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>"""
VERTICES, TRIANGLES = '<vertices id="v">', '<input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p>'
WITH_NORMALS = TRIANGLES.replace("<p>0 1 2<", '<input semantic="{}" source="#n" offset="1"/><p>0 {} 1 0 2 0<')
POLYGONS = (
    '<polylist count="1"><input semantic="VERTEX" source="#v" offset="0"/><vcount>3</vcount><p>0 1 2</p></polylist>'
)
VARIANTS = {  # case: parts of the file, and what is there instead
    "a polygon": {f'<triangles count="1">{TRIANGLES}</triangles>': POLYGONS},
    "an effect, an image, a material, a light and a camera that are missing": {
        "<library_geometries>": "<library_images><image/></library_images><library_effects><effect/></library_effects>"
        "<library_geometries>",
        '<instance_geometry url="#g"/>': """<instance_light url="#l"/><instance_camera url="#c"/>
        <instance_geometry url="#g"><bind_material><technique_common><instance_material symbol="m" target="#gone"/>
        </technique_common></bind_material></instance_geometry>""",
    },
    "normals that are cut off": {VERTICES: NORMALS.format("five") + VERTICES},
    "normals that are missing": {TRIANGLES: WITH_NORMALS.format("NORMAL", 0)},
    "normals of the vertices that are missing": {VERTICES: VERTICES + '<input semantic="NORMAL" source="#n"/>'},
}


@pytest.mark.parametrize("changes", VARIANTS.values(), ids=VARIANTS)
def test_only_the_geometry_of_a_collada_file_counts(tmp_path, changes):
    text = TRIANGLE_DAE
    for part, instead in changes.items():
        assert text.count(part) == 1
        text = text.replace(part, instead)
    (tmp_path / "t.dae").write_text(text)
    assert only_obstacle(mesh_world(tmp_path, "t.dae")).geometry.corners.tolist() == [[[0, 3, 0], [1, 3, 0], [0, 3, 2]]]
