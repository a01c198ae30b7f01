"""What the platforms of courses export: the folder that holds a class, and who handed in what."""

import re
import shlex
import zipfile
from pathlib import Path
from typing import Collection, Dict, List, NamedTuple

import yaml

from aro_robocop_goto_as.names import robocop
from robocop_hosting import tree
from robocop_hosting.scripts import ASIDE

from ..errors import GradingSetupError

METADATA = "submission_metadata.yml"  # written by Gradescope into what it exports
MOODLE = re.compile(r"((.+)_(\d+))_assignsubmission_[a-z]+_?((?!\.).*)")  # full name, number of the participant, file
ONLINE_TEXT = "_assignsubmission_onlinetext"  # what somebody has typed in Moodle, beside the files
ARCHIVES = (".zip", ".rar", ".7z", ".tar", ".tar.gz", ".tgz", ".tar.bz2", ".tbz2", ".tar.xz", ".txz")
GRADESCOPE = re.compile(r"submission_\d+")
SERVERS = re.compile(r"robocop_goto_as.*\.py")
EXPECTED = "a folder, an archive (zip, tar, rar, 7z) or a Python file"
SEVERAL = f"is this folder a class? {robocop()} grade-class grades each hand-in in it"


class Person(NamedTuple):
    """Who handed in, in the columns that Moodle and Gradescope import."""

    identifier: str = ""  # Moodle's
    full_name: str = ""
    email: str = ""  # from Gradescope, as is the student's number
    sid: str = ""


def is_archive(path: Path) -> bool:
    """Return whether a file of this name can be unpacked."""
    return path.name.lower().endswith(ARCHIVES)


def visible(folder: Path) -> List[Path]:
    """The entries of a folder that somebody may have handed in, sorted."""
    return sorted(path for path in folder.iterdir() if not path.name.startswith(".") and path.name != "__MACOSX")


def hand_in_of(entry: str) -> str:
    """The name of the hand-in to which an entry of a class belongs: several entries may be of one participant."""
    match = MOODLE.fullmatch(entry)
    return match[1] if match else entry


def parts_of(hand_in: Path) -> List[Path]:
    """The entries of one participant in Moodle."""
    matches = ((MOODLE.fullmatch(path.name), path) for path in visible(hand_in.parent) if ONLINE_TEXT not in path.name)
    return [path for match, path in matches if match and match[1] == hand_in.name]


def holds_class(folder: Path) -> bool:
    """Return whether a folder's entries look like hand-ins of several people, or are named like a platform's."""
    entries = [path for path in visible(folder) if path.name != METADATA]
    if (folder / METADATA).is_file() or any(map(_is_named_by_platform, entries)):
        return True
    return sum(map(_looks_like_a_hand_in, entries)) > 1


def class_folder(folder: Path, reserved: Collection[str]) -> Path:
    """The folder whose entries are the hand-ins: `folder`, or the only one in it, or in that, if it holds a class.

    GradingSetupError if it is no folder, or if a platform's export in it is still packed.
    """
    inner = folder
    while inner.is_dir() and not inner.is_symlink():
        if inner != folder and holds_class(inner):
            return inner
        entries = [path for path in visible(inner) if path.name not in reserved]
        if len(entries) != 1 or _is_named_by_platform(entries[0]):
            return folder
        (inner,) = entries
    if folder.is_dir() and not _is_packed_export(inner):
        return folder
    unpack = f"; unpack it first: unzip -q -d FOLDER {shlex.quote(str(inner))}" if is_archive(inner) else ""
    raise GradingSetupError(f"{inner}: expected a folder with {EXPECTED} for each hand-in{unpack}")


def _is_packed_export(path: Path) -> bool:
    """Return whether it is a zip with hand-ins that are named by a platform."""
    try:
        with zipfile.ZipFile(path) as archive:
            return any(_is_named_by_platform(Path(part)) for name in archive.namelist() for part in Path(name).parts)
    except Exception:  # zipfile documents no list of what it raises for a file that is no zip, or a damaged one
        return False


def _is_named_by_platform(path: Path) -> bool:
    return any(pattern.fullmatch(path.name) for pattern in (MOODLE, GRADESCOPE))


def _looks_like_a_hand_in(path: Path) -> bool:
    """Return whether it is an archive, a git repository, or a folder with the handout's server."""
    if not path.is_dir() or path.is_symlink():
        return is_archive(path)
    files = (name for _, _, names in tree.walk(path, (*tree.GENERATED, ".git")) for name in names)
    return not ASIDE.search(path.name) and ((path / ".git").exists() or any(map(SERVERS.fullmatch, files)))


def people(folder: Path) -> Dict[str, Person]:
    """Who handed in each hand-in of a class's folder, by its name, as far as the platform says it.

    GradingSetupError if Gradescope's file can't be read.
    """
    matches = filter(None, (MOODLE.fullmatch(path.name) for path in visible(folder)))
    moodle = {match[1]: Person(f"Participant {match[3]}", match[2]) for match in matches}
    return {**moodle, **_gradescope(folder / METADATA)}


def _gradescope(file: Path) -> Dict[str, Person]:
    """A group's members are in one row, as they have one submission."""
    if not file.is_file():
        return {}
    try:
        submissions = yaml.safe_load(file.read_text(encoding="utf-8")) or {}
        keys = ("", ":name", ":email", ":sid")
        return {
            name: Person(*(", ".join(str(who[key]) for who in values[":submitters"] if key in who) for key in keys))
            for name, values in submissions.items()
        }
    except (OSError, ValueError, KeyError, TypeError, AttributeError, yaml.YAMLError) as error:
        told = "expected submissions with :submitters:, as Gradescope writes it"
        raise GradingSetupError(f"{file}: {told}: {type(error).__name__}: {error}") from error
