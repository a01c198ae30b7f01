"""Find the files that URIs of models and meshes refer to, in the places where Gazebo Classic looks."""

import os
from pathlib import Path
from typing import Iterable, Iterator, List, Tuple

import rospkg

from ...errors import WorldError
from . import xml

Candidate = Tuple[str, str]  # a path that may exist, and the reason to look there, for messages

_REMOTE = ("fuel", "ftp", "http", "https")  # schemes of files on other machines
_DEFAULT = "model.sdf"


def model_name(uri: str) -> str:
    """The name of the model that a model:// URI refers to as a whole; else empty."""
    scheme, path = _split(uri)
    path = path[: -len(_DEFAULT) - 1] if path.endswith(f"/{_DEFAULT}") else path
    return path if scheme == "model" and "/" not in path else ""


def _split(uri: str) -> Tuple[str, str]:
    """The scheme of a URI, "file" for a plain path, and the path.

    Slashes at the end and, for model:// and package://, after the scheme are left out: Gazebo ignores them too.
    """
    scheme, separator, path = uri.rstrip("/").partition("://")
    if not separator:
        return "file", uri
    return scheme, path.lstrip("/") if scheme in ("model", "package") else path


def locate(uri: str, file: str) -> str:
    """The file or directory that a URI in a file refers to: model://, package://, file://, or a plain path.

    NotSimulatedError for a web address, because nothing is downloaded, and for a model without a folder. WorldError
    lists the places searched, or the supported kinds of URI.
    """
    scheme, path = _split(uri)
    if scheme.lower() in _REMOTE:
        raise xml.NotSimulatedError(f"'{uri}' is a web address, and nothing is downloaded")
    if scheme not in ("model", "package", "file") or not path:
        raise WorldError(f"'{uri}' is not supported; supported: model://, package://, file:// and plain paths")
    looked_for: List[str] = []
    for candidate, why in _candidates(scheme, path, os.path.abspath(file)):
        if os.path.exists(candidate):
            return os.path.normpath(candidate)
        looked_for.append(f"{os.path.normpath(candidate)} ({why})")
    problem = f"'{uri}' was not found; looked for: {', '.join(dict.fromkeys(looked_for))}"
    name = path.partition("/")[0]
    if scheme == "model" and not any(os.path.exists(it) for it, _ in _candidates(scheme, name, os.path.abspath(file))):
        raise xml.MissingModelError(name, problem)
    raise WorldError(problem)


def locate_model(uri: str, file: str) -> str:
    """The SDF file of a model: the file that locate finds, or the SDF file in the directory that it finds.

    In a directory, model.config names the file; the newest SDF version is preferred. Default: model.sdf, also
    where model.config can't be read.
    """
    location = locate(uri, file)
    if os.path.isfile(location):
        return location
    config = os.path.join(location, "model.config")
    path = os.path.join(location, _sdf_name(config) if os.path.isfile(config) else _DEFAULT)
    if not os.path.isfile(path):
        raise WorldError(f"'{uri}' is {location}, but there is no file {path}")
    return path


def _sdf_name(path: str) -> str:
    """The name of the SDF file that a model.config lists for the newest version."""
    try:
        entries = xml.parse(path, lenient=True).findall("sdf")
    except WorldError:  # only this name is needed of the file, so its errors are no errors of the world
        return _DEFAULT
    newest = max(entries, key=xml.version_of, default=None)
    return (_DEFAULT if newest is None else xml.text_of(newest)) or _DEFAULT


def _from_variable(variable: str, path: str) -> Iterator[Candidate]:
    for directory in filter(None, os.environ.get(variable, "").split(os.pathsep)):
        yield os.path.join(directory, path), variable


def _beside(file: str, folders: Iterable[str], path: str) -> Iterator[Candidate]:
    for folder in folders:
        yield os.path.join(os.path.dirname(file), folder, path), f"beside {os.path.basename(file)}"


def _candidates(scheme: str, path: str, file: str) -> Iterator[Candidate]:
    """Where Gazebo Classic looks for the path of a model://, package:// or file:// URI in a file, in this order."""
    if scheme == "file":
        # A world's folder is often beside models/, in a package's folder.
        yield from _beside(file, (".", "..", "../.."), path)
        yield from _from_variable("GAZEBO_RESOURCE_PATH", path)
        yield from _exported_candidates("gazebo_media_path", path)
        return
    if scheme == "model":
        yield from _from_variable("GAZEBO_MODEL_PATH", path)
        yield from _beside(file, (".", "..", "models", "../models"), path)
        yield os.path.expanduser(os.path.join("~", ".gazebo", "models", path)), "Gazebo's default"
    name, _, rest = path.partition("/")
    try:
        yield os.path.join(rospkg.RosPack.get_instance().get_path(name), rest), "in ROS_PACKAGE_PATH"
    except rospkg.ResourceNotFound:
        yield name, "no such package in ROS_PACKAGE_PATH"
    if scheme == "model":
        yield from _exported_candidates("gazebo_model_path", path)


def _exported_candidates(kind: str, path: str) -> Iterator[Candidate]:
    """In folders that packages export, as in <gazebo_ros gazebo_model_path="${prefix}/models"/>.

    Not by rospkg's get_export, which refuses manifests that it finds imperfect and asks for rosdep.
    """
    packages = rospkg.RosPack.get_instance()
    for name in packages.list():
        directory = packages.get_path(name)
        manifest = Path(directory, "package.xml")
        if manifest.is_file() and kind.encode() in manifest.read_bytes():
            for entry in xml.parse(str(manifest)).iterfind(f"export/gazebo_ros[@{kind}]"):
                for exported in entry.get(kind).replace("${prefix}", directory).split(os.pathsep):
                    yield os.path.join(exported, path), f"exported by {name}"
