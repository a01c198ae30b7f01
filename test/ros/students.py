"""Copies of the packages in test/students, with the files named as in a student's package."""

import shutil
from pathlib import Path

STUDENTS = Path(__file__).resolve().parent.parent / "students"


def copy_of(name, folder):
    """Copy a package into a folder, without the .in that hides its files from rosrun and roslaunch."""
    package = folder / name
    shutil.copytree(STUDENTS / name, package)
    for path in list(package.rglob("*.in")):
        path.rename(path.with_suffix(""))
    return package


def contents(package):
    """Content and mode of every file."""
    return {path: (path.read_bytes(), path.stat().st_mode) for path in package.rglob("*") if path.is_file()}
