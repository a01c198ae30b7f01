"""Find the files that URIs of models and meshes refer to, in the places where Gazebo Classic looks."""

import os
from typing import Callable, Dict, Iterator, List, Tuple

import rospkg

from ...errors import WorldError
from . import xml

Candidate = Tuple[str, str]  # a path that may exist, and the reason to look there, for messages

_REMOTE = ("fuel", "ftp", "http", "https")  # schemes of files on other machines
_CONFIG, _MODEL = "model.config", "model.sdf"
_BESIDE = (".", "..", "models", os.path.join("..", "models"))  # relative to the directory of the file with the URI


def normalised(uri: str) -> str:
    """A URI without slashes at its end and, for model:// and package://, after the scheme: Gazebo ignores them too."""
    scheme, separator, path = uri.rstrip("/").partition("://")
    return uri.rstrip("/") if scheme not in ("model", "package") else scheme + separator + path.lstrip("/")


def find_file(uri: str, element: xml.Element) -> str:
    """The file or directory that a URI in an element refers to; relative paths start at the element's own file.

    WorldError as locate, with the element's file and line.
    """
    return _for_element(locate, uri, element)


def find_model(uri: str, element: xml.Element) -> str:
    """The SDF file of the model that a URI in an element refers to; WorldError as locate_model, with file and line."""
    return _for_element(locate_model, uri, element)


def locate(uri: str, start: str, reason: str) -> str:
    """The file or directory that a URI refers to: model://, package://, file://, or a plain path.

    A relative path is looked up in the directory `start`, then in GAZEBO_RESOURCE_PATH. WorldError lists the places
    searched, or the supported kinds of URI; reason: what `start` is, for that message.
    """
    scheme, separator, path = normalised(uri).partition("://")
    if not separator:
        scheme, path = "file", uri
    if scheme.lower() in _REMOTE:
        # fuel.gazebosim.org, formerly fuel.ignitionrobotics.org; app.gazebosim.org/OWNER/fuel is its web page
        where = "on Gazebo Fuel" if "fuel" in uri.lower() else "a web address"
        raise WorldError(f"'{uri}' is {where}, and nothing is downloaded; expected model://NAME of a local model")
    if scheme not in _CANDIDATES or not path:
        raise WorldError(f"'{uri}' is not supported; supported: model://, package://, file:// and plain paths")
    looked_for: List[str] = []
    for candidate, why in _CANDIDATES[scheme](path, (start, reason)):
        if os.path.exists(candidate):
            return os.path.normpath(candidate)
        looked_for.append(f"{os.path.normpath(candidate)} ({why})")
    raise WorldError(f"'{uri}' was not found; looked for: {', '.join(looked_for)}")


def locate_model(uri: str, start: str, reason: str) -> str:
    """The SDF file of a model: the file that locate finds, or the SDF file in the directory that it finds.

    In a directory, model.config names the file; the newest supported SDF version is preferred. Default: model.sdf.
    """
    location = locate(uri, start, reason)
    if os.path.isfile(location):
        return location
    config = os.path.join(location, _CONFIG)
    path = os.path.join(location, _sdf_name(config) if os.path.isfile(config) else _MODEL)
    if not os.path.isfile(path):
        raise WorldError(f"'{uri}' is {location}, but there is no file {path}")
    return path


def _for_element(find: Callable[[str, str, str], str], uri: str, element: xml.Element) -> str:
    try:
        return find(uri, os.path.dirname(os.path.abspath(xml.file_of(element))), "beside the file")
    except WorldError as exc:
        raise xml.error(element, str(exc)) from exc


def _sdf_name(path: str) -> str:
    """The name of the SDF file that a model.config lists for the newest supported version."""
    listed = [entry for entry in xml.parse(path).iterchildren("sdf") if entry.get("version", "1.4") in xml.VERSIONS]
    newest = max(listed, key=lambda entry: str(entry.get("version", "")), default=None)
    return _MODEL if newest is None else xml.text_of(newest)


def _from_variable(variable: str, path: str) -> Iterator[Candidate]:
    for directory in os.environ.get(variable, "").split(os.pathsep):
        if directory:
            yield os.path.join(directory, path), variable


def _model_candidates(path: str, start: Candidate) -> Iterator[Candidate]:
    yield from _from_variable("GAZEBO_MODEL_PATH", path)
    for beside in _BESIDE:
        yield os.path.join(start[0], beside, path), start[1]
    yield os.path.expanduser(os.path.join("~", ".gazebo", "models", path)), "Gazebo's default"
    yield from _package_candidates(path, start)
    yield from _exported_candidates(path)


def _exported_candidates(path: str) -> Iterator[Candidate]:
    """Model paths that packages export, as in <gazebo_ros gazebo_model_path="${prefix}/models"/>."""
    packages = rospkg.RosPack()
    for name in packages.list():
        directory = packages.get_path(name)
        manifest = os.path.join(directory, "package.xml")
        if os.path.isfile(manifest) and _mentions(manifest, b"gazebo_model_path"):
            for entry in xml.parse(manifest).iterfind("export/gazebo_ros[@gazebo_model_path]"):
                exported = entry.get("gazebo_model_path").replace("${prefix}", directory)
                yield os.path.join(exported, path), f"exported by {name}"


def _mentions(path: str, word: bytes) -> bool:
    with open(path, "rb") as file:
        return word in file.read()


def _package_candidates(path: str, _start: Candidate) -> Iterator[Candidate]:
    name, _, rest = path.partition("/")
    try:
        yield os.path.join(rospkg.RosPack().get_path(name), rest), "in ROS_PACKAGE_PATH"
    except rospkg.ResourceNotFound:
        yield name, "no such package in ROS_PACKAGE_PATH"


def _file_candidates(path: str, start: Candidate) -> Iterator[Candidate]:
    yield os.path.join(start[0], path), start[1]
    yield from _from_variable("GAZEBO_RESOURCE_PATH", path)


_CANDIDATES: Dict[str, Callable[[str, Candidate], Iterator[Candidate]]] = {
    "model": _model_candidates,
    "package": _package_candidates,
    "file": _file_candidates,
}
