"""Read the triangles of a mesh file, by trimesh."""

import io
import os
import re
from typing import Any, Tuple

import numpy as np
from lxml import etree

from ...errors import WorldError
from ...reading import parse_xml, reading
from .xml import NotSimulatedError

KINDS = (".dae", ".obj", ".stl")
_STL_HEADER, _STL_FACET = 84, 50  # bytes of a binary .stl file

# The elements of a COLLADA file that place its triangles.
_COLLADA_PARTS = ("asset", "library_geometries", "library_nodes", "library_visual_scenes", "scene")
_WITHOUT_EFFECT = ("bind_material", "extra", "instance_camera", "instance_controller", "instance_light")


def load_triangles(path: str) -> np.ndarray:
    """The triangles (n, 3, 3) [m] of a mesh file, with its parts placed as in the file's scene.

    Lengths are in metres unless a COLLADA file declares another unit; <up_axis> is ignored, as in Gazebo Classic.
    NotSimulatedError for another format. WorldError if the file can't be read or contains no triangles.
    """
    kind = os.path.splitext(path)[1].lower()
    if kind not in KINDS:
        raise NotSimulatedError(f"{path}, which is no mesh in one of the formats {', '.join(KINDS)}")
    with reading(path, WorldError, f"a mesh in {kind} format"):
        import trimesh  # takes 0.3 s

        with open(path, "rb") as stream:
            content = stream.read()
        file: Any = None
        unit, file_type = 1.0, kind[1:]
        if kind == ".stl":
            file_type, file = _stl(content)
        elif kind == ".obj":
            file = io.StringIO(_plain_obj(_text(content)))
        else:
            file, unit = _geometry_alone(content, path)
        mesh = trimesh.load_mesh(file, file_type=file_type, process=False, skip_materials=True)
        triangles = np.array(mesh.triangles, dtype=float) * unit
    if not len(triangles):
        raise WorldError(f"{path}: no triangles found; expected a complete mesh in {kind} format")
    if not np.isfinite(triangles).all():
        raise WorldError(f"{path}: the mesh has corners that are not finite numbers")
    return triangles


def _text(content: bytes) -> str:
    return content.decode("utf-8-sig", "replace")


def _stl(content: bytes) -> Tuple[str, Any]:
    """Kind and contents of an .stl file: binary if it is long enough for the number of facets in its header.

    Bytes after the facets are skipped, as in Gazebo. Many binary files begin with "solid", too.
    """
    end = _STL_HEADER + _STL_FACET * int.from_bytes(content[80:84], "little")
    if _STL_HEADER <= end <= len(content):
        return "stl", io.BytesIO(content[:end])
    return "stl_ascii", io.StringIO(_text(content))


def _plain_obj(text: str) -> str:
    """An .obj file in a form that trimesh reads right: vertices and faces without comments, tabs, normals and textures.

    A face may count its vertices back from the last vertex before the face; trimesh would count from the file's last
    vertex.
    """
    text = re.sub(r"\\\r?\n|/\S*", " ", text)  # a line that is continued; what a corner has beside its vertex
    lines, vertices = [], 0
    for kind, words in re.findall(r"^[ \t]*([fv])[ \t]+([^#\r\n]*)", text, re.M):
        vertices += kind == "v"
        if kind == "f" and "-" in words:
            words = " ".join(str(i if i > 0 else vertices + 1 + i) for i in map(int, words.split()))
        lines.append(kind + " " + words)
    return "\n".join(lines)


def _geometry_alone(content: bytes, path: str) -> Tuple[io.BytesIO, float]:
    """A COLLADA file without elements that do not affect its triangles, whose faults do not matter; metres per unit."""
    root = parse_xml(content, path, WorldError)
    if not root.tag.startswith("{"):  # pycollada prints a traceback
        raise WorldError(f"{path}:{root.sourceline}: <{root.tag}>, expected <COLLADA xmlns='...'>")
    for part in list(root):
        if etree.QName(part).localname not in _COLLADA_PARTS:
            root.remove(part)
    etree.strip_elements(root, *(f"{{*}}{tag}" for tag in _WITHOUT_EFFECT), with_tail=False)
    for mesh in root.iterfind("{*}library_geometries/{*}geometry/{*}mesh"):
        _reduce_to_positions(mesh)
    shown = root.find("{*}scene/{*}instance_visual_scene")
    if shown is None or not root.xpath("//*[@id = $id]", id=shown.get("url", "")[1:]):
        raise WorldError(f"{path}: no <scene> with a <visual_scene>, which says where the parts of the mesh are")
    unit = root.find("{*}asset/{*}unit")
    metres = 1.0 if unit is None else float(unit.get("meter", "1"))
    if not 0.0 < metres < np.inf:
        raise WorldError(f"{path}:{unit.sourceline}: <unit meter='{metres:g}'>, expected a number greater than 0")
    return io.BytesIO(etree.tostring(root)), metres


def _reduce_to_positions(mesh: Any) -> None:
    """Remove normals, colours and texture coordinates from a COLLADA <mesh>."""
    for vertices in mesh.iterfind("{*}vertices"):
        for other in vertices.xpath("*[local-name() = 'input' and @semantic != 'POSITION']"):
            vertices.remove(other)
    used = {position.get("source") for position in mesh.iterfind("{*}vertices/{*}input")}
    for source in mesh.findall("{*}source"):
        if f"#{source.get('id')}" not in used:
            mesh.remove(source)
    for primitive in mesh.xpath("*[*[local-name() = 'p']]"):
        if any("-" in (indices.text or "") for indices in primitive.iterfind("{*}p")):  # numpy counts from the end
            raise ValueError("a triangle has a vertex below 0")
        vertex = primitive.find("{*}input[@semantic='VERTEX']")
        if vertex is not None:
            primitive.insert(0, vertex)  # pycollada takes the first one; the others keep their places among the indices
            for other in primitive.iterfind("{*}input"):
                other.attrib.update({"semantic": "VERTEX", "source": vertex.get("source")})
