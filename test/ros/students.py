"""Copies of the packages in test/students, as their authors have them on disk."""

import shutil
from pathlib import Path

STUDENTS = Path(__file__).resolve().parent.parent / "students"


def copy_of(name, folder):
    """The package `name` below a folder, without the .in that hides its files from rosrun and roslaunch."""
    package = folder / name
    shutil.copytree(STUDENTS / name, package)
    for path in list(package.rglob("*.in")):
        path.rename(path.with_suffix(""))
    return package


def contents(package):
    """Every file with what is in it and how it may be used."""
    return {path: (path.read_bytes(), path.stat().st_mode) for path in package.rglob("*") if path.is_file()}
