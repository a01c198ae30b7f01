"""Geometries are read with their dimensions."""

from sdf_files import SPHERE, collision, mesh_world, model, raised_by, world_file

from aro_robocop_goto_as.shapes import Box, Cylinder, Plane, Sphere
from aro_robocop_goto_as.world.load import load_world


def test_each_geometry_is_read_with_its_dimensions(tmp_path):
    shapes = {
        "box": ("<box><size>1 2e-1 +.3</size></box>", Box((1.0, 0.2, 0.3))),
        "cylinder": ("<cylinder><length>2.</length><radius>0.5</radius></cylinder>", Cylinder(0.5, 2.0)),
        "sphere": (SPHERE, Sphere(0.5)),
        "plane": ("<plane><normal>0 3 4</normal><size>1 1</size></plane>", Plane((0.0, 0.6, 0.8))),
        "level": ("<plane/>", Plane((0.0, 0.0, 1.0))),
    }
    body = model("".join(collision(xml, name) for name, (xml, _) in shapes.items()))
    obstacles = load_world(world_file(tmp_path, body)).obstacles
    assert [(o.name, o.geometry) for o in obstacles] == [(f"m/l/{name}", shape) for name, (_, shape) in shapes.items()]


def test_mesh_with_no_extent_along_an_axis_is_refused(tmp_path):
    (tmp_path / "t.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n")
    assert "<scale> is '1 0 1'" in raised_by(mesh_world(tmp_path, "t.obj", "<scale>1 0 1</scale>"))
