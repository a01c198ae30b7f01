"""URIs of models and meshes -> files, found where Gazebo Classic finds them."""

import os
from typing import Callable, Dict, Iterator, List, Tuple

import rospkg

from . import sdf
from .errors import WorldError

Place = Tuple[str, str]  # a path that the URI may mean, or where relative ones start, and why it may

_CONFIG, _MODEL = "model.config", "model.sdf"
_BESIDE = (".", "..", "models", os.path.join("..", "models"))  # a world's models, next to it or to its directory


def find_file(uri: str, element: sdf.Element) -> str:
    """The file or directory that a URI of an element means, relative paths from the element's own file.

    WorldError as locate, with the element's file and line.
    """
    return _for_element(locate, uri, element)


def find_model(uri: str, element: sdf.Element) -> str:
    """The SDF file of the model that a URI of an element means; WorldError as locate_model, with file and line."""
    return _for_element(locate_model, uri, element)


def locate(uri: str, start: str, why: str) -> str:
    """The file or directory that a URI means: model://, package://, file://, or a plain path.

    A relative path starts at the directory `start`, else in GAZEBO_RESOURCE_PATH. WorldError lists the places looked
    in, or says which URIs are supported; `why`: how it explains that it looked in `start`.
    """
    scheme, separator, path = uri.partition("://")
    if not separator:
        scheme, path = "file", uri
    if scheme not in _PLACES or not path:
        raise WorldError(f"'{uri}' is not supported; supported: model://, package://, file:// and plain paths")
    looked_for: List[str] = []
    for place, reason in _PLACES[scheme](path, (start, why)):
        if os.path.exists(place):
            return os.path.normpath(place)
        looked_for.append(f"{os.path.normpath(place)} ({reason})")
    raise WorldError(f"'{uri}' was not found; looked for: {', '.join(looked_for)}")


def locate_model(uri: str, start: str, why: str) -> str:
    """The SDF file of a model: what locate finds, or the file within that directory.

    model.config says which one it is: of several the one of the newest version that is read. Without it: model.sdf.
    """
    found = locate(uri, start, why)
    if os.path.isfile(found):
        return found
    config = os.path.join(found, _CONFIG)
    path = os.path.join(found, _from_config(config) if os.path.isfile(config) else _MODEL)
    if not os.path.isfile(path):
        raise WorldError(f"'{uri}' is {found}, but there is no file {path}")
    return path


def _for_element(find: Callable[[str, str, str], str], uri: str, element: sdf.Element) -> str:
    try:
        return find(uri, os.path.dirname(os.path.abspath(sdf.file_of(element))), "beside the file")
    except WorldError as exc:
        raise sdf.error(element, str(exc)) from exc


def _from_config(path: str) -> str:
    """The name of the SDF file that a model.config prefers."""
    listed = [entry for entry in sdf.parse(path).iterchildren("sdf") if entry.get("version", "1.4") in sdf.VERSIONS]
    newest = max(listed, key=lambda entry: str(entry.get("version", "")), default=None)
    return _MODEL if newest is None else sdf.text_of(newest)


def _from_variable(variable: str, path: str) -> Iterator[Place]:
    for directory in os.environ.get(variable, "").split(os.pathsep):
        if directory:
            yield os.path.join(directory, path), variable


def _model_places(path: str, start: Place) -> Iterator[Place]:
    yield from _from_variable("GAZEBO_MODEL_PATH", path)
    for beside in _BESIDE:
        yield os.path.join(start[0], beside, path), start[1]
    yield os.path.expanduser(os.path.join("~", ".gazebo", "models", path)), "Gazebo's own"
    yield from _package_places(path, start)
    yield from _exported_places(path)


def _exported_places(path: str) -> Iterator[Place]:
    """Where packages have Gazebo look, by <gazebo_ros gazebo_model_path="${prefix}/models"/> among their exports."""
    packages = rospkg.RosPack()
    for name in packages.list():
        directory = packages.get_path(name)
        manifest = os.path.join(directory, "package.xml")
        if os.path.isfile(manifest) and _mentions(manifest, b"gazebo_model_path"):
            for entry in sdf.parse(manifest).iterfind("export/gazebo_ros[@gazebo_model_path]"):
                exported = entry.get("gazebo_model_path").replace("${prefix}", directory)
                yield os.path.join(exported, path), f"exported by {name}"


def _mentions(path: str, word: bytes) -> bool:
    with open(path, "rb") as file:
        return word in file.read()


def _package_places(path: str, _start: Place) -> Iterator[Place]:
    name, _, rest = path.partition("/")
    try:
        yield os.path.join(rospkg.RosPack().get_path(name), rest), "in ROS_PACKAGE_PATH"
    except rospkg.ResourceNotFound:
        yield name, "no such package in ROS_PACKAGE_PATH"


def _file_places(path: str, start: Place) -> Iterator[Place]:
    yield os.path.join(start[0], path), start[1]
    yield from _from_variable("GAZEBO_RESOURCE_PATH", path)


_PLACES: Dict[str, Callable[[str, Place], Iterator[Place]]] = {
    "model": _model_places,
    "package": _package_places,
    "file": _file_places,
}
